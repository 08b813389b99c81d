// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which corners are neighbours: the edge that leaves one arrives at the other, with its colours
// exchanged, both see each other first, and the image has that edge all the way between them.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "calvin/detect/checkerboard/corners/corner.hpp"
#include "calvin/detect/checkerboard/neighbour_search.hpp"
#include "calvin/detect/checkerboard/surroundings.hpp"

namespace calvin::detect {

// Keeps its memory.
class CornerGraph {
 public:
  // Neighbours no further than `reach` px apart are seen.
  void build(const ImageView& image, std::span<const Corner> corners, float reach,
             const Surroundings& surroundings);

  // The neighbour of a corner on each way, or kNoCorner; mutual.
  [[nodiscard]] const std::array<int, kWays>& neighbours(int corner) const {
    return links_[static_cast<std::size_t>(corner)];
  }

  // The logarithms of how many times farther the next corner along its rising edge is than the one
  // behind it, and the one behind its falling edge than the one along that; 0 where one is missing.
  [[nodiscard]] std::array<float, 2> step_ratios(std::span<const Corner> corners, int corner) const;

 private:
  [[nodiscard]] bool skips(std::span<const Corner> corners, int from, int to) const;

  NeighbourSearch search_;
  NeighbourRules rules_;
  std::vector<std::array<int, kWays>> nearest_;
  std::vector<std::array<int, kWays>> links_;
};

}  // namespace calvin::detect
