// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Each disc goes on as it went from the frame before the last one to the last one.

#include "calvin/detect/circles/disc_tracker.hpp"

#include <utility>

namespace calvin::detect {

namespace {

constexpr double kLongestGap = 3e8;  // ns, between frames

// From one time to a later one, ns; 1 where frames have no time.
double between(std::uint64_t from, std::uint64_t to) {
  if (from == kNoTimestamp || to == kNoTimestamp || to <= from) return 1;
  return static_cast<double>(to - from);
}

}  // namespace

void DiscTracker::remember(const DiscLattice& discs, ImageSize size, std::uint64_t timestamp) {
  std::swap(before_, last_);
  before_time_ = last_time_;
  if (size != size_) before_.clear();
  last_ = discs;
  size_ = size;
  last_time_ = timestamp;
}

std::optional<DiscLattice> DiscTracker::predict(ImageSize size, std::uint64_t timestamp) const {
  if (size != size_ || last_.count() == 0) return std::nullopt;
  const double ahead = between(last_time_, timestamp);
  if (ahead > kLongestGap) return std::nullopt;
  const double share = ahead / between(before_time_, last_time_);
  DiscLattice discs = last_;
  for (const Cell c : last_.cells()) {
    const Ellipse* before = before_.at(c);
    if (before == nullptr) continue;
    Ellipse e = *last_.at(c);
    e.x += share * (e.x - before->x);
    e.y += share * (e.y - before->y);
    discs.put(c, e);
  }
  return discs;
}

}  // namespace calvin::detect
