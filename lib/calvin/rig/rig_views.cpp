// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Goes through the pictures of all cameras in the order of time.

#include "calvin/rig/rig_views.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

namespace calvin {

namespace {

struct TimedView {
  std::uint64_t timestamp = 0;
  RigView of;
};

std::vector<TimedView> in_order(const std::vector<ViewTimes>& cameras) {
  std::vector<TimedView> all;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    for (std::size_t v = 0; v < cameras[c].size(); ++v) {
      if (cameras[c][v] != kNoTimestamp) all.push_back({cameras[c][v], {c, v}});
    }
  }
  std::ranges::sort(all, {}, [](const TimedView& view) {
    return std::tuple(view.timestamp, view.of.camera, view.of.view);
  });
  return all;
}

bool is_shared(const Instant& instant, InstantsOf of) {
  if (of == InstantsOf::kAny) return true;
  if (of == InstantsOf::kTwoViews) return instant.views.size() > 1;
  return std::ranges::any_of(instant.views, [&](const RigView& view) {
    return view.camera != instant.views.front().camera;
  });
}

}  // namespace

std::vector<RigCameraViews> views_of_rig(const Rig& rig, const std::vector<RigCameraViews>& seen) {
  std::vector<RigCameraViews> ordered;
  for (const RigCamera& camera : rig.cameras) {
    const auto own = std::ranges::find_if(seen, [&](const RigCameraViews& one) {
      return one.calibration.camera == camera.calibration.camera;
    });
    ordered.push_back({camera.calibration, own != seen.end() ? own->views : std::vector<View>()});
  }
  return ordered;
}

Instants pair_instants(const std::vector<RigCameraViews>& cameras, std::uint64_t tolerance,
                       InstantsOf of) {
  std::vector<ViewTimes> times;
  for (const RigCameraViews& camera : cameras) {
    ViewTimes& own = times.emplace_back();
    for (const View& view : camera.views) {
      own.push_back(view.observation.found() ? view.observation.timestamp : kNoTimestamp);
    }
  }
  return pair_instants(times, tolerance, of);
}

Instants pair_instants(const std::vector<ViewTimes>& cameras, std::uint64_t tolerance,
                       InstantsOf of) {
  Instants result;
  Instant now;
  std::map<std::size_t, std::uint64_t> pictures;  // of this instant, by camera
  const auto end_instant = [&] {
    if (is_shared(now, of)) {
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

EarlierPoint earlier_point(Pixel uv, Pixel velocity, double seconds) {
  // What velocities are off by, of the way that a point moves: by the pictures on both sides, which
  // leave how its acceleration changes.
  constexpr double kWrong = 0.03;
  return {{uv.u - seconds * velocity.u, uv.v - seconds * velocity.v},
          kWrong * std::abs(seconds) * std::hypot(velocity.u, velocity.v)};
}

std::optional<std::size_t> weakest_pair(const std::vector<CameraPair>& pairs) {
  if (pairs.empty()) return std::nullopt;
  std::set<std::size_t> joined = {pairs.front().a};
  std::optional<std::size_t> weakest;
  for (;;) {
    std::optional<std::size_t> best;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      if (joined.contains(pairs[i].a) == joined.contains(pairs[i].b)) continue;
      if (!best || pairs[i].views > pairs[*best].views) best = i;
    }
    if (!best) return weakest;
    joined.insert({pairs[*best].a, pairs[*best].b});
    if (!weakest || pairs[*best].views < pairs[*weakest].views) weakest = best;
  }
}

}  // namespace calvin
