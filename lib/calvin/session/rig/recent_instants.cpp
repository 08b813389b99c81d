// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Pairs the views of the last moment.

#include "calvin/session/rig/recent_instants.hpp"

#include <algorithm>
#include <utility>

#include "calvin/rig/rig_views.hpp"

namespace calvin {

void RecentInstants::forget(std::size_t camera) {
  if (camera < cameras_.size()) cameras_[camera].clear();
}

void RecentInstants::add(std::size_t camera, SharedView view) {
  if (camera >= cameras_.size()) cameras_.resize(camera + 1);
  cameras_[camera].push_back(std::move(view));
  if (cameras_[camera].size() > kMost) cameras_[camera].pop_front();
}

void RecentInstants::replace(std::size_t camera, const SharedView& view, const SharedView& by) {
  if (camera < cameras_.size()) std::ranges::replace(cameras_[camera], view, by);
}

// The time before which all cameras have sent what they saw, but for those that are silent.
std::uint64_t RecentInstants::over_before(std::uint64_t tolerance) const {
  std::uint64_t newest = 0;
  std::uint64_t slowest = kNoTimestamp;
  for (const auto& camera : cameras_) {
    if (camera.empty()) continue;
    const std::uint64_t last = camera.back()->observation.timestamp;
    newest = std::max(newest, last);
    slowest = std::min(slowest, last);
  }
  if (slowest == kNoTimestamp) return 0;
  const std::uint64_t over = std::max(slowest, newest - std::min(newest, kLatest));
  return over - std::min(over, tolerance);
}

std::vector<std::vector<SharedView>> RecentInstants::take(std::uint64_t tolerance,
                                                          std::uint64_t interval) {
  const std::uint64_t over = over_before(tolerance);
  std::vector<ViewTimes> times;
  std::vector<std::deque<SharedView>> views(cameras_.size());
  for (std::size_t c = 0; c < cameras_.size(); ++c) {
    ViewTimes& of = times.emplace_back();
    while (!cameras_[c].empty() && cameras_[c].front()->observation.timestamp < over) {
      of.push_back(cameras_[c].front()->observation.timestamp);
      views[c].push_back(std::move(cameras_[c].front()));
      cameras_[c].pop_front();
    }
  }
  std::vector<std::vector<SharedView>> taken(cameras_.size());
  for (const Instant& instant : pair_instants(times, tolerance).instants) {
    const bool is_soon = last_taken_ != 0 && instant.timestamp < last_taken_ + interval;
    if (is_soon && instant.timestamp >= last_taken_) continue;
    last_taken_ = instant.timestamp;
    for (const RigView& of : instant.views) taken[of.camera].push_back(views[of.camera][of.view]);
  }
  return taken;
}

}  // namespace calvin
