// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The unified camera model, alpha: unified-inl.hpp with beta = 1. Mei's xi = alpha / (1 - alpha),
// and his focal length is f / (1 - alpha); alpha = 0 is a pinhole, 1/2 a stereographic lens. C.
// Mei, P. Rives, Single View Point Omnidirectional Camera Calibration from Planar Grids, ICRA 2007.
#if defined(CALVIN_CAMERA_LENSES_UCM_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_CAMERA_LENSES_UCM_INL_HPP
#undef CALVIN_CAMERA_LENSES_UCM_INL_HPP
#else
#define CALVIN_CAMERA_LENSES_UCM_INL_HPP
#endif

#include <cmath>

#include "calvin/camera/lenses/unified-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace calvin::lens::HWY_NAMESPACE {

struct Ucm : Radial<Ucm> {
  static constexpr std::string_view kName = "ucm";
  static constexpr int kCount = 1;
  static constexpr std::array<std::array<double, kCount>, 2> kStarts = {{{0.3}, {0.6}}};
  static constexpr std::array<std::string_view, kCount> kNames = {"alpha"};
  static constexpr std::array<CoefficientRange, kCount> kTypical = {{{0.5, 0.7}}};
  static constexpr bool kCandidate = true;
  static constexpr OpenCvForm kOpenCv = OpenCvForm::kNone;

  template <typename T>
  static HWY_INLINE Scale<T> scale(const double* d, T rho2, T z, T* by_d) {
    const Unified<T> u = unified(d[0], 1, rho2, z);
    if (by_d != nullptr) by_d[0] = u.by_alpha;
    return u.scale;
  }

  static double limit(const double* d) { return std::acos(unified_limit(d[0])); }

  static std::optional<double> angle(const double* d, double limit, double r) {
    const auto z = unified_depth(d[0], r);
    if (!z) return std::nullopt;
    return std::min(std::atan2(r, *z), limit);
  }

  static std::string glsl() {
    return R"(  float w = alpha * length(d) + (1.0 - alpha) * d.z;
  float x = d.x / w;
  float y = d.y / w;
)";
  }
};

}  // namespace calvin::lens::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // CALVIN_CAMERA_LENSES_UCM_INL_HPP
