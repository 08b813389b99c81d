// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Good corners of something else: where the edge of a finger or of a card crosses an edge of the
// board.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "calvin/detect/checkerboard/lattice.hpp"

namespace calvin::detect {

// How far a corner may be off by noise that is alike all over its window, which its sigma does not
// tell: compression of the image does that.
struct Slack {
  float place = 0;       // px
  float of_spacing = 0;  // the same in parts of the spacing
};

// Rows and columns of corners are smooth, whatever the lens: over five corners in a line the fourth
// difference is a small share of the spacing, the same everywhere on a board. Keeps its memory.
class StrayCorners {
 public:
  // Removes nodes of a fitted lattice, in px of the image: those that make the differences of their
  // lines too large, the one that explains most first, and those that no line confirms. `middle`:
  // px, of the image.
  void remove_from(Lattice& lattice, const Slack& slack, const Pixel& middle);

 private:
  // A difference of successive nodes of a line, of the order `count` - 1.
  struct Difference {
    int count = 0;
    Cell cells[5];
    float weights[5] = {};
    float x = 0;  // px
    float y = 0;
    float noise = 0;           // px, 1 sigma of x and of y
    float spacing = 0;         // px
    float tolerance = 0;       // px
    Cell step;                 // of the line
    std::uint64_t places = 0;  // of the nodes on that line, a bit each
    bool fails = false;
  };
  // The verdict of all differences on the place of one node.
  struct Verdict {
    float x = 0;
    float y = 0;
    float weight = 0;
    bool accused = false;
    bool confirmed = false;
    [[nodiscard]] float error() const { return std::hypot(x, y) / weight; }  // px
    // Likewise, of what the differences tolerate.
    [[nodiscard]] float of_tolerance() const { return std::hypot(x, y) / std::sqrt(weight); }
  };

  void take_differences(const Lattice& lattice);
  void take_line(const Lattice& lattice, Cell first, Cell step, int count);
  void add(const Lattice& lattice, Cell first, Cell step, std::span<const int> places);
  [[nodiscard]] float median_of_sorted();
  void set_tolerances(int nodes);
  [[nodiscard]] bool is_like_its_neighbours(const Difference& d) const;
  [[nodiscard]] bool are_in_perspective(const Lattice& lattice) const;
  static void remove_outliers(Lattice& lattice, const Pixel& middle);
  void collect_verdicts(const CellRange& extent);

  std::vector<Difference> differences_;
  std::vector<Verdict> verdicts_;
  std::vector<int> places_;
  std::vector<float> sorted_;
  float usual_sigma_ = 0;   // px, the median
  float slack_ = 0;         // px
  bool few_nodes_ = false;  // in a difference
  bool are_loose_ = false;  // tolerances
};

}  // namespace calvin::detect
