// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Pairs the views of the last moment.

#include "calvin/session/rig/recent_instants.hpp"

#include <algorithm>
#include <utility>

#include "calvin/rig/rig_views.hpp"

namespace calvin {

void RecentInstants::clear() {
  cameras_.clear();
  looked_at_ = last_taken_ = 0;
}

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

RecentInstants::Newest RecentInstants::newest() const {
  Newest newest{0, kNoTimestamp};
  for (const auto& camera : cameras_) {
    if (camera.empty()) continue;
    const std::uint64_t last = camera.back()->observation.timestamp;
    newest.of_any = std::max(newest.of_any, last);
    newest.of_all = std::min(newest.of_all, last);
  }
  newest.of_all = std::max(newest.of_all, newest.of_any - std::min(newest.of_any, kLatest));
  return newest;
}

std::vector<ViewTimes> RecentInstants::times_of_views() const {
  std::vector<ViewTimes> times;
  for (const auto& camera : cameras_) {
    ViewTimes& of = times.emplace_back();
    for (const SharedView& view : camera) of.push_back(view->observation.timestamp);
  }
  return times;
}

// Also where time has gone backwards, as after a seek.
bool RecentInstants::is_apart(std::uint64_t timestamp, std::uint64_t interval) const {
  return last_taken_ == 0 || timestamp < last_taken_ || timestamp >= last_taken_ + interval;
}

std::vector<std::vector<SharedView>> RecentInstants::take(std::uint64_t tolerance,
                                                          std::uint64_t interval) {
  std::vector<std::vector<SharedView>> taken(cameras_.size());
  const Newest now = newest();
  // Also where time has gone backwards, as after a seek.
  const bool is_soon = now.of_any >= looked_at_ && now.of_any < looked_at_ + interval;
  if (now.of_any == 0 || is_soon) return taken;
  looked_at_ = now.of_any;
  const std::vector<ViewTimes> times = times_of_views();
  // An instant is taken as a whole, or waits for its last picture.
  const auto is_over = [&](std::uint64_t timestamp) { return timestamp + tolerance < now.of_all; };
  std::vector<std::size_t> waiting;  // of each camera, the first view that is not done with
  for (const ViewTimes& of : times) {
    waiting.push_back(static_cast<std::size_t>(std::ranges::count_if(of, is_over)));
  }
  for (const Instant& instant : pair_instants(times, tolerance).instants) {
    const bool over = is_over(instant.timestamp);
    const bool wanted = over && is_apart(instant.timestamp, interval);
    if (wanted) last_taken_ = instant.timestamp;
    for (const RigView& of : instant.views) {
      std::size_t& first = waiting[of.camera];
      first = over ? std::max(first, of.view + 1) : std::min(first, of.view);
      if (wanted) taken[of.camera].push_back(cameras_[of.camera][of.view]);
    }
  }
  for (std::size_t c = 0; c < cameras_.size(); ++c) {
    const auto count = static_cast<std::ptrdiff_t>(waiting[c]);
    cameras_[c].erase(cameras_[c].begin(), cameras_[c].begin() + count);
  }
  return taken;
}

}  // namespace calvin
