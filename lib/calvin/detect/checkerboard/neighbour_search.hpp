// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The nearest corner along each edge of each corner.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/detect/checkerboard/corners/corner.hpp"

namespace calvin::detect {

// The ways to leave a corner: along its rising edge, against it, along the falling one, against it.
inline constexpr int kWays = 4;
inline constexpr int kNoCorner = -1;

// A link skips corners if it is this many times longer than the one on the other side of its
// corner lets expect.
inline constexpr float kLongestLink = 2;

// What neighbours have to be like.
struct NeighbourRules {
  float reach = 0;         // px, how far they may be apart
  bool parallel = false;   // both edges have to run as those of the corner
  float longest_link = 2;  // times the one on the other side
};

// Corners in square cells of the image, by cells in rows.
struct CornerCells {
  const int* begin = nullptr;  // the first corner of each cell, and the end
  int across = 0;
  int down = 0;
  // The corners in the order of the cells: the fields of Corner, and the index in the list.
  const float* x = nullptr;
  const float* y = nullptr;
  const float* rising_x = nullptr;
  const float* rising_y = nullptr;
  const float* falling_x = nullptr;
  const float* falling_y = nullptr;
  const float* contrast = nullptr;
  const int* index = nullptr;
  int count = 0;
};

// Keeps its memory.
class NeighbourSearch {
 public:
  // For each corner the nearest one on each way whose edge arrives there with exchanged colours;
  // kNoCorner where there is none, or only one that skips corners.
  void run(std::span<const Corner> corners, ImageSize size, const NeighbourRules& rules,
           std::vector<std::array<int, kWays>>& nearest);

 private:
  [[nodiscard]] CornerCells sort_into_cells(std::span<const Corner> corners, ImageSize size);

  std::vector<int> begin_;
  std::vector<int> index_;
  std::vector<float> numbers_;  // the arrays of CornerCells, one after the other
};

}  // namespace calvin::detect
