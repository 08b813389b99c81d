// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The double sphere model, xi and alpha (Basalt's order and meaning): the point goes onto a first
// sphere, which a second one is xi away from, and from there as in ucm:
//   d1 = sqrt(rho^2 + Z^2)      s = 1 / (alpha sqrt(rho^2 + (xi d1 + Z)^2) + (1 - alpha) (xi d1 +
//   Z))
// V. Usenko, N. Demmel, D. Cremers, The Double Sphere Camera Model, 3DV 2018, eq. 40-52.
#if defined(CALVIN_CAMERA_LENSES_DOUBLESPHERE_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_CAMERA_LENSES_DOUBLESPHERE_INL_HPP
#undef CALVIN_CAMERA_LENSES_DOUBLESPHERE_INL_HPP
#else
#define CALVIN_CAMERA_LENSES_DOUBLESPHERE_INL_HPP
#endif

#include <cmath>

#include "calvin/camera/lenses/unified-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace calvin::lens::HWY_NAMESPACE {

struct DoubleSphere : Radial<DoubleSphere> {
  static constexpr std::string_view kName = "doublesphere";
  static constexpr int kCount = 2;
  // On either side of xi = 0, where xi does what f and alpha do, is a basin of its own.
  static constexpr std::array<std::array<double, kCount>, 3> kStarts = {
      {{0, 0.5}, {-0.2, 0.6}, {0.2, 0.6}}};
  static constexpr std::array<std::string_view, kCount> kNames = {"xi", "alpha"};
  static constexpr std::array<CoefficientRange, kCount> kTypical = {{{-0.25, 0.1}, {0.5, 0.7}}};
  static constexpr bool kCandidate = true;
  static constexpr OpenCvForm kOpenCv = OpenCvForm::kNone;

  template <typename T>
  static HWY_INLINE Scale<T> scale(const double* d, T rho2, T z, T* by_d) {
    const T d1 = sqrt(rho2 + z * z);
    const T shift = d[0] / d1;
    const Unified<T> u = unified(d[1], 1, rho2, d[0] * d1 + z);
    if (by_d != nullptr) {
      by_d[0] = u.scale.by_z * d1;
      by_d[1] = u.by_alpha;
    }
    Scale<T> out = u.scale;
    out.by_rho = out.by_rho + out.by_z * shift;
    out.by_z = out.by_z * (1 + shift * z);
    return out;
  }

  // What the second sphere sees at unified_limit(), brought back to the first. Exact where eq. 43
  // of the paper is an approximation. With xi > 1 the spheres part: the picture folds back at the
  // tangent from one's centre to the other; with xi <= -1 the axis itself is not seen.
  static double limit(const double* d) {
    const double xi = d[0];
    if (!(xi > -1)) return 0;
    const double c = unified_limit(d[1]);
    const double square = 1 - xi * xi * (1 - c * c);
    if (xi > 1 && (square <= 0 || c < 0)) return std::acos(-1 / xi);
    return std::acos(std::clamp(c * (xi * c + std::sqrt(std::max(square, 0.0))) - xi, -1.0, 1.0));
  }

  static std::optional<double> angle(const double* d, double limit, double r) {
    const auto z = unified_depth(d[1], r);
    if (!z) return std::nullopt;
    const double square = *z * *z + (1 - d[0] * d[0]) * r * r;
    if (!(square >= 0)) return std::nullopt;
    const double k = (*z * d[0] + std::sqrt(square)) / (*z * *z + r * r);
    return std::min(std::atan2(k * r, k * *z - d[0]), limit);
  }

  static std::string glsl() {
    return R"(  float z = xi * length(d) + d.z;
  float w = alpha * sqrt(d.x * d.x + d.y * d.y + z * z) + (1.0 - alpha) * z;
  float x = d.x / w;
  float y = d.y / w;
)";
  }
};

}  // namespace calvin::lens::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // CALVIN_CAMERA_LENSES_DOUBLESPHERE_INL_HPP
