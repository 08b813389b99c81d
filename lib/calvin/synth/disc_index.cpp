// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Lists discs in the squares of a raster and finds them there.

#include "calvin/synth/disc_index.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

namespace calvin::synth {

namespace {

BoardArea area_of(const Artwork::Disc& disc) {
  const double radius = disc.diameter / 2;
  return {disc.x - radius, disc.y - radius, disc.x + radius, disc.y + radius};
}

bool meet(const BoardArea& a, const BoardArea& b) {
  return a.left <= b.right && b.left <= a.right && a.top <= b.bottom && b.top <= a.bottom;
}

}  // namespace

DiscIndex::DiscIndex(std::vector<Artwork::Disc> discs) : discs_(std::move(discs)) {
  if (discs_.empty()) return;
  constexpr double kFar = std::numeric_limits<double>::infinity();
  area_ = {kFar, kFar, -kFar, -kFar};
  double largest = 0;
  for (const Artwork::Disc& disc : discs_) {
    const BoardArea own = area_of(disc);
    area_ = {std::min(area_.left, own.left), std::min(area_.top, own.top),
             std::max(area_.right, own.right), std::max(area_.bottom, own.bottom)};
    largest = std::max(largest, disc.diameter);
  }
  // A square for each disc, none smaller than a disc: then each is listed four times at most.
  const auto count = static_cast<double>(discs_.size());
  step_ = std::max(largest, std::sqrt(area_.width() * area_.height() / count));
  cols_ = static_cast<int>(area_.width() / step_) + 1;
  rows_ = static_cast<int>(area_.height() / step_) + 1;
  squares_.resize(square(0, rows_));
  for (const Artwork::Disc& disc : discs_) {
    const Range range = range_of(area_of(disc));
    for (int row = range.top; row <= range.bottom; ++row) {
      for (int col = range.left; col <= range.right; ++col) {
        squares_[square(col, row)].push_back(&disc);
      }
    }
  }
}

DiscIndex::Range DiscIndex::range_of(const BoardArea& area) const noexcept {
  const auto at = [this](double x, double start, int count) {
    return static_cast<int>(std::clamp((x - start) / step_, 0.0, count - 1.0));
  };
  return {at(area.left, area_.left, cols_), at(area.top, area_.top, rows_),
          at(area.right, area_.left, cols_), at(area.bottom, area_.top, rows_)};
}

void DiscIndex::find(const BoardArea& area, std::vector<const Artwork::Disc*>& found) const {
  found.clear();
  const Range range = range_of(area);
  for (int row = range.top; row <= range.bottom; ++row) {
    for (int col = range.left; col <= range.right; ++col) {
      for (const Artwork::Disc* disc : squares_[square(col, row)]) {
        if (meet(area_of(*disc), area)) found.push_back(disc);
      }
    }
  }
  if (found.size() < 2) return;
  std::sort(found.begin(), found.end(), std::greater<>());
  found.erase(std::unique(found.begin(), found.end()), found.end());
}

}  // namespace calvin::synth
