// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a checkerboard answers.

#include "calvin/target/checkerboard.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "calvin/target/board_name.hpp"

namespace calvin {

std::string Checkerboard::text() const {
  return fmt::format("checkerboard:{}x{}:{}", cols, rows, length_text(size));
}

std::vector<Relabelling> Checkerboard::symmetries() const {
  if ((cols + rows) % 2 != 0) return {};
  if (cols == rows && cols % 2 == 0) return {{1}, {2}, {3}};
  return {{2}};
}

bool Checkerboard::looks_like(const Checkerboard& other) const noexcept {
  return std::minmax(cols, rows) == std::minmax(other.cols, other.rows);
}

}  // namespace calvin
