// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A lens without distortion: x_d = X/Z, y_d = Y/Z.
#if defined(CALVIN_CAMERA_LENSES_PINHOLE_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_CAMERA_LENSES_PINHOLE_INL_HPP
#undef CALVIN_CAMERA_LENSES_PINHOLE_INL_HPP
#else
#define CALVIN_CAMERA_LENSES_PINHOLE_INL_HPP
#endif

#include <limits>

#include "calvin/camera/distortion.hpp"
#include "calvin/camera/double_vec-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace calvin::lens::HWY_NAMESPACE {

struct Pinhole {
  static constexpr std::string_view kName = "pinhole";
  static constexpr int kCount = 0;
  static constexpr bool kPerspective = true;
  static constexpr std::array<std::array<double, 0>, 1> kStarts = {};
  static constexpr std::array<std::string_view, 0> kNames = {};
  static constexpr std::array<CoefficientRange, 0> kTypical = {};
  static constexpr bool kCandidate = true;
  static constexpr OpenCvForm kOpenCv = OpenCvForm::kBrown;

  template <typename T>
  static HWY_INLINE MaskOf<T> distort(const double* /*d*/, const T* p, T* xy, T* jp, T* /*jd*/) {
    const T iz = 1 / p[2];
    xy[0] = p[0] * iz;
    xy[1] = p[1] * iz;
    if (jp != nullptr) {
      jp[0] = iz;
      jp[1] = T(0);
      jp[2] = -xy[0] * iz;
      jp[3] = T(0);
      jp[4] = iz;
      jp[5] = -xy[1] * iz;
    }
    return p[2] > 1e-9 * (abs(p[0]) + abs(p[1]));
  }

  static double limit(const double* /*d*/) { return std::numeric_limits<double>::infinity(); }

  static double radius(const Eigen::Vector3d& p) { return std::hypot(p[0], p[1]) / p[2]; }

  static bool turn(double* /*d*/, Orientation /*o*/) { return true; }

  static std::optional<Eigen::Vector3d> undistort(const double* /*d*/, double /*limit*/,
                                                  const double* xy) {
    return Eigen::Vector3d(xy[0], xy[1], 1).normalized();
  }

  static std::string glsl() {
    return R"(  float x = d.x / d.z;
  float y = d.y / d.z;
)";
  }
};

}  // namespace calvin::lens::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // CALVIN_CAMERA_LENSES_PINHOLE_INL_HPP
