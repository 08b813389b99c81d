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
std::optional<LightPoint> light_at(const Observation& seen, std::size_t point,
                                   std::uint64_t timestamp) {
  const double sigma = point < seen.sigma.size() ? seen.sigma[point] : 1;
  if (seen.velocity.size() != seen.uv.size()) return LightPoint{seen.uv[point], sigma};
  const double late = 1e-9 * static_cast<double>(seen.timestamp - timestamp);
  const Pixel& velocity = seen.velocity[point];
  if (late * std::hypot(velocity.u, velocity.v) > kFarthestWay) return std::nullopt;
  const EarlierPoint earlier = earlier_point(seen.uv[point], velocity, late);
  if (late > 0 && !is_within(earlier.uv, seen.image_size)) return std::nullopt;
  return LightPoint{earlier.uv, std::hypot(sigma, earlier.sigma)};
}

// Whether the points of an observation are lights of such a wand, or the one light.
bool is_of(const Observation& seen, std::size_t lights) {
  return lights > 1 ? !seen.uv.empty() && seen.ids.size() == seen.uv.size() : seen.uv.size() == 1;
}

Status check_ids(const Observation& seen, std::size_t lights) {
  for (const int id : seen.ids) {
    if (lights == 1 || (id >= 0 && static_cast<std::size_t>(id) < lights)) continue;
    return make_error(
        ErrorCode::kInvalidArgument,
        fmt::format("The camera '{}' has seen a light with the number {}, and those of a wand of "
                    "{} lights are 0 to {}: say where all lights of the wand are.",
                    seen.camera, id, lights, lights - 1));
  }
  return {};
}

}  // namespace

Result<LightCameras> light_cameras(const std::vector<Observation>& seen, std::uint64_t tolerance,
                                   std::size_t lights) {
  LightCameras result;
  result.lights = lights;
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
    if (const Status known = check_ids(one, lights); !known) return tl::unexpected(known.error());
    own.push_back(&one);
    result.left_out += one.uv.size() > 1 && !is_of(one, lights) ? 1 : 0;
  }
  std::vector<const std::vector<const Observation*>*> lists;
  std::vector<ViewTimes> times;
  for (const auto& [name, own] : by_camera) {
    lists.push_back(&own);
    result.cameras.push_back({name, own.front()->image_size, std::nullopt, {}});
    ViewTimes& of = times.emplace_back();
    for (const Observation* one : own) {
      of.push_back(is_of(*one, lights) ? one->timestamp : kNoTimestamp);
    }
  }
  const Instants instants = pair_instants(times, tolerance);
  result.farthest = instants.farthest;
  for (LightCamera& camera : result.cameras) {
    camera.seen.resize(lights * instants.instants.size());
  }
  for (std::size_t i = 0; i < instants.instants.size(); ++i) {
    for (const RigView& view : instants.instants[i].views) {
      const Observation& one = *(*lists[view.camera])[view.view];
      for (std::size_t k = 0; k < one.uv.size(); ++k) {
        const auto light = lights > 1 ? static_cast<std::size_t>(one.ids[k]) : 0;
        result.cameras[view.camera].seen[lights * i + light] =
            light_at(one, k, instants.instants[i].timestamp);
      }
    }
  }
  return result;
}

void set_known_distance(const CameraBaseline& known, LightOptions& options) {
  options.places = {{known.a, {}}, {known.b, {known.distance, 0, 0}}};
  options.length_sigma = known.sigma;
}

}  // namespace calvin
