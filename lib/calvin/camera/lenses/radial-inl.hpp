// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What the lenses share that look the same from every side and see past 90 degrees:
//   (x_d, y_d) = (X, Y) s(rho^2, Z)            with rho^2 = X^2 + Y^2
// Such a lens L : Radial<L> gives
//   scale<T>(d, rho2, z, by_d)  s and its derivatives, those by the coefficients into by_d where it
//                               is not nullptr
//   limit(d)                    rad
//   angle(d, limit, r)          the angle from the axis of what is seen at sqrt(x_d^2 + y_d^2) = r;
//                               absent past the rim
#if defined(CALVIN_CAMERA_LENSES_RADIAL_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_CAMERA_LENSES_RADIAL_INL_HPP
#undef CALVIN_CAMERA_LENSES_RADIAL_INL_HPP
#else
#define CALVIN_CAMERA_LENSES_RADIAL_INL_HPP
#endif

#include "calvin/camera/distortion.hpp"
#include "calvin/camera/double_vec-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace calvin::lens::HWY_NAMESPACE {

template <typename T>
struct Scale {
  T s;
  T by_rho;  // ds/drho over rho, that is twice the derivative by rho^2
  T by_z;
  MaskOf<T> valid;
};

template <typename Lens>
struct Radial {
  static constexpr bool kPerspective = false;

  template <typename T>
  static HWY_INLINE MaskOf<T> distort(const double* d, const T* p, T* xy, T* jp, T* jd) {
    T by_d[Lens::kCount];
    const Scale<T> scale =
        Lens::scale(d, p[0] * p[0] + p[1] * p[1], p[2], jd != nullptr ? by_d : nullptr);
    xy[0] = p[0] * scale.s;
    xy[1] = p[1] * scale.s;
    if (jp != nullptr) {
      jp[0] = scale.s + p[0] * p[0] * scale.by_rho;
      jp[1] = p[0] * p[1] * scale.by_rho;
      jp[2] = p[0] * scale.by_z;
      jp[3] = jp[1];
      jp[4] = scale.s + p[1] * p[1] * scale.by_rho;
      jp[5] = p[1] * scale.by_z;
    }
    if (jd != nullptr) {
      for (int i = 0; i < Lens::kCount; ++i) {
        jd[i] = p[0] * by_d[i];
        jd[Lens::kCount + i] = p[1] * by_d[i];
      }
    }
    return scale.valid;
  }

  static double radius(const Eigen::Vector3d& p) {
    return std::atan2(std::hypot(p[0], p[1]), p[2]);
  }

  static bool turn(double* /*d*/, Orientation /*o*/) { return true; }

  static std::optional<Eigen::Vector3d> undistort(const double* d, double limit, const double* xy) {
    const double r = std::hypot(xy[0], xy[1]);
    const std::optional<double> angle = Lens::angle(d, limit, r);
    if (!angle) return std::nullopt;
    const double s = r > 0 ? std::sin(*angle) / r : 1;
    return Eigen::Vector3d(xy[0] * s, xy[1] * s, std::cos(*angle));
  }
};

}  // namespace calvin::lens::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // CALVIN_CAMERA_LENSES_RADIAL_INL_HPP
