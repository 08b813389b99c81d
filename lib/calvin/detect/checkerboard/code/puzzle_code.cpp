// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Looks at the middles of edges.

#include "calvin/detect/checkerboard/code/puzzle_code.hpp"

#include <cmath>
#include <optional>

#include "calvin/detect/checkerboard/code/puzzle_map.hpp"
#include "calvin/detect/checkerboard/corners/grey_at.hpp"
#include "calvin/target/kinds.hpp"

namespace calvin::detect {

namespace {

// The middle of the edge from a node to the next one on its way.
std::optional<Direction> middle_of(const Lattice& lattice, Cell from, Cell step) {
  if (!lattice.has(from) || !lattice.has(from + step)) return std::nullopt;
  const Node& a = lattice.at(from);
  const Node& b = lattice.at(from + step);
  return Direction{0.5F * (a.x + b.x), 0.5F * (a.y + b.y)};
}

// Half of the way across the squares beside an edge.
std::optional<Direction> across(const Lattice& lattice, Cell from, Cell step, Direction middle) {
  const Cell aside = {step.row, step.col};
  for (const int side : {1, -1}) {
    const auto next = middle_of(lattice, from + side * aside, step);
    if (!next) continue;
    const float half = 0.5F * static_cast<float>(side);
    return Direction{half * (next->x - middle.x), half * (next->y - middle.y)};
  }
  return std::nullopt;
}

// How light the middle of an edge is between the dark square beside it, -1, and the light one, 1.
std::optional<float> light_of(const ImageView& image, Direction middle, Direction aside) {
  constexpr float kAside = 0.7F;  // of half a square: beyond the dot
  constexpr float kLeast = 8;     // grey levels between the squares
  const auto grey = grey_at(image, middle.x, middle.y);
  const auto a = grey_at(image, middle.x + kAside * aside.x, middle.y + kAside * aside.y);
  const auto b = grey_at(image, middle.x - kAside * aside.x, middle.y - kAside * aside.y);
  if (!grey || !a || !b) return std::nullopt;
  const float contrast = std::abs(*a - *b);
  if (contrast < kLeast) return std::nullopt;
  return (2 * *grey - *a - *b) / contrast;
}

}  // namespace

PuzzleCode::PuzzleCode(const PuzzleBoard& board)
    : Code(board.grid(), 2, 2, board.is_dark_before({0, 0})), size_(board.size) {
  for (int row = 0; row < board.rows; ++row) {
    for (int col = 0; col < board.cols; ++col) {
      if (col + 1 < board.cols) set({{col, row}, 0}, board.is_light_after({col, row}));
      if (row + 1 < board.rows) set({{col, row}, 1}, board.is_light_below({col, row}));
    }
  }
}

std::optional<Board> PuzzleCode::other_board(const ImageView& /*image*/, const Lattice& lattice,
                                             std::span<const CodeBit> bits, bool /*whole*/) const {
  return locate_in_map(*this, bits, lattice.extent(), size_);
}

void PuzzleCode::read(const ImageView& image, const Lattice& lattice,
                      std::vector<CodeBit>& bits) const {
  constexpr float kClearly = 0.25F;
  lattice.for_each([&](Cell c, const Node& /*node*/) {
    for (const int index : {0, 1}) {
      const Cell step = kAround[static_cast<std::size_t>(index)];
      const auto middle = middle_of(lattice, c, step);
      const auto aside = middle ? across(lattice, c, step, *middle) : std::nullopt;
      const auto light = aside ? light_of(image, *middle, *aside) : std::nullopt;
      if (light && std::abs(*light) >= kClearly) bits.push_back({{c, index}, *light > 0});
    }
  });
}

CodePlace PuzzleCode::turned(const CodePlace& at, int quarter) const {
  // In half cells, so that the middle of an edge is a whole number.
  Cell half = 2 * at.cell + kAround[static_cast<std::size_t>(at.index)];
  for (int i = 0; i < quarter; ++i) half = {half.row, -half.col};
  const int index = half.col % 2 != 0 ? 0 : 1;
  const Cell from = half - kAround[static_cast<std::size_t>(index)];
  return {{from.col / 2, from.row / 2}, index};
}

}  // namespace calvin::detect
