// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Looks at the tags, which are where the lines of a lattice are farther apart both ways.

#include "calvin/detect/checkerboard/code/april_code.hpp"

#include "calvin/detect/checkerboard/code/april_tags.hpp"
#include "calvin/target/kinds.hpp"

namespace calvin::detect {

namespace {

MarkerShape shape_of(const AprilGrid& board) {
  MarkerShape shape;
  shape.side = board.dictionary->side;
  shape.cell = 1 / static_cast<float>(shape.side + 2 * board.border);
  shape.rim = 1 - static_cast<float>(board.border) * shape.cell;
  // The middle of the gaps beside the tag.
  shape.around = static_cast<float>(1 + board.spacing);
  return shape;
}

}  // namespace

AprilCode::AprilCode(const AprilGrid& board)
    : Code(board.grid(), board.dictionary->side * board.dictionary->side, 1, true),
      board_(board),
      shape_(shape_of(board)) {
  const int side = shape_.side;
  for (int row = 0; row < board.rows; ++row) {
    for (int col = 0; col < board.cols; ++col) {
      const int id = board.tag_in(col, row);
      for (int i = 0; i < side * side; ++i) {
        set({{2 * col, 2 * row}, i}, board.is_light(id, i % side, i / side));
      }
    }
  }
}

void AprilCode::read(const ImageView& image, const Lattice& lattice,
                     std::vector<CodeBit>& bits) const {
  const CellRange e = lattice.extent();
  for (int row = e.first.row - 1; row <= e.last.row; ++row) {
    for (int col = e.first.col - 1; col <= e.last.col; ++col) {
      if (may_hold_marker(lattice, {col, row})) {
        read_marker(image, lattice, {col, row}, shape_, bits);
      }
    }
  }
}

CodePlace AprilCode::turned(const CodePlace& at, int quarter) const {
  return turned_in_marker(at, shape_.side, quarter);
}

std::optional<AprilGrid> AprilCode::grid_of(std::span<const CodeBit> bits) const {
  std::vector<CodeBit> turned_bits(bits.begin(), bits.end());
  for (int quarter = 0; quarter < 4; ++quarter) {
    for (std::size_t i = 0; i < bits.size(); ++i) {
      turned_bits[i].at = turned(bits[i].at, quarter);
    }
    if (const auto board = grid_of_tags(tags_in(board_, turned_bits), board_)) return board;
  }
  return std::nullopt;
}

std::optional<Board> AprilCode::other_board(const ImageView& /*image*/, const Lattice& /*lattice*/,
                                            std::span<const CodeBit> bits, bool /*whole*/) const {
  const auto board = grid_of(bits);
  if (!board || *board == board_) return std::nullopt;
  return *board;
}

}  // namespace calvin::detect
