// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Fisheye lens, a polynomial in the angle from the optical axis (OpenCV's cv::fisheye,
// "equidistant" of ROS and Kalibr, "kb4"):
//   theta = atan2(sqrt(X^2 + Y^2), Z)            in 0..pi: valid past 90 degrees
//   theta_d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8)
//   (x_d, y_d) = theta_d (X, Y) / sqrt(X^2 + Y^2)
// J. Kannala, S. Brandt, A Generic Camera Model and Calibration Method, PAMI 28(8), 2006, eq. 6.
#if defined(CALVIN_CAMERA_LENSES_FISHEYE_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_CAMERA_LENSES_FISHEYE_INL_HPP
#undef CALVIN_CAMERA_LENSES_FISHEYE_INL_HPP
#else
#define CALVIN_CAMERA_LENSES_FISHEYE_INL_HPP
#endif

#include <numbers>
#include <utility>

#include "calvin/camera/lenses/radial-inl.hpp"
#include "calvin/geometry/polynomial.hpp"

HWY_BEFORE_NAMESPACE();
namespace calvin::lens::HWY_NAMESPACE {

struct Fisheye : Radial<Fisheye> {
  static constexpr std::string_view kName = "fisheye";
  static constexpr int kCount = 4;
  static constexpr std::array<std::array<double, kCount>, 1> kStarts = {};
  static constexpr std::array<std::string_view, kCount> kNames = {"k1", "k2", "k3", "k4"};
  static constexpr std::array<int, kCount> kOrders = {2, 4, 6, 8};
  static constexpr std::array<CoefficientRange, kCount> kTypical = {
      {{-0.03, 0.03}, {-0.01, 0.01}, {-0.005, 0.005}, {-0.002, 0.002}}};
  static constexpr bool kCandidate = true;
  static constexpr OpenCvForm kOpenCv = OpenCvForm::kFisheye;

  template <typename T>
  static HWY_INLINE Scale<T> scale(const double* d, T rho2, T z, T* by_d) {
    // Near the axis theta_d / rho by its series, exact to rounding there.
    const MaskOf<T> near = rho2 < 1e-12 * (z * z);
    const T rho = sqrt(rho2);
    const T iz = 1 / z;
    const T theta = select(near, rho * iz, atan2(rho, z));
    const T ratio = select(near, iz, theta / rho);
    const T q = theta * theta;
    const T growth = 1 + q * (d[0] + q * (d[1] + q * (d[2] + q * d[3])));  // theta_d / theta
    const T slope = 1 + q * (3 * d[0] + q * (5 * d[1] + q * (7 * d[2] + q * (9 * d[3]))));
    const T in2 = 1 / (rho2 + z * z);
    const double c = d[0] - 1.0 / 3.0;
    Scale<T> out;
    out.s = select(near, (1 + c * q) * iz, growth * ratio);
    out.by_rho = select(near, 2 * c * iz * iz * iz, (slope * z * in2 - out.s) / rho2);
    out.by_z = -slope * in2;
    out.valid = (z > 0) | !near;  // straight backwards: no direction in the image
    if (by_d != nullptr) {
      T power = q * ratio;
      for (int i = 0; i < kCount; ++i) {
        by_d[i] = power;
        power = power * q;
      }
    }
    return out;
  }

  static double limit(const double* d) {
    const std::array<double, 5> slope = {1, 3 * d[0], 5 * d[1], 7 * d[2], 9 * d[3]};  // in theta^2
    return std::min(std::sqrt(smallest_positive_root(slope)), std::numbers::pi);
  }

  static std::optional<double> angle(const double* d, double limit, double r) {
    // {theta_d, d theta_d / d theta}
    const auto polynomial = [d](double t) {
      const double q = t * t;
      return std::pair(t * (1 + q * (d[0] + q * (d[1] + q * (d[2] + q * d[3])))),
                       1 + q * (3 * d[0] + q * (5 * d[1] + q * (7 * d[2] + q * 9 * d[3]))));
    };
    return invert_growing(polynomial, r, limit);
  }

  static std::string glsl() {
    return R"(  float across = length(vec2(d.x, d.y));
  float t = atan(across, d.z);
  float t2 = t * t;
  float r = t * (1.0 + t2 * (k1 + t2 * (k2 + t2 * (k3 + t2 * k4))));
  float x = across > 0.0 ? d.x / across * r : 0.0;
  float y = across > 0.0 ? d.y / across * r : 0.0;
)";
  }
};

}  // namespace calvin::lens::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // CALVIN_CAMERA_LENSES_FISHEYE_INL_HPP
