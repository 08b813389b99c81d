// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where a solve begins: guesses of the camera from the views alone. Internal.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/image.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/solve/residuals/points.hpp"

namespace calvin {

// fx fy cx cy, px; no distortion.
using Guess = std::array<double, 4>;

// The unit rays of the corners before a pinhole one image width before the image, whose axis meets
// the centre of the image.
[[nodiscard]] std::vector<Eigen::Vector3d> unit_rays(const PointSet& view, ImageSize size);

// From a view's board to the plane one image width before a pinhole whose axis meets the centre of
// the image: numbers near 1. Absent where the corners determine none, and for points that do not
// lie about the plane z = 0.
[[nodiscard]] std::optional<Eigen::Matrix3d> view_homography(const PointSet& view, ImageSize size);

// From these homographies, for lenses near enough to a pinhole: Zhang's closed form, and with the
// principal point at the centre of the image, the focal length by least squares over all views and
// the median over single views (which a wrong view does not move). Guesses with impossible signs or
// sizes are left out; OpenCV's initCameraMatrix2D takes roots of absolute values instead and so
// returns a wrong camera where it should fail.
[[nodiscard]] std::vector<Guess> closed_form_guesses(std::span<const Eigen::Matrix3d> homographies,
                                                     ImageSize size);

// From one view of points in space, by its projection_matrix(): the skew left out. Absent where the
// points tell no camera, or one with impossible signs or sizes.
[[nodiscard]] std::optional<Guess> guess_in_space(const PointSet& view, ImageSize size);

// camera_from_board of a view_homography() for a guessed camera.
[[nodiscard]] std::optional<SE3> pose_by_guess(const Eigen::Matrix3d& homography,
                                               const Guess& guess, ImageSize size);

// Cameras with focal lengths from very wide to tele, principal point at the centre; `perspective`
// leaves out focal lengths that no perspective lens has.
[[nodiscard]] std::vector<Guess> focal_grid(ImageSize size, bool perspective);

}  // namespace calvin
