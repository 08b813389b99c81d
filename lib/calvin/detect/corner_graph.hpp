// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which corners are neighbours: the edge that leaves one arrives at the other, with its colours
// exchanged, both see each other first, and the image has that edge all the way between them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "calvin/detect/corner.hpp"

namespace calvin::detect {

// The ways to leave a corner: along its rising edge, against it, along the falling one, against it.
inline constexpr int kWays = 4;
inline constexpr int kNoCorner = -1;

// Keeps its memory.
class CornerGraph {
 public:
  // Neighbours no further than `reach` px apart are seen.
  void build(const ImageView& image, std::span<const Corner> corners, float reach);

  // The neighbour of a corner on each way, or kNoCorner; mutual.
  [[nodiscard]] const std::array<int, kWays>& neighbours(int corner) const {
    return links_[static_cast<std::size_t>(corner)];
  }

 private:
  void sort_into_cells(std::span<const Corner> corners, ImageSize size);
  [[nodiscard]] std::array<int, kWays> nearest(const Corner& from, float reach) const;
  [[nodiscard]] bool skips(std::span<const Corner> corners, int from, int to) const;

  int cells_across_ = 0;
  int cells_down_ = 0;
  std::vector<int> cell_begin_;  // of each cell in `in_cells_`, and the end
  std::vector<int> in_cells_;    // indices of corners
  std::vector<Corner> sorted_;  // the corners in that order: those next to each other are looked at
                                // one after the other
  std::vector<std::array<int, kWays>> nearest_;
  std::vector<std::array<int, kWays>> links_;
};

}  // namespace calvin::detect
