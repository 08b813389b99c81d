// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The enhanced unified camera model, alpha and beta: unified-inl.hpp as it stands. beta > 0; with
// beta = 1 it is ucm, with alpha = 0 a pinhole.
#if defined(CALVIN_CAMERA_LENSES_EUCM_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_CAMERA_LENSES_EUCM_INL_HPP
#undef CALVIN_CAMERA_LENSES_EUCM_INL_HPP
#else
#define CALVIN_CAMERA_LENSES_EUCM_INL_HPP
#endif

#include <cmath>

#include "calvin/camera/lenses/unified-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace calvin::lens::HWY_NAMESPACE {

struct Eucm : Radial<Eucm> {
  static constexpr std::string_view kName = "eucm";
  static constexpr int kCount = 2;
  static constexpr std::array<std::array<double, kCount>, 2> kStarts = {{{0.3, 1}, {0.6, 1}}};
  static constexpr std::array<double, kCount> kNeutral = {0, 1};
  static constexpr std::array<std::string_view, kCount> kNames = {"alpha", "beta"};
  static constexpr std::array<CoefficientRange, kCount> kTypical = {{{0.5, 0.7}, {0.9, 1.2}}};
  static constexpr bool kCandidate = true;
  static constexpr OpenCvForm kOpenCv = OpenCvForm::kNone;

  template <typename T>
  static HWY_INLINE Scale<T> scale(const double* d, T rho2, T z, T* by_d) {
    const Unified<T> u = unified(d[0], d[1], rho2, z);
    if (by_d != nullptr) {
      by_d[0] = u.by_alpha;
      by_d[1] = u.by_beta;
    }
    return u.scale;
  }

  static double limit(const double* d) {
    if (!(d[1] > 0)) return 0;
    const double c = unified_limit(d[0]);
    return std::atan2(std::sqrt((1 - c * c) / d[1]), c);
  }

  static std::optional<double> angle(const double* d, double limit, double r) {
    const auto z = unified_depth(d[0], std::sqrt(d[1]) * r);
    if (!z) return std::nullopt;
    return std::min(std::atan2(r, *z), limit);
  }

  static std::string glsl() {
    return R"(  float across2 = d.x * d.x + d.y * d.y;
  float w = alpha * sqrt(beta * across2 + d.z * d.z) + (1.0 - alpha) * d.z;
  float x = d.x / w;
  float y = d.y / w;
)";
  }
};

}  // namespace calvin::lens::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // CALVIN_CAMERA_LENSES_EUCM_INL_HPP
