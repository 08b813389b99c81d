// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Distances, angles, and how well the corners that both cameras of a pair see agree.

#include "calvin/rig/result/rig_links.hpp"

#include "calvin/rig/common_corners.hpp"
#include "calvin/rig/joint/camera_distance.hpp"
#include "calvin/rig/pose_unknowns.hpp"
#include "calvin/rig/rig_distances.hpp"
#include "calvin/rig/stereo.hpp"

namespace calvin::rig {

namespace {

double mean_focal(const Camera& a, const Camera& b) {
  return (a.fx() + a.fy() + b.fx() + b.fy()) / 4;
}

void set_errors(const std::vector<std::vector<CommonCorner>>& views, const SE3& b_from_a,
                double focal, RigLink& link) {
  if (const auto error = distance_error(views, b_from_a)) {
    link.bias = error->bias;
    link.spread = error->spread;
  }
  std::vector<CommonCorner> all;
  for (const auto& view : views) all.insert(all.end(), view.begin(), view.end());
  link.epipolar_error = epipolar_error(all, b_from_a, focal);
}

}  // namespace

RigLink link_between(std::size_t a, std::size_t b, const std::vector<SE3>& camera_from_rig,
                     const Eigen::MatrixXd& covariance) {
  RigLink link;
  link.a = a;
  link.b = b;
  const auto at = [](std::size_t camera) { return kPose * static_cast<Eigen::Index>(camera) + 3; };
  Eigen::Matrix<double, 6, 6> places;
  places << covariance.block<3, 3>(at(a), at(a)), covariance.block<3, 3>(at(a), at(b)),
      covariance.block<3, 3>(at(b), at(a)), covariance.block<3, 3>(at(b), at(b));
  const CameraDistance between =
      camera_distance(camera_from_rig[a].inverse(), camera_from_rig[b].inverse(), places);
  link.distance = between.distance;
  link.distance_sigma = between.sigma;
  link.angle = between.angle;
  return link;
}

std::vector<RigLink> links_of(const JointSolve& one, const std::vector<Camera>& cameras,
                              const std::vector<SE3>& camera_from_rig,
                              const Eigen::MatrixXd& covariance) {
  std::vector<SE3> board_from_own(one.views.size());
  std::vector<bool> used(one.views.size(), false);
  for (const PlacedView& placed : one.fit.places.views) {
    board_from_own[placed.view] = placed.board_from_own;
    used[placed.view] = true;
  }
  for (const std::size_t view : one.fit.rejected) used[view] = false;
  std::vector<std::vector<Eigen::Vector3d>> rays(one.views.size());
  const std::vector<CameraPoints> points = points_before(cameras);
  for (std::size_t v = 0; v < one.views.size(); ++v) {
    if (used[v]) rays[v] = points[one.views[v].of.camera].rays(one.views[v].seen.uv);
  }
  std::vector<RigLink> links;
  for (const Link& link : one.links) {
    RigLink& to = links.emplace_back(link_between(link.a, link.b, camera_from_rig, covariance));
    to.views = link.common.size();
    std::vector<std::vector<CommonCorner>> agreeing;
    for (const CommonView& common : link.common) {
      if (!used[common.a] || !used[common.b]) continue;
      agreeing.push_back(
          common_corners(one.views[common.a], one.views[common.b],
                         board_from_own[common.a].inverse() * board_from_own[common.b],
                         rays[common.a], rays[common.b]));
    }
    to.agree = agreeing.size();
    set_errors(agreeing, camera_from_rig[link.b] * camera_from_rig[link.a].inverse(),
               mean_focal(cameras[link.a], cameras[link.b]), to);
  }
  return links;
}

std::optional<std::size_t> weakest_of(const std::vector<RigLink>& links) {
  std::vector<CameraPair> pairs;
  for (const RigLink& link : links) pairs.push_back({link.a, link.b, link.agree});
  return weakest_pair(pairs);
}

}  // namespace calvin::rig
