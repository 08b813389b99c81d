// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Looks at the middles of squares.

#include "calvin/detect/checkerboard/code/circle_code.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include "calvin/detect/checkerboard/board_match.hpp"
#include "calvin/detect/checkerboard/code/marker_reader.hpp"
#include "calvin/target/kinds.hpp"

namespace calvin::detect {

namespace {

// Of the squares of another board, that have to be read.
constexpr double kLeastRead = 0.9;

void read_circles(const ImageView& image, const Lattice& lattice, std::vector<CodeBit>& bits) {
  lattice.for_each([&](Cell c, const Node& /*node*/) {
    const bool is_square =
        lattice.has(c + Cell{1, 0}) && lattice.has(c + Cell{0, 1}) && lattice.has(c + Cell{1, 1});
    if (is_square) read_circle(image, lattice, c, bits);
  });
}

// Whether nearly every square of the lattice was read.
bool are_all_read(const CellRange& extent, std::span<const CodeBit> bits) {
  const int squares = (extent.cols() - 1) * (extent.rows() - 1);
  return static_cast<double>(bits.size()) >= kLeastRead * squares;
}

// The board by the circles of a whole lattice, of which x runs along one of four ways.
MarkedCheckerboard board_of(std::span<const CodeBit> bits, const GridAlignment& alignment,
                            double size) {
  const bool is_turned = alignment.quarter % 2 != 0;
  MarkedCheckerboard board;
  board.cols = is_turned ? alignment.rows : alignment.cols;
  board.rows = is_turned ? alignment.cols : alignment.rows;
  board.size = size;
  const Cell shift = alignment.point({0, 0});
  for (const CodeBit& bit : bits) {
    if (!bit.light) continue;
    const Cell square = turned_in_marker(bit.at, 1, alignment.quarter).cell + shift + Cell{1, 1};
    board.circles.push_back({square.col, square.row});
  }
  std::ranges::sort(board.circles, {}, [](GridPlace p) { return std::pair(p.row, p.col); });
  return board;
}

// Of the ways to name a board, the one that sorts first is taken.
auto rank_of(const MarkedCheckerboard& board) {
  const bool is_usual = board.circles == MarkedCheckerboard::usual_circles(board.cols, board.rows);
  std::vector<std::pair<int, int>> circles;
  for (const GridPlace p : board.circles) circles.emplace_back(p.row, p.col);
  return std::tuple(!is_usual, board.cols < board.rows, circles);
}

std::optional<MarkedCheckerboard> whole_board(const Lattice& lattice, std::span<const CodeBit> bits,
                                              double size) {
  constexpr int kMostCircles = 4;  // one in so many squares
  const CellRange e = lattice.extent();
  const auto circles = std::ranges::count(bits, true, &CodeBit::light);
  if (!are_all_read(e, bits) || kMostCircles * circles > std::ssize(bits)) return std::nullopt;
  std::optional<MarkedCheckerboard> best;
  for (int quarter = 0; quarter < 4; ++quarter) {
    const GridAlignment alignment = {quarter, e.first, e.cols(), e.rows()};
    if (!alignment.begins_dark()) continue;
    MarkedCheckerboard board = board_of(bits, alignment, size);
    if (!board.check() || (best && rank_of(*best) <= rank_of(board))) continue;
    best = std::move(board);
  }
  return best;
}

}  // namespace

CircleCode::CircleCode(const MarkedCheckerboard& board)
    : Code(board.grid(), 1, 1, true), size_(board.size) {
  // Control point 0 is the lower right corner of square (0, 0).
  for (int row = 1; row < board.rows; ++row) {
    for (int col = 1; col < board.cols; ++col) {
      set({{col - 1, row - 1}, 0}, board.has_circle({col, row}));
    }
  }
}

void CircleCode::read(const ImageView& image, const Lattice& lattice,
                      std::vector<CodeBit>& bits) const {
  read_circles(image, lattice, bits);
}

CodePlace CircleCode::turned(const CodePlace& at, int quarter) const {
  return turned_in_marker(at, 1, quarter);
}

std::optional<Board> CircleCode::other_board(const ImageView& /*image*/, const Lattice& lattice,
                                             std::span<const CodeBit> bits, bool whole) const {
  if (!whole) return std::nullopt;
  if (auto board = whole_board(lattice, bits, size_)) return *std::move(board);
  const CellRange e = lattice.extent();
  const bool is_plain = std::ranges::none_of(bits, &CodeBit::light) && are_all_read(e, bits);
  if (!is_plain) return std::nullopt;
  const auto [shorter, longer] = std::minmax({e.cols(), e.rows()});
  return Checkerboard{longer, shorter, size_};
}

std::optional<MarkedCheckerboard> find_marked_checkerboard(const ImageView& image,
                                                           const Lattice& lattice, double size) {
  std::vector<CodeBit> bits;
  read_circles(image, lattice, bits);
  return whole_board(lattice, bits, size);
}

}  // namespace calvin::detect
