// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How many of the bits that were seen lie in a part of a lattice: no more of them can speak for a
// place of the board.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "calvin/detect/checkerboard/code/code.hpp"

namespace calvin::detect {

// A table of sums over all rectangles that begin in the first cell. Keeps its memory.
class BitArea {
 public:
  void set(std::span<const CodeBit> bits);

  // Of the bits in a range of cells, which may reach beyond them on any side.
  [[nodiscard]] int within(const CellRange& range) const;

 private:
  // The bits in rows and columns before these, from the first cell on.
  [[nodiscard]] int& before(int cols, int rows) {
    return sums_[static_cast<std::size_t>(rows * (cells_.cols() + 1) + cols)];
  }
  [[nodiscard]] int before(int cols, int rows) const {
    return sums_[static_cast<std::size_t>(rows * (cells_.cols() + 1) + cols)];
  }

  CellRange cells_;  // of the bits
  std::vector<int> sums_;
};

}  // namespace calvin::detect
