// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// InverseModel: from where a point is seen to where it would be without distortion, in closed form.
//
// J. Heikkila, O. Silven, A Four-step Camera Calibration Procedure with Implicit Image Correction,
// CVPR 1997, equations 12 and 13:
//
//   x = (d (1 + a1 s + a2 s^2) + (2 a3 dx dy + a4 (s + 2 dx^2), a3 (s + 2 dy^2) + 2 a4 dx dy)) / G
//   G = (a5 s + a6 dx + a7 dy + a8) s + 1,    s = |d|^2
//
// with d where the point is seen, from the principal point in focal lengths. Release 3.0 of his
// toolbox has the same with a5 to a8 at 0: its K1 K2 T1 T2 are a1 to a4 there, per mm. Internal.
#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/core/image.hpp"
#include "calvin/core/result.hpp"

namespace calvin {

struct InverseModel {
  double fx = 1;  // px
  double fy = 1;
  double cx = 0;
  double cy = 0;
  double skew = 0;
  std::array<double, 8> a{};  // a1 to a8, of d in focal lengths

  // Of a ray (x, y, 1): absent where G is not positive.
  [[nodiscard]] std::optional<Eigen::Vector2d> ideal(Pixel seen) const noexcept;
};

enum class InverseTerms { kFour, kEight };

// The inverse nearest to a camera over its image, by linear least squares, again with the weights
// 1 / G: the distances are then those in the ideal image, as his single solution has them only
// where G is about 1. `residual` is the largest one, px. Absent for a lens that sees farther than
// 80 degrees from its axis within the image.
struct FittedInverse {
  InverseModel model;
  double residual = 0;
};
[[nodiscard]] std::optional<FittedInverse> inverse_of(const Camera& camera, InverseTerms terms);

// The brown5 nearest to an inverse over an image, for who has the coefficients of his toolbox.
// `residual` is the largest distance between where it shows a point and where that was seen, px:
// infinite where it shows one nowhere. kDegenerate where the inverse has no value within the image,
// and errors of Camera::make().
struct FittedCamera {
  Camera camera;
  double residual = 0;
};
[[nodiscard]] Result<FittedCamera> camera_of(const InverseModel& inverse, ImageSize size);

}  // namespace calvin
