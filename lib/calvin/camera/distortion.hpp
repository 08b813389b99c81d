// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What every lens model gives, and the helpers that several of them share.
//
// A lens model is a struct with static members only:
//   kName, kCount, kNames       its name, the number of its coefficients and their names
//   kPerspective                whether it is a pinhole when its coefficients are zero, and sees
//                               only what lies in front of the camera
//   kStarts                     coefficients to start a solve from, one of which leads to the
//                               optimum of any lens that the model fits
//   kNeutral                    coefficients that bend nothing (LensTraits::neutral); zeros where
//                               a lens does not say
//   kTypical                    between which numbers each coefficient of common lenses lies; tests
//                               draw theirs from there
//   kCandidate                  whether the model `auto` tries it
//   kOpenCv                     how OpenCV's files hold it (OpenCvForm)
//   distort<T>(d, p, xy, jp, jd)
//                               point in the camera frame -> distorted normalised plane, over T =
//                               double or DoubleVec (double_vec-inl.hpp). d: kCount numbers; p: x y
//                               z; jp: 2x3 derivatives by the point, jd: 2xkCount derivatives by
//                               the coefficients, both row-major, nullptr where not wanted. Gives
//                               where the formula has a value (not behind a pinhole); elsewhere
//                               xy, jp and jd mean nothing.
//   limit(d)                    the largest ideal radius at which the model is valid: beyond it
//                               the image folds back. tan(angle) for perspective models, the
//                               angle in rad for fisheye ones; may be infinite. 0 where the
//                               coefficients make no lens.
//   radius(p)                   the ideal radius of a point in the same measure
//   turn(d, orientation)        makes d the coefficients of the same lens for a picture that is
//                               turned; false where this model has none
//   undistort(d, limit, xy)     the inverse of distort(): a unit ray, absent outside the valid
//                               image
//   glsl()                      the formula of distort() as text (LensTraits::glsl)
// Its file, in camera/lenses, is compiled once per target of Highway. The list of lenses is in
// camera/meson.build.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "calvin/camera/lens_traits.hpp"
#include "calvin/core/image.hpp"

namespace calvin::lens {

// The x in [0, limit] with f(x) = target, for an f that grows there from f(0) = 0: Newton kept
// inside a bracket, to a last step of at most `tolerance` * (1 + x). `f` returns {value, slope}.
// Absent where the target is out of reach. Steps that do not become half as long are bisections
// instead, as Newton jumps between the ends of a bracket or creeps away from a pole; and beside a
// pole its steps are short far from the answer, so that the value has to have arrived as well
// (Press et al., Numerical Recipes, rtsafe).
template <typename F>
std::optional<double> invert_growing(F f, double target, double limit, double tolerance = 1e-16) {
  double low = 0;
  double high = std::isfinite(limit) ? limit : std::max(1.0, 2 * target);
  for (int i = 0; f(high).first < target; ++i) {
    // A last step over the limit by rounding is still the limit.
    if (std::isfinite(limit)) {
      if (f(high).first < target * (1 - 1e-12)) return std::nullopt;
      return limit;
    }
    if (i == 64) return std::nullopt;
    high *= 2;
  }
  const double close = std::max(1e-9, 10 * tolerance) * (1 + target);
  double x = std::min(target, high);
  double last = high - low;
  for (int i = 0; i < 200; ++i) {
    const auto [value, slope] = f(x);
    (value < target ? low : high) = x;
    const double off = value - target;
    const bool has_arrived = std::abs(off) <= close;
    double next = x - off / slope;
    const bool is_slow = !has_arrived && std::abs(next - x) > last / 2;
    if (!(next > low && next < high) || is_slow) next = (low + high) / 2;
    last = std::abs(next - x);
    if (last <= tolerance * (1 + x) && (has_arrived || high - low <= tolerance)) return next;
    x = next;
  }
  return x;
}

}  // namespace calvin::lens
