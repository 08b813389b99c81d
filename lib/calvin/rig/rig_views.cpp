// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Goes through the pictures of all cameras in the order of time.

#include "calvin/rig/rig_views.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

namespace calvin {

namespace {

struct TimedView {
  std::uint64_t timestamp = 0;
  RigView of;
};

std::vector<TimedView> in_order(const std::vector<RigCameraViews>& cameras) {
  std::vector<TimedView> all;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    for (std::size_t v = 0; v < cameras[c].views.size(); ++v) {
      const Observation& seen = cameras[c].views[v].observation;
      if (seen.timestamp != kNoTimestamp && seen.found()) all.push_back({seen.timestamp, {c, v}});
    }
  }
  std::ranges::sort(all, {}, [](const TimedView& view) {
    return std::tuple(view.timestamp, view.of.camera, view.of.view);
  });
  return all;
}

bool is_shared(const Instant& instant) {
  return std::ranges::any_of(instant.views, [&](const RigView& view) {
    return view.camera != instant.views.front().camera;
  });
}

}  // namespace

Instants pair_instants(const std::vector<RigCameraViews>& cameras, std::uint64_t tolerance) {
  Instants result;
  Instant now;
  std::map<std::size_t, std::uint64_t> pictures;  // of this instant, by camera
  const auto end_instant = [&] {
    if (is_shared(now)) {
      std::uint64_t last = now.timestamp;
      for (const auto& [camera, timestamp] : pictures) last = std::max(last, timestamp);
      result.farthest = std::max(result.farthest, last - now.timestamp);
      std::ranges::sort(now.views, {},
                        [](const RigView& v) { return std::pair(v.camera, v.view); });
      result.instants.push_back(std::move(now));
    }
    now = {};
    pictures.clear();
  };
  for (const TimedView& view : in_order(cameras)) {
    const auto picture = pictures.find(view.of.camera);
    const bool is_next = picture != pictures.end() && picture->second != view.timestamp;
    const bool is_late = !pictures.empty() && view.timestamp - now.timestamp > tolerance;
    if (is_next || is_late) end_instant();
    if (pictures.empty()) now.timestamp = view.timestamp;
    pictures.emplace(view.of.camera, view.timestamp);
    now.views.push_back(view.of);
  }
  end_instant();
  return result;
}

}  // namespace calvin
