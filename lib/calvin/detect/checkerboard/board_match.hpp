// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which board a lattice of corners is, and which corner is which.
#pragma once

#include <string>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/core/reason.hpp"
#include "calvin/detect/checkerboard/lattice.hpp"
#include "calvin/target/board.hpp"
#include "calvin/target/checkerboard.hpp"

namespace calvin::detect {

// How the cells of a lattice are numbered as control points of a board.
struct GridAlignment {
  int quarter = 0;  // the board's x runs along the lattice's +col, +row, -col, -row
  Cell origin;      // the first cell of the board's window: the least column and row
  int cols = 0;     // of that window
  int rows = 0;

  // The control point in a cell, (col, row) on the board; may lie beyond the board.
  [[nodiscard]] Cell point(Cell cell) const;
  // The inverse.
  [[nodiscard]] Cell cell(Cell point) const;
  // Whether the square outside control point 0 is dark, by the colours of the lattice: diagonally
  // beyond that point is a square of the same colour, the one that the corner opens into.
  [[nodiscard]] bool begins_dark() const {
    return Lattice::is_even(cell({0, 0})) == (quarter % 2 == 1);
  }
};

struct Match {
  // kAccepted: all or a part of the board. kWrongBoard: a checkerboard, but of another size or with
  // exchanged colours. kNotFound: too little to tell.
  Reason reason = Reason::kNotFound;
  bool whole = false;      // every control point has its node
  bool exchanged = false;  // the colours are not those of the board
  GridAlignment alignment;
  std::vector<Relabelling> ambiguous;  // the other alignments, see Observation
  bool certain = false;                // kWrongBoard: too large, or all four edges are in view
  bool size_is_certain = false;        // kWrongBoard: no line of nodes can follow on any side
  int seen_cols = 0;                   // of the lattice, its longer side where the board has it
  int seen_rows = 0;
  std::string seen;  // kWrongBoard: the text of the board that is seen, where its code tells it
};

// Whether a lattice is so much larger than the board that no stray nodes explain it.
[[nodiscard]] bool is_far_larger(const Lattice& lattice, const Checkerboard& board);

// The rows and columns of which more than half of the nodes are there: what stands beyond is stray.
[[nodiscard]] CellRange dense_extent(const Lattice& lattice);

// Whether a lattice has as many rows and columns as its board: nodes nearly everywhere in them, and
// the pattern ends on all four sides. In px of the image.
[[nodiscard]] bool is_size_certain(const ImageView& image, const Lattice& lattice);

// `lattice` in px of `image` (of step 1), no node guessed. Stray nodes that stand outside of the
// board's edge are removed from it.
[[nodiscard]] Match match_board(const ImageView& image, const Checkerboard& board,
                                Lattice& lattice);

}  // namespace calvin::detect
