// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Projections and rays through any lens, several at once, with the verdicts of Camera::project()
// and Camera::unproject(). Included once per kind of vector. Internal.
#include "calvin/solve/residuals/lens_points.hpp"

#if defined(CALVIN_SOLVE_LENS_POINTS_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_SOLVE_LENS_POINTS_INL_HPP
#undef CALVIN_SOLVE_LENS_POINTS_INL_HPP
#else
#define CALVIN_SOLVE_LENS_POINTS_INL_HPP
#endif

#include <cmath>
#include <limits>
#include <numbers>

#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include "calvin/camera/double_vec-inl.hpp"
#include "calvin/camera/models.hpp"

HWY_BEFORE_NAMESPACE();
namespace calvin::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using lens::HWY_NAMESPACE::DoubleVec;
using lens::HWY_NAMESPACE::Mask;

template <typename Lens>
class LensPoints {
 public:
  explicit LensPoints(const KnownLens& lens)
      : lens_(lens),
        coefficients_(lens.parameters + kCamera.distortion().first),
        fx_(lens.parameters[kCamera.focal()[0]]),
        fy_(lens.parameters[kCamera.focal()[1]]),
        cx_(lens.parameters[kCamera.center()[0]]),
        cy_(lens.parameters[kCamera.center()[1]]) {
    const double angle = std::min(lens.limit, std::numbers::pi);
    rim_ = Lens::kPerspective ? lens.limit * lens.limit
                              : (angle < std::numbers::pi ? std::cos(angle) : -2);
  }

  void squares(const ViewPoints& view, const SE3& camera_from_board, double* out) const {
    const Eigen::Matrix3d& r = camera_from_board.rotation;
    const Eigen::Vector3d& t = camera_from_board.translation;
    for (std::size_t at = 0; at < view.padded(); at += DoubleVec::kSize) {
      DoubleVec b[3];
      for (std::size_t k = 0; k < 3; ++k) b[k] = DoubleVec::load(view.board(k) + at);
      DoubleVec p[3];
      for (int i = 0; i < 3; ++i) p[i] = b[0] * r(i, 0) + b[1] * r(i, 1) + b[2] * r(i, 2) + t[i];
      DoubleVec xy[2];
      DoubleVec jp[6];
      const Mask valid = Lens::distort(coefficients_, p, xy, jp, static_cast<DoubleVec*>(nullptr));
      const DoubleVec weight = DoubleVec::load(view.weight() + at);
      const DoubleVec du = xy[0] * fx_ + xy[1] * lens_.skew + cx_ - DoubleVec::load(view.u() + at);
      const DoubleVec dv = xy[1] * fy_ + cy_ - DoubleVec::load(view.v() + at);
      const DoubleVec square = weight * weight * (du * du + dv * dv);
      // What is no number is not below infinity.
      const DoubleVec none = std::numeric_limits<double>::infinity();
      select(valid & sees(p, jp) & (square < none), square, none).store(out + at);
    }
  }

  // Newton's method from the ray of a lens that bends nothing.
  void rays(double* u, double* v, double* x, double* y, double* z, std::size_t padded) const {
    for (std::size_t at = 0; at < padded; at += DoubleVec::kSize) {
      const DoubleVec gy = (DoubleVec::load(v + at) - cy_) / fy_;
      const DoubleVec gx = (DoubleVec::load(u + at) - cx_ - gy * lens_.skew) / fx_;
      DoubleVec p[3];
      start(gx, gy, p);
      const Mask found = settle(gx, gy, p);
      const DoubleVec length = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
      double* out[3] = {x, y, z};
      for (int k = 0; k < 3; ++k) select(found, p[k] / length, DoubleVec(0)).store(out[k] + at);
    }
  }

 private:
  static constexpr CameraUnknowns kCamera = {Lens::kCount, true};

  // Within the limit of the lens, where the image keeps its handedness.
  Mask sees(const DoubleVec* p, const DoubleVec* jp) const {
    const DoubleVec across = p[0] * p[0] + p[1] * p[1];
    const DoubleVec facing = (jp[1] * jp[5] - jp[2] * jp[4]) * p[0] +
                             (jp[2] * jp[3] - jp[0] * jp[5]) * p[1] +
                             (jp[0] * jp[4] - jp[1] * jp[3]) * p[2];
    if constexpr (Lens::kPerspective) {
      return (facing >= DoubleVec(0)) & (across <= p[2] * p[2] * rim_);
    }
    return (facing >= DoubleVec(0)) & (p[2] >= sqrt(across + p[2] * p[2]) * rim_);
  }

  static void start(DoubleVec gx, DoubleVec gy, DoubleVec* p) {
    p[0] = gx;
    p[1] = gy;
    p[2] = 1;
    if constexpr (!Lens::kPerspective) {
      constexpr double kSmall = 1e-9;
      const DoubleVec radius = sqrt(gx * gx + gy * gy);
      const DoubleVec angle = min(radius, DoubleVec(3));
      const DoubleVec scale = select(
          radius > DoubleVec(kSmall),
          DoubleVec(hn::Sin(DoubleVec::Tag(), angle.raw)) / max(radius, DoubleVec(kSmall)), 1);
      p[0] *= scale;
      p[1] *= scale;
      p[2] = DoubleVec(hn::Cos(DoubleVec::Tag(), angle.raw));
    }
  }

  // Each step is at right angles to the ray, as the derivatives by the point are. Where it came to
  // the pixel by rays that the lens sees.
  Mask settle(DoubleVec gx, DoubleVec gy, DoubleVec* p) const {
    constexpr int kRounds = 8;
    constexpr double kNear = 1e-7;  // focal lengths; the step from there leaves the square of that
    Mask settled = gx < gx;
    for (int round = 0; round < kRounds; ++round) {
      DoubleVec xy[2];
      DoubleVec jp[6];
      const Mask valid = Lens::distort(coefficients_, p, xy, jp, static_cast<DoubleVec*>(nullptr));
      const DoubleVec ex = xy[0] - gx;
      const DoubleVec ey = xy[1] - gy;
      const DoubleVec xx = jp[0] * jp[0] + jp[1] * jp[1] + jp[2] * jp[2];
      const DoubleVec xd = jp[0] * jp[3] + jp[1] * jp[4] + jp[2] * jp[5];
      const DoubleVec yy = jp[3] * jp[3] + jp[4] * jp[4] + jp[5] * jp[5];
      const DoubleVec inverse = DoubleVec(1) / (xx * yy - xd * xd);
      const DoubleVec along_x = inverse * (yy * ex - xd * ey);
      const DoubleVec along_y = inverse * (xx * ey - xd * ex);
      settled = valid & sees(p, jp) & (ex * ex + ey * ey < DoubleVec(kNear * kNear));
      for (int k = 0; k < 3; ++k) p[k] -= along_x * jp[k] + along_y * jp[3 + k];
      if (all_true(settled)) break;
    }
    return settled;
  }

  KnownLens lens_;
  const double* coefficients_;
  double fx_;
  double fy_;
  double cx_;
  double cy_;
  double rim_;  // the square of the largest radius, or the cosine of the largest angle
};

}  // namespace calvin::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
