// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Fisheye lens, a polynomial in the angle from the optical axis (OpenCV's cv::fisheye,
// "equidistant" of ROS and Kalibr, "kb4"):
//   theta = atan2(sqrt(X^2 + Y^2), Z)            in 0..pi: valid past 90 degrees
//   theta_d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8)
//   (x_d, y_d) = theta_d (X, Y) / sqrt(X^2 + Y^2)
// J. Kannala, S. Brandt, A Generic Camera Model and Calibration Method, PAMI 28(8), 2006, eq. 6.
#pragma once

#include <numbers>

#include "calvin/camera/distortion.hpp"
#include "calvin/geometry/polynomial.hpp"

namespace calvin::lens {

struct Fisheye {
  static constexpr std::string_view kName = "fisheye";
  static constexpr int kCount = 4;
  static constexpr std::array<std::string_view, 4> kNames = {"k1", "k2", "k3", "k4"};

  static bool distort(const double* d, const Eigen::Vector3d& p, double* xy, double* jp,
                      double* jd) {
    const double rho2 = p[0] * p[0] + p[1] * p[1];
    const double z = p[2];
    const double rho = std::sqrt(rho2);
    // s = theta_d / rho; near the axis by its series, exact to rounding there.
    double s;
    double ds_drho_over_rho;
    double ds_dz;
    double theta;
    if (rho2 < 1e-12 * z * z) {
      if (!(z > 0)) return false;  // straight backwards: no direction in the image
      const double c = d[0] - 1.0 / 3.0;
      theta = rho / z;
      s = (1 + c * theta * theta) / z;
      ds_drho_over_rho = 2 * c / (z * z * z);
      ds_dz = -1 / (z * z);
    } else {
      theta = std::atan2(rho, z);
      const auto [theta_d, slope] = polynomial(d, theta);
      const double n2 = rho2 + z * z;
      s = theta_d / rho;
      ds_drho_over_rho = (slope * z / n2 - s) / rho2;
      ds_dz = -slope / n2;
    }
    if (!std::isfinite(s)) return false;
    xy[0] = p[0] * s;
    xy[1] = p[1] * s;
    if (jp != nullptr) {
      jp[0] = s + p[0] * p[0] * ds_drho_over_rho;
      jp[1] = p[0] * p[1] * ds_drho_over_rho;
      jp[2] = p[0] * ds_dz;
      jp[3] = jp[1];
      jp[4] = s + p[1] * p[1] * ds_drho_over_rho;
      jp[5] = p[1] * ds_dz;
    }
    if (jd != nullptr) {
      double power = rho > 0 ? theta * theta * theta / rho : 0;
      for (int i = 0; i < kCount; ++i) {
        jd[i] = p[0] * power;
        jd[kCount + i] = p[1] * power;
        power *= theta * theta;
      }
    }
    return true;
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

}  // namespace calvin::lens
