// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What cannot be solved is told before anything is computed.

#include "calvin/rig/light/light_check.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Core>

#include "calvin/core/text.hpp"
#include "calvin/solve/uncertainty.hpp"
#include "calvin/solve/view.hpp"
#include "calvin/target/point_light.hpp"

namespace calvin::rig {

namespace {

constexpr std::size_t kFewestInstants = 20;  // as the original asks for

tl::unexpected<Error> invalid(std::string message) {
  return make_error(ErrorCode::kInvalidArgument, std::move(message));
}

Status check_camera(const LightCamera& camera, std::size_t instants) {
  if (const Status size = check_image_size(camera.image_size); !size) return size;
  if (camera.seen.size() != instants) {
    return invalid(
        fmt::format("The camera '{}' has {} instants, the first one {}: give all of "
                    "them the same, and nothing where a light was not seen.",
                    camera.name, camera.seen.size(), instants));
  }
  const auto is_outside = [](double at, int length) {
    constexpr double kTolerated = 0.05;  // of the picture, as of a view
    return !(at >= -kTolerated * length && at <= (1 + kTolerated) * length);
  };
  for (const auto& seen : camera.seen) {
    if (!seen) continue;
    if (is_outside(seen->uv.u, camera.image_size.width) ||
        is_outside(seen->uv.v, camera.image_size.height)) {
      return invalid(fmt::format(
          "The camera '{}' has the light at ({:.1f}, {:.1f}), outside of its "
          "picture of {}x{} px.",
          camera.name, seen->uv.u, seen->uv.v, camera.image_size.width, camera.image_size.height));
    }
    if (!is_known_sigma(seen->sigma)) {
      return invalid(fmt::format("The camera '{}' has a sigma of {} px: it is 1e-6 to 1e6.",
                                 camera.name, seen->sigma));
    }
  }
  return {};
}

Status check_counts(const std::vector<LightCamera>& cameras) {
  const bool all_known =
      std::ranges::all_of(cameras, [](const LightCamera& c) { return c.calibration.has_value(); });
  const std::size_t least = all_known ? 2 : 3;
  if (cameras.size() < least) {
    return make_error(
        ErrorCode::kDegenerate,
        fmt::format("{} cameras do not tell their focal lengths by a light: three are "
                    "needed, or two of which both calibrations are given.",
                    cameras.size()));
  }
  std::size_t enough = 0;
  for (std::size_t i = 0; i < cameras.front().seen.size(); ++i) {
    const auto rays =
        std::ranges::count_if(cameras, [&](const LightCamera& c) { return c.seen[i].has_value(); });
    enough += rays >= static_cast<std::ptrdiff_t>(least) ? 1 : 0;
  }
  if (enough >= kFewestInstants) return {};
  return make_error(ErrorCode::kDegenerate,
                    fmt::format("The light was seen by {} cameras at a time at {} instants, and {} "
                                "are the fewest: move it for a minute where their pictures "
                                "overlap, and see that their clocks agree.",
                                least, enough, kFewestInstants));
}

}  // namespace

Status check(const std::vector<LightCamera>& cameras, std::size_t lights) {
  if (cameras.empty()) return invalid("Cameras have to be given.");

  std::set<std::string> names;
  for (const LightCamera& camera : cameras) {
    if (camera.name.empty() || !names.insert(camera.name).second) {
      return invalid(fmt::format("Two cameras are called '{}', or have no name: give each its own.",
                                 camera.name));
    }
    if (const Status own = check_camera(camera, cameras.front().seen.size()); !own) return own;
  }
  if (cameras.front().seen.size() % lights != 0) {
    return invalid(
        fmt::format("{} lights are no instants of a wand of {}: give a place for each "
                    "of its lights at each instant.",
                    cameras.front().seen.size(), lights));
  }
  return check_counts(cameras);
}

Status check_wand(const LightOptions& options) {
  const std::vector<double>& places = options.wand;
  if (places.empty()) return {};
  if (places.size() == 1) {
    return invalid(
        "A wand of one light tells no length: say where two lights or more are along "
        "it.");
  }
  if (Status measures = PointLight{places}.check(); !measures) return measures;
  double least = places[1];
  for (std::size_t k = 2; k < places.size(); ++k)
    least = std::min(least, places[k] - places[k - 1]);
  constexpr double kWorst = 0.1;  // of a distance: beyond that it would say nothing
  if (options.wand_sigma >= 0 && options.wand_sigma <= kWorst * least) return {};
  return invalid(
      fmt::format("The lights of a wand cannot be known to {} m where two of them are "
                  "{} m apart: give 0 to a tenth of that.",
                  options.wand_sigma, least));
}

Result<std::vector<KnownPlace>> known_places(const std::vector<LightCamera>& cameras,
                                             const std::vector<CameraPlace>& places) {
  std::vector<KnownPlace> known;
  std::set<std::string> names;
  for (const CameraPlace& place : places) {
    const auto camera = std::ranges::find(cameras, place.camera, &LightCamera::name);
    if (camera == cameras.end() || !names.insert(place.camera).second) {
      std::vector<std::string> all;
      for (const LightCamera& one : cameras) all.push_back(one.name);
      return invalid(
          fmt::format("A known place is that of '{}', which is no camera or has another "
                      "place: the cameras are '{}'.",
                      place.camera, join(all, "', '")));
    }
    const Eigen::Vector3d at(place.place[0], place.place[1], place.place[2]);
    if (!at.allFinite()) return invalid("A known place is not finite.");
    known.push_back({static_cast<std::size_t>(camera - cameras.begin()), at});
  }
  if (known.size() == 1) {
    return invalid(
        "The place of one camera tells nothing of the others: give two for the unit, "
        "three or more for the frame.");
  }
  return known;
}

}  // namespace calvin::rig
