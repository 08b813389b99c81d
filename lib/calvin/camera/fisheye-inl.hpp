// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Fisheye lens, a polynomial in the angle from the optical axis (OpenCV's cv::fisheye,
// "equidistant" of ROS and Kalibr, "kb4"):
//   theta = atan2(sqrt(X^2 + Y^2), Z)            in 0..pi: valid past 90 degrees
//   theta_d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8)
//   (x_d, y_d) = theta_d (X, Y) / sqrt(X^2 + Y^2)
// J. Kannala, S. Brandt, A Generic Camera Model and Calibration Method, PAMI 28(8), 2006, eq. 6.
#if defined(CALVIN_CAMERA_FISHEYE_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_CAMERA_FISHEYE_INL_HPP
#undef CALVIN_CAMERA_FISHEYE_INL_HPP
#else
#define CALVIN_CAMERA_FISHEYE_INL_HPP
#endif

#include <numbers>

#include "calvin/camera/distortion.hpp"
#include "calvin/camera/lane-inl.hpp"
#include "calvin/geometry/polynomial.hpp"

HWY_BEFORE_NAMESPACE();
namespace calvin::lens::HWY_NAMESPACE {

struct Fisheye {
  static constexpr std::string_view kName = "fisheye";
  static constexpr int kCount = 4;
  static constexpr bool kPerspective = false;
  static constexpr std::array<std::string_view, 4> kNames = {"k1", "k2", "k3", "k4"};

  template <typename T>
  static HWY_INLINE MaskOf<T> distort(const double* d, const T* p, T* xy, T* jp, T* jd) {
    const T z = p[2];
    const T rho2 = p[0] * p[0] + p[1] * p[1];
    const T n2 = rho2 + z * z;
    // Near the axis s = theta_d / rho by its series, exact to rounding there.
    const MaskOf<T> near = rho2 < 1e-12 * (z * z);
    const T safe2 = select(near, 1, rho2);
    const T rho = sqrt(rho2);
    const T iz = 1 / z;
    const T theta = select(near, rho * iz, atan2(rho, z));
    const T q = theta * theta;
    const T slope = 1 + q * (3 * d[0] + q * (5 * d[1] + q * (7 * d[2] + q * (9 * d[3]))));
    const T growth = 1 + q * (d[0] + q * (d[1] + q * (d[2] + q * d[3])));  // theta_d / theta
    const T ratio = theta / select(near, 1, rho);
    const double c = d[0] - 1.0 / 3.0;
    const T s = select(near, (1 + c * q) * iz, growth * ratio);
    xy[0] = p[0] * s;
    xy[1] = p[1] * s;
    if (jp != nullptr) {
      const T by_rho2 = select(near, 2 * c * iz * iz * iz, (slope * z / n2 - s) / safe2);
      const T by_z = -slope / n2;
      jp[0] = s + p[0] * p[0] * by_rho2;
      jp[1] = p[0] * p[1] * by_rho2;
      jp[2] = p[0] * by_z;
      jp[3] = jp[1];
      jp[4] = s + p[1] * p[1] * by_rho2;
      jp[5] = p[1] * by_z;
    }
    if (jd != nullptr) {
      T power = q * select(near, iz, ratio);
      for (int i = 0; i < kCount; ++i) {
        jd[i] = p[0] * power;
        jd[kCount + i] = p[1] * power;
        power = power * q;
      }
    }
    return (z > 0) | !near;  // straight backwards: no direction in the image
  }

  static double limit(const double* d) {
    const std::array<double, 5> slope = {1, 3 * d[0], 5 * d[1], 7 * d[2], 9 * d[3]};  // in theta^2
    return std::min(std::sqrt(smallest_positive_root(slope)), std::numbers::pi);
  }

  static double radius(const Eigen::Vector3d& p) {
    return std::atan2(std::hypot(p[0], p[1]), p[2]);
  }

  // The same from every side.
  static void turn(double* /*d*/, Orientation /*o*/) {}

  static std::optional<Eigen::Vector3d> undistort(const double* d, double limit, const double* xy) {
    const double target = std::hypot(xy[0], xy[1]);
    const auto theta = invert_growing([d](double t) { return polynomial(d, t); }, target, limit);
    if (!theta) return std::nullopt;
    const double s = target > 0 ? std::sin(*theta) / target : 1;
    return Eigen::Vector3d(xy[0] * s, xy[1] * s, std::cos(*theta));
  }

 private:
  // {theta_d, d theta_d / d theta}
  static std::pair<double, double> polynomial(const double* d, double t) {
    const double q = t * t;
    return {t * (1 + q * (d[0] + q * (d[1] + q * (d[2] + q * d[3])))),
            1 + q * (3 * d[0] + q * (5 * d[1] + q * (7 * d[2] + q * 9 * d[3])))};
  }
};

}  // namespace calvin::lens::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // CALVIN_CAMERA_FISHEYE_INL_HPP
