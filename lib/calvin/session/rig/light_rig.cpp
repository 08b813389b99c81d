// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Leaves cameras out that share too little, and counts what pairs of cameras have in common.

#include "calvin/session/rig/light_rig.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Core>

#include "calvin/rig/joint/camera_distance.hpp"
#include "calvin/rig/solve_light.hpp"

namespace calvin {

namespace {

// Of a camera that shares fewer instants with others no place is told.
constexpr std::size_t kFewestShared = 20;

// At each instant.
std::size_t lights_of(const RigJob& job) {
  return std::max<std::size_t>(job.light->wand.size(), 1);
}

// The instant of a sighting with this number is that over the lights of a wand.
Result<LightCameras> cameras_of(const RigJob& job) {
  std::vector<Observation> seen;
  for (const RigJob::Camera& camera : job.cameras) {
    for (const SharedView& view : camera.views) {
      seen.push_back(view->observation);
      seen.back().camera = camera.name;
    }
  }
  auto by_name = light_cameras(seen, job.options.tolerance, lights_of(job));
  if (!by_name) return by_name;
  std::vector<LightCamera> in_order;
  for (const RigJob::Camera& camera : job.cameras) {
    const auto own = std::ranges::find(by_name->cameras, camera.name, &LightCamera::name);
    if (own == by_name->cameras.end()) continue;
    in_order.push_back(std::move(*own));
    if (camera.calibration) in_order.back().calibration = *camera.calibration;
  }
  by_name->cameras = std::move(in_order);
  return by_name;
}

// How many cameras have to see the light at a time.
std::size_t fewest_cameras(const std::vector<LightCamera>& cameras) {
  const bool all_known =
      std::ranges::all_of(cameras, [](const LightCamera& c) { return c.calibration.has_value(); });
  return all_known ? 2 : 3;
}

// Instants at which the camera and enough others have seen the light.
std::size_t shared_instants(const std::vector<LightCamera>& cameras, const LightCamera& camera) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < camera.seen.size(); ++i) {
    if (!camera.seen[i]) continue;
    const auto rays =
        std::ranges::count_if(cameras, [&](const LightCamera& c) { return c.seen[i].has_value(); });
    count += static_cast<std::size_t>(rays) >= fewest_cameras(cameras) ? 1 : 0;
  }
  return count;
}

// One camera after the other, the poorest first. Where too few would stay all of them do, and the
// solve says what is missing.
std::vector<LeftOutCamera> leave_out(std::vector<LightCamera>& cameras) {
  std::vector<LightCamera> left = cameras;
  std::vector<LeftOutCamera> left_out;
  while (left.size() >= fewest_cameras(left)) {
    const auto poorest = std::ranges::min_element(
        left, {}, [&](const LightCamera& c) { return shared_instants(left, c); });
    const std::size_t shared = shared_instants(left, *poorest);
    if (shared >= kFewestShared) {
      cameras = std::move(left);
      return left_out;
    }
    left_out.push_back(
        {poorest->name,
         fmt::format("The camera '{}' has seen the light at {} instants at which {} others did, "
                     "and {} are the fewest: move the light where it and they see it at a time, "
                     "and see that its clock agrees with theirs.",
                     poorest->name, shared, fewest_cameras(left) - 1, kFewestShared)});
    left.erase(poorest);
  }
  return {};
}

// Of the places of all cameras, 3 numbers each, rig.
Eigen::MatrixXd covariance_of_places(const LightSolution& solved) {
  const auto all = static_cast<Eigen::Index>(solved.names.size());
  const Eigen::Map<const Eigen::MatrixXd> covariance(solved.covariance.data(), all, all);
  std::vector<Eigen::Index> places;
  for (Eigen::Index i = 0; i < all; ++i) {
    const std::string& name = solved.names[static_cast<std::size_t>(i)];
    if (name.ends_with(".tx") || name.ends_with(".ty") || name.ends_with(".tz")) {
      places.push_back(i);
    }
  }
  return covariance(places, places);
}

// Instants at which both have seen a light, and of these those at which both sightings are used.
void count_instants(const std::vector<LightCamera>& cameras, const LightSolution& solved,
                    std::size_t lights, RigLink& link) {
  for (std::size_t first = 0; first < cameras[link.a].seen.size(); first += lights) {
    bool is_seen = false;
    bool is_used = false;
    for (std::size_t i = first; i < first + lights; ++i) {
      is_seen |= cameras[link.a].seen[i] && cameras[link.b].seen[i];
      is_used |= solved.used[link.a][i] && solved.used[link.b][i];
    }
    link.views += is_seen ? 1 : 0;
    link.agree += is_used ? 1 : 0;
  }
}

RigLink link_between(const std::vector<LightCamera>& cameras, const LightSolution& solved,
                     std::size_t lights, const Eigen::MatrixXd& places, std::size_t a,
                     std::size_t b) {
  RigLink link;
  link.a = a;
  link.b = b;
  count_instants(cameras, solved, lights, link);
  const auto at = [](std::size_t camera) { return 3 * static_cast<Eigen::Index>(camera); };
  Eigen::Matrix<double, 6, 6> of_both;
  of_both << places.block<3, 3>(at(a), at(a)), places.block<3, 3>(at(a), at(b)),
      places.block<3, 3>(at(b), at(a)), places.block<3, 3>(at(b), at(b));
  const rig::CameraDistance between =
      rig::camera_distance(to_se3(solved.rig.cameras[a].rig_from_camera),
                           to_se3(solved.rig.cameras[b].rig_from_camera), of_both);
  link.distance = between.distance;
  link.distance_sigma = between.sigma;
  link.angle = between.angle;
  return link;
}

std::vector<RigLink> links_of(const std::vector<LightCamera>& cameras, const LightSolution& solved,
                              std::size_t lights) {
  const Eigen::MatrixXd places = covariance_of_places(solved);
  std::vector<RigLink> links;
  for (std::size_t a = 0; a < cameras.size(); ++a) {
    for (std::size_t b = a + 1; b < cameras.size(); ++b) {
      links.push_back(link_between(cameras, solved, lights, places, a, b));
      if (links.back().views == 0) links.pop_back();
    }
  }
  return links;
}

// Known places of cameras that are there.
LightOptions options_of(const RigJob& job, const std::vector<LeftOutCamera>& left_out) {
  LightOptions options = *job.light;
  std::erase_if(options.places, [&](const CameraPlace& place) {
    const auto is_it = [&](const LeftOutCamera& out) { return out.camera == place.camera; };
    return std::ranges::any_of(left_out, is_it) || std::ranges::any_of(job.left_out, is_it);
  });
  return options;
}

}  // namespace

Result<RigSolution> solve_light_rig(const RigJob& job, std::stop_token stop) {
  auto seen = cameras_of(job);
  if (!seen) return tl::unexpected(seen.error());
  std::vector<LeftOutCamera> left_out = leave_out(seen->cameras);
  auto solved = solve_light(seen->cameras, options_of(job, left_out), std::move(stop));
  if (!solved) return tl::unexpected(solved.error());
  RigSolution solution;
  solution.links = links_of(seen->cameras, *solved, lights_of(job));
  std::vector<CameraPair> pairs;
  for (const RigLink& link : solution.links) pairs.push_back({link.a, link.b, link.agree});
  solution.weakest = weakest_pair(pairs);
  solution.farthest = seen->farthest;
  for (std::size_t c = 0; c < seen->cameras.size(); ++c) {
    for (std::size_t i = 0; i < solved->used[c].size(); ++i) {
      if (!seen->cameras[c].seen[i] || solved->used[c][i]) continue;
      solution.rejected.push_back({c, i / lights_of(job)});
    }
  }
  solution.rig = std::move(solved->rig);
  solution.rig.pairing_tolerance = job.options.tolerance;
  solution.left_out = std::move(left_out);
  solution.remarks = std::move(solved->remarks);
  return solution;
}

}  // namespace calvin
