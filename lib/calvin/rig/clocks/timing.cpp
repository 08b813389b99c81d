// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Velocity times time difference, corner by corner.

#include "calvin/rig/clocks/timing.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace calvin::rig {

namespace {

// The longest way of a corner in so many seconds, px; 0 where none is known.
double farthest(const BoardView& view, double seconds) {
  double far = 0;
  for (const Pixel& v : view.velocity)
    far = std::max(far, std::abs(seconds) * std::hypot(v.u, v.v));
  return far;
}

void take_back(double seconds, BoardView& view) {
  for (std::size_t i = 0; i < view.seen.size(); ++i) {
    const EarlierPoint earlier = earlier_point(view.seen.uv[i], view.velocity[i], seconds);
    view.seen.uv[i] = earlier.uv;
    double& weight = view.seen.weight[i];
    if (weight > 0) weight = 1 / std::hypot(1 / weight, earlier.sigma / view.sigma);
  }
  view.sample = sample_of(view.seen);
}

}  // namespace

std::vector<ViewTimes> view_times(const std::vector<RigCameraViews>& seen,
                                  const std::vector<double>& offsets) {
  constexpr double kSecond = 1e9;  // ns
  const double least = offsets.empty() ? 0 : std::ranges::min(offsets);
  std::vector<ViewTimes> times;
  for (std::size_t c = 0; c < seen.size(); ++c) {
    const double later = offsets.empty() ? 0 : offsets[c] - std::min(least, 0.0);
    const auto add = static_cast<std::uint64_t>(std::llround(kSecond * later));
    ViewTimes& of = times.emplace_back();
    for (const View& view : seen[c].views) {
      const Observation& observation = view.observation;
      const bool is_timed = observation.found() && observation.timestamp != kNoTimestamp;
      of.push_back(is_timed ? observation.timestamp + add : kNoTimestamp);
    }
  }
  return times;
}

void allow_for_timing(const std::vector<ViewTimes>& times, std::vector<BoardView>& views,
                      std::vector<std::vector<std::size_t>>& groups) {
  const auto time_of = [&](std::size_t v) { return times[views[v].of.camera][views[v].of.view]; };
  for (std::vector<std::size_t>& group : groups) {
    // By the mean of their times: what velocities leave, the square of the time, is nearly the same
    // for all cameras then, as if the board lay elsewhere.
    std::uint64_t first = kNoTimestamp;
    for (const std::size_t v : group) first = std::min(first, time_of(v));
    const auto after_first = [&](std::size_t v) {
      return 1e-9 * static_cast<double>(time_of(v) - first);
    };
    double mean = 0;  // s after the first
    for (const std::size_t v : group) mean += after_first(v) / static_cast<double>(group.size());
    const auto late = [&](std::size_t v) { return after_first(v) - mean; };
    std::erase_if(group,
                  [&](std::size_t v) { return farthest(views[v], after_first(v)) > kFarthestWay; });
    for (const std::size_t v : group) {
      if (farthest(views[v], late(v)) > 0) take_back(late(v), views[v]);
    }
  }
}

}  // namespace calvin::rig
