// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Discs in rows and columns, of any two directions: those of a symmetric grid, or the diagonals of
// an asymmetric one.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "calvin/detect/checkerboard/lattice.hpp"
#include "calvin/detect/circles/ellipse.hpp"

namespace calvin::detect {

class DiscLattice {
 public:
  // Discs up to `reach` steps from the first one.
  explicit DiscLattice(int reach);

  void clear();
  [[nodiscard]] bool in_reach(Cell c) const {
    return c.col >= -reach_ && c.col <= reach_ && c.row >= -reach_ && c.row <= reach_;
  }
  [[nodiscard]] const Ellipse* at(Cell c) const {
    if (!in_reach(c) || !used_[index(c)]) return nullptr;
    return &discs_[index(c)];
  }
  void put(Cell c, const Ellipse& disc);
  void remove(Cell c);
  [[nodiscard]] const std::vector<Cell>& cells() const { return cells_; }
  [[nodiscard]] int count() const { return static_cast<int>(cells_.size()); }
  [[nodiscard]] CellRange extent() const;

  // The ellipse that those around a cell let expect there; absent where there are too few.
  // `spacing` px to them.
  struct Expectation {
    Ellipse disc;
    double spacing = 0;
  };
  [[nodiscard]] std::optional<Expectation> expect(Cell c) const;

 private:
  [[nodiscard]] std::size_t index(Cell c) const {
    return static_cast<std::size_t>((c.row + reach_) * (2 * reach_ + 1) + c.col + reach_);
  }
  int reach_;
  std::vector<Cell> cells_;
  std::vector<bool> used_;
  std::vector<Ellipse> discs_;
};

// The discs of a lattice that are elsewhere than all others together let them be expected, in a
// picture with that middle, px: where squares become small towards the rim of a fisheye's picture,
// a row may have been taken for the next one. Empty where none is far from what its neighbours let
// expect.
[[nodiscard]] std::vector<Cell> outliers_of(const DiscLattice& lattice, const Pixel& middle);

// Lattices out of the discs of an image. Keeps its memory.
class DiscGraph {
 public:
  // The discs have to stay.
  void begin(std::span<const Ellipse> discs);
  // Moves to the next lattice of at least `least` discs, none of which were in an earlier one;
  // false where there is none.
  [[nodiscard]] bool next(int least, DiscLattice& lattice);

 private:
  struct Seed {
    std::size_t disc = 0;
    double along_x = 0, along_y = 0;  // px, to the next of the row
    double down_x = 0, down_y = 0;    // px, to the next of the column
    double misfit = 0;                // of the four neighbours, of the spacing
  };
  [[nodiscard]] std::optional<Seed> seed_at(std::size_t disc) const;
  // The disc nearest to a place, within `within` px, that is like another one.
  [[nodiscard]] std::optional<std::size_t> nearest(double x, double y, double within,
                                                   const Ellipse& like) const;
  void grow(const Seed& seed, DiscLattice& lattice);

  template <typename F>
  void for_each_near(double x, double y, double within, F f) const;

  std::span<const Ellipse> discs_;
  double bucket_ = 1;  // px
  int bucket_cols_ = 0;
  int bucket_rows_ = 0;
  std::vector<std::size_t> first_;  // in order_, of each bucket
  std::vector<std::size_t> order_;
  std::vector<bool> taken_;
  std::vector<Seed> seeds_;
  std::size_t next_seed_ = 0;
};

}  // namespace calvin::detect
