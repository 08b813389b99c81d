// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a method of an older tool makes of views by itself, before any least squares. Internal.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/core/image.hpp"
#include "calvin/core/result.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/solve/residuals/points.hpp"

namespace calvin {

// Takes (x, y, z, 1) of a board to a ray.
using RayFromBoard = Eigen::Matrix<double, 3, 4>;

struct MethodResult {
  Camera camera;
  std::vector<SE3> camera_from_board;  // of the views given, m
  std::vector<std::string> remarks;    // what only this method has: sentences for the user
  // The camera that the least squares start from, where that is another one.
  std::optional<Camera> start;

  // Of a method that no least squares follow, for each view: what the camera was fitted to, where
  // poses are only near that. Empty: the poses.
  std::vector<RayFromBoard> ray_from_board = {};
  // Views and corners of them that were left out as outliers.
  std::vector<std::pair<std::size_t, std::size_t>> left_out = {};
  // Parameters of the camera that were estimated, in their order, and their covariance.
  std::vector<std::string> estimated = {};
  Eigen::MatrixXd covariance = {};
};

struct MethodInput {
  std::span<const PointSet> views;
  ImageSize size;     // px
  bool skew = false;  // whether the axes of the image may be oblique
  // Whether the principal point is at the centre of the image, and fx = fy, where a method can make
  // use of that.
  bool centered = false;
  bool square = false;
  // For methods that no least squares follow: whether they refine what they find by themselves, the
  // model that was asked for, and whether outliers are left out.
  bool refine = true;
  std::string_view model = "brown5";
  bool reject_outliers = true;
};

}  // namespace calvin
