// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Puts observations of a light together by their times.

#include "calvin/rig/light_camera.hpp"

#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "calvin/rig/rig_views.hpp"

namespace calvin {

namespace {

bool is_within(Pixel uv, ImageSize size) {
  return uv.u >= 0 && uv.v >= 0 && uv.u <= size.width - 1 && uv.v <= size.height - 1;
}

// Absent where it moves too far to tell, or was not in the picture yet.
std::optional<LightPoint> light_at(const Observation& seen, std::uint64_t timestamp) {
  const double sigma = seen.sigma.empty() ? 1 : seen.sigma.front();
  if (seen.velocity.size() != 1) return LightPoint{seen.uv.front(), sigma};
  const double late = 1e-9 * static_cast<double>(seen.timestamp - timestamp);
  const Pixel& velocity = seen.velocity.front();
  if (late * std::hypot(velocity.u, velocity.v) > kFarthestWay) return std::nullopt;
  const EarlierPoint earlier = earlier_point(seen.uv.front(), velocity, late);
  if (late > 0 && !is_within(earlier.uv, seen.image_size)) return std::nullopt;
  return LightPoint{earlier.uv, std::hypot(sigma, earlier.sigma)};
}

}  // namespace

Result<LightCameras> light_cameras(const std::vector<Observation>& seen, std::uint64_t tolerance) {
  LightCameras result;
  std::map<std::string, std::vector<const Observation*>> by_camera;
  for (const Observation& one : seen) {
    auto& own = by_camera[one.camera];
    if (!own.empty() && own.front()->image_size != one.image_size) {
      return make_error(
          ErrorCode::kInvalidArgument,
          fmt::format("The camera '{}' has pictures of {}x{} px and of {}x{}: give "
                      "those of one size.",
                      one.camera, own.front()->image_size.width, own.front()->image_size.height,
                      one.image_size.width, one.image_size.height));
    }
    own.push_back(&one);
    result.left_out += one.uv.size() > 1 ? 1 : 0;
  }
  std::vector<const std::vector<const Observation*>*> lists;
  std::vector<ViewTimes> times;
  for (const auto& [name, own] : by_camera) {
    lists.push_back(&own);
    result.cameras.push_back({name, own.front()->image_size, std::nullopt, {}});
    ViewTimes& of = times.emplace_back();
    for (const Observation* one : own) {
      of.push_back(one->uv.size() == 1 ? one->timestamp : kNoTimestamp);
    }
  }
  const Instants instants = pair_instants(times, tolerance);
  result.farthest = instants.farthest;
  for (LightCamera& camera : result.cameras) camera.seen.resize(instants.instants.size());
  for (std::size_t i = 0; i < instants.instants.size(); ++i) {
    for (const RigView& view : instants.instants[i].views) {
      const Observation& one = *(*lists[view.camera])[view.view];
      result.cameras[view.camera].seen[i] = light_at(one, instants.instants[i].timestamp);
    }
  }
  return result;
}

}  // namespace calvin
