// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Velocity times time difference, corner by corner.

#include "calvin/rig/joint/timing.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace calvin::rig {

namespace {

// The longest way of a corner in so many seconds, px; 0 where none is known.
double farthest(const Observation& seen, double seconds) {
  double far = 0;
  if (seen.velocity.size() != seen.uv.size()) return far;
  for (const Pixel& v : seen.velocity) far = std::max(far, seconds * std::hypot(v.u, v.v));
  return far;
}

void take_back(const Observation& seen, double seconds, BoardView& view) {
  for (std::size_t i = 0; i < view.seen.size(); ++i) {
    const EarlierPoint earlier = earlier_point(view.seen.uv[i], seen.velocity[i], seconds);
    view.seen.uv[i] = earlier.uv;
    double& weight = view.seen.weight[i];
    if (weight > 0) weight = 1 / std::hypot(1 / weight, earlier.sigma / view.sigma);
  }
}

}  // namespace

void allow_for_timing(const std::vector<RigCameraViews>& seen, std::vector<BoardView>& views,
                      std::vector<std::vector<std::size_t>>& groups) {
  const auto observation_of = [&](std::size_t v) -> const Observation& {
    return seen[views[v].of.camera].views[views[v].of.view].observation;
  };
  for (std::vector<std::size_t>& group : groups) {
    std::uint64_t first = kNoTimestamp;
    for (const std::size_t v : group) first = std::min(first, observation_of(v).timestamp);
    const auto late = [&](std::size_t v) {
      return 1e-9 * static_cast<double>(observation_of(v).timestamp - first);
    };
    std::erase_if(
        group, [&](std::size_t v) { return farthest(observation_of(v), late(v)) > kFarthestWay; });
    for (const std::size_t v : group) {
      if (farthest(observation_of(v), late(v)) > 0) take_back(observation_of(v), late(v), views[v]);
    }
  }
}

}  // namespace calvin::rig
