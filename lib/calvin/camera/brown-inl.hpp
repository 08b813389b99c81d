// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Brown's radial and tangential distortion, in OpenCV's direction (ideal -> distorted):
//   g = 1 + k1 r^2 + k2 r^4 + k3 r^6
//   x_d = x g + 2 p1 x y + p2 (r^2 + 2 x^2)
//   y_d = y g + p1 (r^2 + 2 y^2) + 2 p2 x y        with x = X/Z, y = Y/Z, r^2 = x^2 + y^2
// D. C. Brown, Close-Range Camera Calibration, Photogrammetric Engineering 37(8), 1971.
#if defined(CALVIN_CAMERA_BROWN_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_CAMERA_BROWN_INL_HPP
#undef CALVIN_CAMERA_BROWN_INL_HPP
#else
#define CALVIN_CAMERA_BROWN_INL_HPP
#endif

#include <utility>

#include "calvin/camera/distortion.hpp"
#include "calvin/camera/lane-inl.hpp"
#include "calvin/geometry/polynomial.hpp"

HWY_BEFORE_NAMESPACE();
namespace calvin::lens::HWY_NAMESPACE {

// kCount 4: k1 k2 p1 p2; 5: k1 k2 p1 p2 k3 (OpenCV's order).
template <int kCoefficients>
struct Brown {
  static_assert(kCoefficients == 4 || kCoefficients == 5);
  static constexpr int kCount = kCoefficients;
  static constexpr bool kPerspective = true;

  template <typename T>
  static HWY_INLINE MaskOf<T> distort(const double* d, const T* p, T* xy, T* jp, T* jd) {
    const T iz = 1 / p[2];
    const T x = p[0] * iz;
    const T y = p[1] * iz;
    const T r2 = x * x + y * y;
    const double p1 = d[2];
    const double p2 = d[3];
    const double k3 = third(d);
    const T g = 1 + r2 * (d[0] + r2 * (d[1] + r2 * k3));
    xy[0] = x * g + 2 * p1 * x * y + p2 * (r2 + 2 * x * x);
    xy[1] = y * g + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y;
    if (jp != nullptr) {
      const T dg = 2 * (d[0] + r2 * (2 * d[1] + 3 * k3 * r2));  // dg/dx = x dg
      const T xx = g + x * x * dg + 2 * p1 * y + 6 * p2 * x;
      const T cross = x * y * dg + 2 * p1 * x + 2 * p2 * y;  // dx_d/dy = dy_d/dx
      const T yy = g + y * y * dg + 6 * p1 * y + 2 * p2 * x;
      jp[0] = xx * iz;
      jp[1] = cross * iz;
      jp[2] = -(xx * x + cross * y) * iz;
      jp[3] = cross * iz;
      jp[4] = yy * iz;
      jp[5] = -(cross * x + yy * y) * iz;
    }
    if (jd != nullptr) {
      fill_row<T>(jd, x * r2, x * r2 * r2, 2 * x * y, r2 + 2 * x * x, x * r2 * r2 * r2);
      fill_row<T>(jd + kCount, y * r2, y * r2 * r2, r2 + 2 * y * y, 2 * x * y, y * r2 * r2 * r2);
    }
    return p[2] > 1e-9 * (abs(p[0]) + abs(p[1]));
  }

  // The radial part alone decides; the tangential one is checked where a point is projected.
  static double limit(const double* d) {
    const std::array<double, 4> slope = {1, 3 * d[0], 5 * d[1], 7 * third(d)};  // in r^2
    return std::sqrt(smallest_positive_root(slope));
  }

  static double radius(const Eigen::Vector3d& p) { return std::hypot(p[0], p[1]) / p[2]; }

  // (p2, p1) turns as (x, y) does.
  static void turn(double* d, Orientation o) {
    if (o.transpose) std::swap(d[2], d[3]);
    if (o.flip_x) d[3] = -d[3];
    if (o.flip_y) d[2] = -d[2];
  }

  static std::optional<Eigen::Vector3d> undistort(const double* d, double limit, const double* xy) {
    const double target = std::hypot(xy[0], xy[1]);
    const auto radial = [d](double r) {
      const double s = r * r;
      const double k3 = third(d);
      return std::pair(r * (1 + s * (d[0] + s * (d[1] + s * k3))),
                       1 + s * (3 * d[0] + s * (5 * d[1] + s * 7 * k3)));
    };
    // Tangential terms move the rim a little: start from the limit and let Newton decide.
    const double r = invert_growing(radial, target, limit).value_or(limit);
    if (!std::isfinite(r)) return std::nullopt;
    const double scale = target > 0 ? r / target : 1;
    Eigen::Vector3d p(xy[0] * scale, xy[1] * scale, 1);
    for (int i = 0; i < 50; ++i) {
      double at[2];
      double j[6];
      if (!distort<double>(d, p.data(), at, j, nullptr)) return std::nullopt;
      const double ex = at[0] - xy[0];
      const double ey = at[1] - xy[1];
      const double determinant = j[0] * j[4] - j[1] * j[3];
      if (!(determinant > 0)) return std::nullopt;
      const double dx = (j[4] * ex - j[1] * ey) / determinant;
      const double dy = (j[0] * ey - j[3] * ex) / determinant;
      p[0] -= dx;
      p[1] -= dy;
      if (std::abs(dx) + std::abs(dy) <= 1e-15 * (1 + std::abs(p[0]) + std::abs(p[1]))) break;
    }
    double at[2];
    if (!distort<double>(d, p.data(), at, nullptr, nullptr) || !(radius(p) <= limit) ||
        !(std::hypot(at[0] - xy[0], at[1] - xy[1]) <= 1e-11 * (1 + target))) {
      return std::nullopt;
    }
    return p.normalized();
  }

 private:
  static double third(const double* d) {
    if constexpr (kCount == 5) return d[4];
    return 0;
  }
  template <typename T>
  static HWY_INLINE void fill_row(T* row, T k1, T k2, T p1, T p2, T k3) {
    row[0] = k1;
    row[1] = k2;
    row[2] = p1;
    row[3] = p2;
    if constexpr (kCount == 5) row[4] = k3;
  }
};

}  // namespace calvin::lens::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // CALVIN_CAMERA_BROWN_INL_HPP
