// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The refinement of the corners of a board that is known to lie over a lattice: what is printed
// beside them is taken out of the pixels.
#pragma once

#include <optional>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/detect/checkerboard/board_match.hpp"
#include "calvin/detect/checkerboard/code/code.hpp"
#include "calvin/detect/checkerboard/code/markers/marker_ink.hpp"
#include "calvin/detect/checkerboard/code/pattern.hpp"
#include "calvin/detect/checkerboard/fits/refine.hpp"
#include "calvin/detect/checkerboard/lattice.hpp"

namespace calvin::detect {

// A board that lies over a lattice in a way.
struct PlacedBoard {
  const Code* code = nullptr;  // null for a board without one
  GridAlignment alignment;
  std::vector<Cell> cells;  // where nearly all of it is there, see Refinement::refine()
};
[[nodiscard]] PlacedBoard placed_board(const Pattern& pattern, const GridAlignment& alignment,
                                       const Lattice& lattice);

// Markers that blur runs into the edges beside them are drawn by where the corners are and how wide
// the edges are, and taken out of the picture; the corners are fitted in what is left, and so on
// until neither changes. Keeps its memory.
class BoardRefinement {
 public:
  // As Refinement::refine(). The fits are left in `refinement`.
  [[nodiscard]] bool refine(const ImageView& image, const PlacedBoard& board,
                            Refinement& refinement, Lattice& lattice);

  // As Refinement::refine_again(), for a whole board.
  [[nodiscard]] bool refine_again(const ImageView& image, const PlacedBoard& board,
                                  const FitGrid& before, Refinement& refinement, Lattice& lattice);

  // Whether the corners were fitted last in a picture without the markers.
  [[nodiscard]] bool took_markers_off() const { return took_markers_off_; }

 private:
  // What a round changes, at most: of the sigma, RMS, and of the width.
  struct Limits {
    float of_sigma = 0;
    float of_width = 0;
  };
  // A round begins with places of the nodes and a width of the edges, px, and leads to others.
  struct Round {
    std::vector<Direction> from;
    std::vector<Direction> step;
    float width = 0;
    float width_step = 0;
    float sigma = 0;  // px, median of the nodes
    [[nodiscard]] float step_size() const;
    [[nodiscard]] bool is_within(const Limits& most) const;
  };
  [[nodiscard]] bool refine_beside_markers(const ImageView& image, const PlacedBoard& board,
                                           Refinement& refinement, Lattice& lattice);
  [[nodiscard]] bool refine_without_markers(const ImageView& image, const PlacedBoard& board,
                                            Refinement& refinement, Lattice& lattice);
  // `first`: there is no round before it to compare it with.
  void take_round(float width, bool first);
  void move_nodes(bool first);
  [[nodiscard]] float next_width(bool first) const;
  [[nodiscard]] float amplification() const;

  MarkerInk ink_;
  Lattice start_{0};   // as refine() was given it
  Lattice at_{0};      // where a round begins
  Lattice fitted_{0};  // what it leads to
  Round last_;
  Round now_;
  bool took_markers_off_ = false;
  std::optional<float> amplified_;  // the sigma, see amplification()
};

}  // namespace calvin::detect
