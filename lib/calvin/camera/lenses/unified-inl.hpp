// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The unified projection: onto a sphere, then onto a plane seen from a point off its centre. What
// ucm, eucm and doublesphere share:
//   s = 1 / (alpha d + (1 - alpha) Z)            with d = sqrt(beta rho^2 + Z^2)
// B. Khomutenko, G. Garcia, P. Martinet, An Enhanced Unified Camera Model, RA-L 1(1), 2016, eq.
// 3-9; V. Usenko, N. Demmel, D. Cremers, The Double Sphere Camera Model, 3DV 2018, section 2.
#if defined(CALVIN_CAMERA_LENSES_UNIFIED_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_CAMERA_LENSES_UNIFIED_INL_HPP
#undef CALVIN_CAMERA_LENSES_UNIFIED_INL_HPP
#else
#define CALVIN_CAMERA_LENSES_UNIFIED_INL_HPP
#endif

#include <algorithm>
#include <optional>

#include "calvin/camera/lenses/radial-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace calvin::lens::HWY_NAMESPACE {

template <typename T>
struct Unified {
  Scale<T> scale;
  T by_alpha;
  T by_beta;
};

template <typename T>
HWY_INLINE Unified<T> unified(double alpha, double beta, T rho2, T z) {
  const T d = sqrt(beta * rho2 + z * z);
  const T below = alpha * d + (1 - alpha) * z;
  const T s = 1 / below;
  const T s2 = s * s;
  const T id = 1 / d;
  Unified<T> out;
  out.scale.s = s;
  out.scale.by_rho = -s2 * (alpha * beta * id);
  out.scale.by_z = -s2 * (alpha * z * id + (1 - alpha));
  out.scale.valid = below > 1e-9 * d;
  // d - z, without cancellation near the axis
  out.by_alpha = -s2 * select(z > 0, beta * rho2 / (d + z), d - z);
  out.by_beta = -s2 * (0.5 * alpha * rho2 * id);
  return out;
}

// The cosine of the largest angle phi = atan2(sqrt(beta) rho, Z): up to alpha = 1/2 the denominator
// is zero there and the picture has no end; above, the picture folds back.
inline double unified_limit(double alpha) {
  return std::max(-1.0, alpha <= 0.5 ? -alpha / (1 - alpha) : -(1 - alpha) / alpha);
}

// Z of the point (r, Z) that is seen at r, for beta = 1; absent past the rim.
inline std::optional<double> unified_depth(double alpha, double r) {
  const double square = 1 - (2 * alpha - 1) * r * r;
  if (!(square >= 0)) return std::nullopt;
  const double root = alpha * std::sqrt(square);
  // The same number twice; each has a 0 / 0 where the other has none.
  if (alpha < 0 || alpha > 1) return (root + alpha - 1) / (2 * alpha - 1);
  return (1 - alpha * alpha * r * r) / (root + 1 - alpha);
}

}  // namespace calvin::lens::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // CALVIN_CAMERA_LENSES_UNIFIED_INL_HPP
