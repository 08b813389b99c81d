// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A camera in OpenCV's numbers, which OpenCV's own files and ROS share: K and the coefficients in
// OpenCV's order.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "calvin/camera/lens_traits.hpp"
#include "calvin/core/calibration.hpp"

namespace calvin::io {

struct OpenCvCamera {
  std::array<double, 9> k{};       // fx skew cx 0 fy cy 0 0 1
  std::vector<double> distortion;  // k1 k2 p1 p2 [k3 [k4 k5 k6 [s1 s2 s3 s4 [taux tauy]]]]
  bool fisheye = false;            // then k1 k2 k3 k4
};

// Model and parameters. 0, 4, 5, 8, 12 or 14 coefficients (fisheye: 4) give the smallest model
// that holds all that are not zero, brown5 at least from 5 on. Whether this version knows the
// model is up to Camera::make().
[[nodiscard]] Result<Calibration> from_opencv(const OpenCvCamera& camera, ImageSize size);

// The inverse, with as many coefficients as the smallest model needs that holds all that are not
// zero. A pinhole gets brown4's coefficients, all zero. kUnsupported for a model that
// OpenCV does not have.
[[nodiscard]] Result<OpenCvCamera> to_opencv(const Calibration& calibration);

// The lens of a model that OpenCV has; nullptr for any other.
[[nodiscard]] const LensTraits* opencv_lens(std::string_view model);

// The names of the coefficients, in OpenCV's order.
[[nodiscard]] std::vector<std::string_view> coefficient_names(bool fisheye, std::size_t count);

}  // namespace calvin::io
