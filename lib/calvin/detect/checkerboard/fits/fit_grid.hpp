// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The fits of all nodes of a lattice, and the two properties that only neighbours can tell, because
// one window is too small: how edges bend and how the light falls.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "calvin/detect/checkerboard/corners/saddle_fit.hpp"
#include "calvin/detect/checkerboard/lattice.hpp"

namespace calvin::detect {

// Keeps its memory.
class FitGrid {
 public:
  void reset(const CellRange& extent) {
    cells_ = extent;
    fits_.assign(static_cast<std::size_t>(extent.cols() * extent.rows()), {});
  }
  // Makes room for a cell, and keeps the fits of all others.
  void include(Cell c);
  [[nodiscard]] bool empty() const { return fits_.empty(); }
  [[nodiscard]] bool has(Cell c) const {
    return c.col >= cells_.first.col && c.col <= cells_.last.col && c.row >= cells_.first.row &&
           c.row <= cells_.last.row;
  }
  [[nodiscard]] const SaddleFit& at(Cell c) const { return fits_[index(c)]; }
  [[nodiscard]] SaddleFit& at(Cell c) { return fits_[index(c)]; }

  // The median of a number of each node of the lattice.
  template <typename F>
  [[nodiscard]] float median(const Lattice& lattice, F number) {
    numbers_.clear();
    lattice.for_each([&](Cell c, const Node& /*node*/) { numbers_.push_back(number(at(c))); });
    return middle();
  }
  // The median of number(cell) over the nodes for which has(cell).
  template <typename H, typename F>
  [[nodiscard]] float median_where(const Lattice& lattice, H has, F number) {
    numbers_.clear();
    lattice.for_each([&](Cell c, const Node& /*node*/) {
      if (has(c)) numbers_.push_back(number(c));
    });
    return middle();
  }

 private:
  [[nodiscard]] std::size_t index(Cell c) const {
    return static_cast<std::size_t>((c.row - cells_.first.row) * cells_.cols() + c.col -
                                    cells_.first.col);
  }
  [[nodiscard]] float middle() {
    if (numbers_.empty()) return 0;
    const auto at = numbers_.begin() + static_cast<std::ptrdiff_t>(numbers_.size() / 2);
    std::nth_element(numbers_.begin(), at, numbers_.end());
    return *at;
  }

  CellRange cells_;
  std::vector<SaddleFit> fits_;
  std::vector<float> numbers_;
};

// Sets the bends of the fits from the places of their neighbours, and moves each fit to where a fit
// with these bends will find its corner.
void set_bends(const Lattice& lattice, FitGrid& fits);

// Whether edges are bent so much, for their windows, that it matters how well the bends at the
// ends of lines are known.
[[nodiscard]] bool are_bent(const Lattice& lattice, const FitGrid& fits);

// Sets the bends anew, from the neighbours and from `inner`, which are fits of the same nodes in
// smaller windows (a radius of 0: none), and moves each fit to where a fit with these bends would
// find its corner. Sigmas grow by what is uncertain of the bends.
void correct_bends(const Lattice& lattice, const FitGrid& inner, FitGrid& fits);

// Makes the sigmas of nodes at the ends of lines contain how uncertain bends are beyond the last
// node that has others on both sides.
void widen_ends(const Lattice& lattice, FitGrid& fits);

// Sets the slopes of level and contrast, from the levels and contrasts of all fits.
void set_slopes(const Lattice& lattice, FitGrid& fits);

// Where a surface of the third degree through the places of all nodes lets the nodes of `cells` be
// expected, and how far nodes lie from it.
struct ExpectedPlaces {
  std::vector<Pixel> places;  // of each cell
  float sigma = 0;            // px, 1 sigma of the places of nodes about the surface
};
[[nodiscard]] ExpectedPlaces expect_places(const Lattice& lattice, FitGrid& fits,
                                           std::span<const Cell> cells);

}  // namespace calvin::detect
