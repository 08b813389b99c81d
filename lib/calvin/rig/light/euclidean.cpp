// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Takes cameras out of a projective space, and tells what is in front of them.

#include "calvin/rig/light/euclidean.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "calvin/core/text.hpp"

namespace calvin::rig {

namespace {

// The root of the mean of fx^2 and fy^2, where K K^T is this up to scale; 1 where it is none.
double focal_of(const Eigen::Matrix3d& image) {
  const Eigen::Matrix3d m = image / image(2, 2);
  const double squared = 0.5 * (m(0, 0) - m(0, 2) * m(0, 2) + m(1, 1) - m(1, 2) * m(1, 2));
  constexpr double kLeast = 0.05;
  constexpr double kMost = 20;
  return squared > 0 ? std::clamp(std::sqrt(squared), kLeast, kMost) : 1;
}

SE3 pose_of(const Matrix34& projection, double focal) {
  Matrix34 p = projection;
  p.row(2) *= focal;
  if (p.leftCols<3>().determinant() < 0) p = -p;
  const double scale = std::cbrt(p.leftCols<3>().determinant());
  return {closest_rotation(p.leftCols<3>() / scale), p.col(3) / scale};
}

tl::unexpected<Error> mirrored(const std::vector<std::string>& names) {
  return make_error(ErrorCode::kDegenerate,
                    fmt::format("The picture of '{}' is mirrored beside those of the others: take "
                                "it as the camera gives it (videoflip may be in the pipeline).",
                                join(names, "', '")));
}

// Of the points that each camera has seen, how many more are in front of it than behind it.
std::vector<int> sides(const EuclideanReconstruction& all,
                       const std::vector<std::vector<bool>>& agrees) {
  std::vector<int> more(agrees.size(), 0);
  for (std::size_t c = 0; c < agrees.size(); ++c) {
    for (std::size_t i = 0; i < all.points.size(); ++i) {
      if (!all.points[i] || !agrees[c][i]) continue;
      more[c] += (all.camera_from_rig[c] * *all.points[i]).z() > 0 ? 1 : -1;
    }
  }
  return more;
}

// Space may come out as its image in a point, where what is in front is behind.
Result<EuclideanReconstruction> upright(EuclideanReconstruction all,
                                        const std::vector<std::vector<bool>>& agrees,
                                        const std::vector<std::string>& names) {
  std::vector<int> more = sides(all, agrees);
  const auto behind = std::ranges::count_if(more, [](int m) { return m < 0; });
  if (2 * behind > static_cast<std::ptrdiff_t>(more.size())) {
    for (SE3& pose : all.camera_from_rig) pose.translation = -pose.translation;
    for (auto& point : all.points) {
      if (point) *point = -*point;
    }
    for (int& m : more) m = -m;
  }
  std::vector<std::string> wrong;
  for (std::size_t c = 0; c < more.size(); ++c) {
    if (more[c] < 0) wrong.push_back(names[c]);
  }
  if (!wrong.empty()) return mirrored(wrong);
  return all;
}

// In the frame of the first camera, and at a distance of 1 to the farthest other one.
void to_first_camera(EuclideanReconstruction& all) {
  const SE3 first = all.camera_from_rig.front();
  const SE3 back = first.inverse();
  double farthest = 0;
  for (SE3& pose : all.camera_from_rig) {
    pose = pose * back;
    farthest = std::max(farthest, pose.translation.norm());
  }
  for (SE3& pose : all.camera_from_rig) pose.translation /= farthest;
  for (auto& point : all.points) {
    if (point) *point = (first * *point / farthest).eval();
  }
}

}  // namespace

Result<EuclideanReconstruction> upgrade(const LinearReconstruction& linear,
                                        const Eigen::Matrix4d& h, const std::vector<bool>& is_known,
                                        const std::vector<std::string>& names) {
  EuclideanReconstruction result;
  for (std::size_t c = 0; c < linear.projections.size(); ++c) {
    const Matrix34 own = linear.projections[c] * h;
    const Eigen::Matrix3d image = own.leftCols<3>() * own.leftCols<3>().transpose();
    result.focal.push_back(is_known[c] ? 1 : focal_of(image));
    result.camera_from_rig.push_back(pose_of(own, result.focal.back()));
  }
  const Eigen::Matrix4d back = h.inverse();
  for (const auto& point : linear.points) {
    auto& to = result.points.emplace_back();
    if (point) to = (back * *point).hnormalized();
    if (to && !to->allFinite()) to.reset();
  }
  auto facing = upright(std::move(result), linear.agrees, names);
  if (facing) to_first_camera(*facing);
  return facing;
}

}  // namespace calvin::rig
