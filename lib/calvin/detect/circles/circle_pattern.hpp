// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// CirclePattern: a board of discs as the search for it needs it, and where it lies over a lattice.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "calvin/core/observation.hpp"
#include "calvin/detect/circles/disc_lattice.hpp"
#include "calvin/target/board.hpp"
#include "calvin/target/circle_grid.hpp"

namespace calvin::detect {

[[nodiscard]] bool has_circle_pattern(const Board& board);

// How a lattice's cells are a board's: turned by quarter turns, then shifted.
struct CellMap {
  int quarter_turns = 0;
  Cell shift;

  [[nodiscard]] Cell operator()(Cell c) const {
    for (int i = 0; i < quarter_turns; ++i) c = {-c.row, c.col};
    return c + shift;
  }
  // From the board's cells to the lattice's.
  [[nodiscard]] Cell back(Cell c) const {
    c = c - shift;
    for (int i = quarter_turns; i < 4; ++i) c = {-c.row, c.col};
    return c;
  }
};

class CirclePattern {
 public:
  // For boards that has_circle_pattern() tells, and grids of dots that go on beyond the picture.
  explicit CirclePattern(Board of);

  struct Disc {
    Cell cell;  // in steps to the nearest discs: of an asymmetric grid along its diagonals
    DiscMark mark = DiscMark::kNone;
  };

  [[nodiscard]] const Board& board() const { return board_; }
  [[nodiscard]] bool is_light() const { return light_; }
  [[nodiscard]] bool has_marks() const { return marks_; }
  // Of each control point, in the order of Board::ids().
  [[nodiscard]] const std::vector<Disc>& discs() const { return discs_; }
  // Steps from one corner of the board to the opposite one, at most.
  [[nodiscard]] int reach() const { return reach_; }
  // The place in discs() of a cell of the board.
  [[nodiscard]] std::optional<std::size_t> disc_in(Cell c) const;

 private:
  Board board_;
  bool light_ = false;
  bool marks_ = false;
  std::vector<Disc> discs_;
  int reach_ = 0;
  CellRange range_;
  std::vector<int> index_;  // of the cells of range_; -1: none
};

// What a lattice's disc shows of a mark; absent where that cannot be told.
using SeenMark = std::optional<DiscMark>;

// The ways to lay a board over a lattice: the only one, and those by the board's own turns. Every
// disc of the lattice is one of the board's, with the mark that it shows. Empty where there is
// none, or where there are others, and where less than `least_share` of the board is seen.
[[nodiscard]] std::vector<CellMap> place_on(const CirclePattern& pattern,
                                            const DiscLattice& lattice,
                                            std::span<const SeenMark> marks, double least_share);

// The board of which a lattice shows every disc, with the marks that they show, in the order of
// lattice.cells(); its distance is that of `like`.
[[nodiscard]] std::optional<Board> board_of(const DiscLattice& lattice,
                                            std::span<const SeenMark> marks, const Board& like);

}  // namespace calvin::detect
