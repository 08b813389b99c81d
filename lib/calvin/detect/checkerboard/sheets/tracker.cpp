// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Extrapolates the corners of the last two frames to the time of the next.

#include "calvin/detect/checkerboard/sheets/tracker.hpp"

#include <algorithm>
#include <utility>

namespace calvin::detect {

namespace {

constexpr float kMostExtrapolation = 3;  // of the last step between two frames

// The same corner with the edges named as the board's x and y run.
Node turned(const Node& node, int quarter) {
  Node to = node;
  for (int i = 0; i < quarter; ++i) to.along = std::exchange(to.down, -to.along);
  return to;
}

// By how many of the steps from `before` to `last` the board has gone on at `now`.
float steps_ahead(std::uint64_t before, std::uint64_t last, std::uint64_t now) {
  if (before == kNoTimestamp || last == kNoTimestamp || now == kNoTimestamp) return 1;
  if (before >= last || last >= now) return 0;
  const auto ratio = static_cast<float>(now - last) / static_cast<float>(last - before);
  return ratio <= kMostExtrapolation ? ratio : 0;
}

}  // namespace

Tracker::Tracker(const Grid& grid) : grid_(grid) {
  for (auto& nodes : nodes_) nodes.resize(static_cast<std::size_t>(grid.count()));
}

void Tracker::remember(const Lattice& lattice, const FitGrid& fits, const GridAlignment& alignment,
                       ImageSize size, std::uint64_t timestamp, bool searched) {
  frames_ = size == size_ ? std::min(frames_ + 1, 2) : 1;
  size_ = size;
  std::swap(nodes_[0], nodes_[1]);
  times_[1] = std::exchange(times_[0], timestamp);
  const bool lies_alike = alignment.quarter == 0;
  fits_.reset(lies_alike ? CellRange{{1, 0}, {grid_.cols, grid_.rows - 1}} : CellRange{});
  auto to = nodes_[0].begin();
  for (int row = 0; row < grid_.rows; ++row) {
    for (int col = 0; col < grid_.cols; ++col) {
      const Cell from = alignment.cell({col, row});
      *to++ = turned(lattice.at(from), alignment.quarter);
      if (lies_alike) fits_.at({col + 1, row}) = fits.at(from);
    }
  }
  followed_ = searched ? 0 : followed_ + 1;
  if (searched) searched_ = timestamp;
}

bool Tracker::predict(ImageSize size, std::uint64_t timestamp, Lattice& lattice) const {
  if (frames_ == 0 || size != size_) return false;
  const bool timed = timestamp != kNoTimestamp && searched_ != kNoTimestamp;
  if (timed ? timestamp < searched_ || timestamp - searched_ >= kSearchAgain
            : followed_ >= kSearchAgainFrames) {
    return false;
  }
  const float ahead = frames_ == 2 ? steps_ahead(times_[1], times_[0], timestamp) : 0;
  lattice.clear();
  lattice.set_long_first(
      false);  // column 1 has the first corners, and the first step is a long one
  std::size_t id = 0;
  for (int row = 0; row < grid_.rows; ++row) {
    for (int col = 0; col < grid_.cols; ++col, ++id) {
      Node node = nodes_[0][id];
      node.x += ahead * (node.x - nodes_[1][id].x);
      node.y += ahead * (node.y - nodes_[1][id].y);
      lattice.put({col + 1, row}, node);
    }
  }
  return true;
}

}  // namespace calvin::detect
