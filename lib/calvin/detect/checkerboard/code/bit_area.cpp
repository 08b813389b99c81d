// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Counts the bits of each cell and sums them up, rows first.

#include "calvin/detect/checkerboard/code/bit_area.hpp"

#include <algorithm>

namespace calvin::detect {

void BitArea::set(std::span<const CodeBit> bits) {
  cells_ = {};
  if (bits.empty()) return;
  cells_ = {bits.front().at.cell, bits.front().at.cell};
  for (const CodeBit& bit : bits) {
    const Cell c = bit.at.cell;
    cells_.first = {std::min(cells_.first.col, c.col), std::min(cells_.first.row, c.row)};
    cells_.last = {std::max(cells_.last.col, c.col), std::max(cells_.last.row, c.row)};
  }
  sums_.assign(static_cast<std::size_t>((cells_.cols() + 1) * (cells_.rows() + 1)), 0);
  for (const CodeBit& bit : bits) {
    const Cell c = bit.at.cell - cells_.first;
    ++before(c.col + 1, c.row + 1);
  }
  for (int row = 1; row <= cells_.rows(); ++row) {
    int of_row = 0;
    for (int col = 1; col <= cells_.cols(); ++col) {
      of_row += before(col, row);
      before(col, row) = before(col, row - 1) + of_row;
    }
  }
}

int BitArea::within(const CellRange& range) const {
  const auto cut = [](int from_first, int count) { return std::clamp(from_first, 0, count); };
  const int left = cut(range.first.col - cells_.first.col, cells_.cols());
  const int right = cut(range.last.col + 1 - cells_.first.col, cells_.cols());
  const int top = cut(range.first.row - cells_.first.row, cells_.rows());
  const int bottom = cut(range.last.row + 1 - cells_.first.row, cells_.rows());
  if (left >= right || top >= bottom) return 0;
  return before(right, bottom) - before(left, bottom) - before(right, top) + before(left, top);
}

}  // namespace calvin::detect
