// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Extrapolates the corners of the last two frames to the time of the next.

#include "calvin/detect/tags/search/tag_tracker.hpp"

#include <algorithm>
#include <utility>

namespace calvin::detect {

namespace {

// ns: of a tag that was seen longer ago nobody knows where it is.
constexpr double kLongest = 0.5e9;
constexpr double kMostSteps = 3;  // of the last one, that a tag is said to go on

// From one time to a later one, ns; 1 where frames have no time.
double between(std::uint64_t from, std::uint64_t to) {
  if (from == kNoTimestamp || to == kNoTimestamp || to <= from) return 1;
  return static_cast<double>(to - from);
}

}  // namespace

void TagTracker::remember(std::span<const SheetTag> tags, ImageSize size, std::uint64_t timestamp) {
  std::swap(before_, last_);
  before_time_ = std::exchange(last_time_, timestamp);
  if (size != size_) before_.clear();
  size_ = size;
  last_.clear();
  for (const SheetTag& tag : tags) {
    last_.push_back({tag.place, tag.fit.corners, tag.bends});
  }
}

std::vector<PlacedQuad> TagTracker::predict(ImageSize size, std::uint64_t timestamp) const {
  const double ahead = between(last_time_, timestamp);
  if (size != size_ || ahead > kLongest) return {};
  const double steps = std::min(ahead / between(before_time_, last_time_), kMostSteps);
  std::vector<PlacedQuad> expected;
  for (PlacedQuad tag : last_) {
    const auto before = std::ranges::find(before_, tag.place, &PlacedQuad::place);
    for (std::size_t i = 0; i < 4 && before != before_.end(); ++i) {
      tag.corners[i] += steps * (tag.corners[i] - before->corners[i]);
    }
    const Point middle = centre_of(tag.corners);
    const bool is_in_view = middle.x() >= 0 && middle.y() >= 0 && middle.x() <= size.width - 1 &&
                            middle.y() <= size.height - 1;
    if (is_in_view && is_convex(tag.corners)) expected.push_back(tag);
  }
  return expected;
}

}  // namespace calvin::detect
