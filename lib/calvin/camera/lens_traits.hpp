// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What the rest of the library wants to know of a lens beside its formula. Each lens says it in its
// own file, camera/lenses/NAME-inl.hpp.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace calvin {

// How OpenCV holds a lens, and with it ROS and other programs that have OpenCV's words.
enum class OpenCvForm {
  kNone,     // not at all
  kBrown,    // by the first of the coefficients k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4 taux tauy
  kFisheye,  // cv::fisheye
};

struct CoefficientRange {
  double low;
  double high;
};

struct LensTraits {
  std::string_view model;                      // "brown5", ...
  std::vector<std::string_view> coefficients;  // their names
  // A pinhole when its coefficients are zero, that sees only what lies in front of the camera.
  bool perspective = true;
  bool candidate = false;  // whether the model `auto` tries it
  OpenCvForm opencv = OpenCvForm::kNone;
  std::vector<std::vector<double>> starts;  // coefficients from which a solve starts
  // Coefficients that bend nothing, each by itself: of a lens with all of them, a picture is that
  // of a pinhole, or of a fisheye lens that maps angles evenly. What is held at nothing is held
  // here.
  std::vector<double> neutral;
  // The power of the focal length (px) by which each coefficient has to grow, so that it goes on
  // moving the same pixels by as many: 2 of k1, whose share is k1 (R / f)^2 at R px from the
  // principal point. 0 where a coefficient is no such term of a series.
  std::vector<int> orders;
  // Between these lies each coefficient of common lenses.
  std::vector<CoefficientRange> typical;
  // Statements in GLSL that declare `float x` and `float y`, the distorted point of the direction
  // `vec3 d`; the coefficients are constants with their names.
  std::string glsl;
};

}  // namespace calvin
