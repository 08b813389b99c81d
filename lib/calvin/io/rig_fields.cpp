// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Cameras, rotations and names as the rigs of several programs have them.

#include "calvin/io/rig_fields.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "calvin/camera/camera.hpp"
#include "calvin/core/text.hpp"

namespace calvin::io {

std::optional<Calibration> camera_of(Fields& fields, std::string_view key,
                                     const OpenCvCamera& numbers, ImageSize size) {
  auto calibration = from_opencv(numbers, size);
  const auto made = calibration ? Camera::make(*calibration)
                                : Result<Camera>(tl::unexpected(calibration.error()));
  if (made) return *std::move(calibration);
  fields.complain(key, "is wrong: " + made.error().message, made.error().code);
  return std::nullopt;
}

Result<OpenCvCamera> shortest_opencv(const Calibration& calibration) {
  auto numbers = to_opencv(calibration);
  if (!numbers || numbers->fisheye) return numbers;
  auto& d = numbers->distortion;
  if (d.size() == 5 && d.back() == 0) d.pop_back();
  return numbers;
}

std::optional<Eigen::Matrix3d> rotation_near(const Eigen::Matrix3d& matrix) {
  constexpr double kClose = 1e-3;
  if (!matrix.allFinite()) return std::nullopt;
  const Eigen::Matrix3d closest = closest_rotation(matrix);
  if ((closest - matrix).cwiseAbs().maxCoeff() < kClose) return closest;
  return std::nullopt;
}

bool is_near(const Eigen::Vector3d& place) {
  constexpr double kFarthest = 1e6;  // m
  return place.cwiseAbs().maxCoeff() < kFarthest;
}

std::string world_of(const std::vector<RigCamera>& cameras) {
  const auto first = std::ranges::find_if(cameras, [](const RigCamera& camera) {
    constexpr double kNothing = 1e-9;  // m, rad
    const SE3 pose = to_se3(camera.rig_from_camera);
    return pose.translation.norm() < kNothing && log_so3(pose.rotation).norm() < kNothing;
  });
  return first == cameras.end() ? kReferenceWorld : first->calibration.camera;
}

const std::string* repeated_name(const std::vector<RigCamera>& cameras) {
  std::vector<const std::string*> names;
  for (const RigCamera& camera : cameras) names.push_back(&camera.calibration.camera);
  std::ranges::sort(names, [](auto* a, auto* b) { return *a < *b; });
  const auto twice = std::ranges::adjacent_find(names, [](auto* a, auto* b) { return *a == *b; });
  return twice == names.end() ? nullptr : *twice;
}

std::string list_text(const std::vector<double>& values) {
  std::vector<std::string> texts;
  for (const double value : values) texts.push_back(format_double(value));
  return fmt::format("[{}]", join(texts, ", "));
}

Eigen::Matrix3d matrix_of(const std::vector<double>& row_major) {
  using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  return Eigen::Map<const RowMajor>(row_major.data());
}

}  // namespace calvin::io
