// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Puts observations of a light together by their times.

#include "calvin/rig/light_camera.hpp"

#include <map>
#include <utility>

#include <fmt/format.h>

#include "calvin/rig/rig_views.hpp"

namespace calvin {

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
      const double sigma = one.sigma.empty() ? 1 : one.sigma.front();
      result.cameras[view.camera].seen[i] = LightPoint{one.uv.front(), sigma};
    }
  }
  return result;
}

}  // namespace calvin
