// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A sensor that stands tilted behind its lens, as OpenCV's computeTiltProjectionMatrix() has it.
// The normalised plane is turned by taux about x, then by tauy about y, and seen again along the
// old axis. The product of its three matrices, with c and s the cosines and sines, is
//
//   | c_x        0         0       |
//   | -s_x s_y   c_y       0       |
//   | s_y        -c_y s_x  c_y c_x |
#if defined(CALVIN_CAMERA_LENSES_TILT_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_CAMERA_LENSES_TILT_INL_HPP
#undef CALVIN_CAMERA_LENSES_TILT_INL_HPP
#else
#define CALVIN_CAMERA_LENSES_TILT_INL_HPP
#endif

#include <cmath>
#include <optional>

#include "calvin/camera/double_vec-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace calvin::lens::HWY_NAMESPACE {

class Tilt {
 public:
  // rad
  Tilt(double taux, double tauy)
      : cx_(std::cos(taux)), sx_(std::sin(taux)), cy_(std::cos(tauy)), sy_(std::sin(tauy)) {}

  // Whether the axis of the lens still meets the front of the sensor.
  [[nodiscard]] bool possible() const { return cx_ > 0 && cy_ > 0; }

  // xy -> xy on the tilted plane, in place. j: 2x2 derivatives by the old xy, jt: 2x2 by (taux,
  // tauy), row-major. False beyond the horizon of the plane.
  template <typename T>
  HWY_INLINE MaskOf<T> apply(T* xy, T* j, T* jt) const {
    const T x = xy[0];
    const T y = xy[1];
    const T w = sy_ * x - cy_ * sx_ * y + cy_ * cx_;
    const T iw = 1 / w;
    xy[0] = cx_ * x * iw;
    xy[1] = (cy_ * y - sx_ * sy_ * x) * iw;
    j[0] = (cx_ - sy_ * xy[0]) * iw;
    j[1] = cy_ * sx_ * xy[0] * iw;
    j[2] = -sy_ * (sx_ + xy[1]) * iw;
    j[3] = cy_ * (1 + sx_ * xy[1]) * iw;
    const T w_x = -cy_ * (cx_ * y + sx_);
    const T w_y = cy_ * x + sy_ * (sx_ * y - cx_);
    jt[0] = -(sx_ * x + xy[0] * w_x) * iw;
    jt[1] = -xy[0] * w_y * iw;
    jt[2] = -(cx_ * sy_ * x + xy[1] * w_x) * iw;
    jt[3] = -(sx_ * cy_ * x + sy_ * y + xy[1] * w_y) * iw;
    return w > 1e-9 * (abs(x) + abs(y));
  }

  // The inverse of apply(); false where the horizon or more lies between.
  bool undo(double* xy) const {
    const double w = cx_ * cy_ / (1 - cx_ * sy_ * xy[0] + sx_ * xy[1]);
    if (!(w > 0)) return false;
    xy[0] = w * xy[0] / cx_;
    xy[1] = (w * xy[1] + sx_ * sy_ * xy[0]) / cy_;
    return true;
  }

 private:
  double cx_, sx_, cy_, sy_;
};

}  // namespace calvin::lens::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // CALVIN_CAMERA_LENSES_TILT_INL_HPP
