// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The field of view lens, w (rad; "fov" of Kalibr, omega of COLMAP and of TUM's monocular data):
//   r_d = atan(2 tan(w / 2) rho / Z) / w
// w = 0 is a pinhole. The angle goes on past 90 degrees, where the paper ends.
// F. Devernay, O. Faugeras, Straight lines have to be straight, Machine Vision and Applications
// 13(1), 2001, section 2.2.
#if defined(CALVIN_CAMERA_LENSES_FOV_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_CAMERA_LENSES_FOV_INL_HPP
#undef CALVIN_CAMERA_LENSES_FOV_INL_HPP
#else
#define CALVIN_CAMERA_LENSES_FOV_INL_HPP
#endif

#include <cmath>
#include <numbers>

#include "calvin/camera/lenses/radial-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace calvin::lens::HWY_NAMESPACE {

struct Fov : Radial<Fov> {
  static constexpr std::string_view kName = "fov";
  static constexpr int kCount = 1;
  // Not from 0, where no change of w shows.
  static constexpr std::array<std::array<double, kCount>, 2> kStarts = {{{0.5}, {0.9}}};
  static constexpr std::array<std::string_view, kCount> kNames = {"w"};
  static constexpr std::array<CoefficientRange, kCount> kTypical = {{{0.7, 1.2}}};
  static constexpr bool kCandidate = false;  // auto has ucm for lenses of one coefficient
  static constexpr OpenCvForm kOpenCv = OpenCvForm::kNone;

  // With b = 2 tan(w / 2) rho: r_d = atan2(b, Z) / w, and its derivatives have b Z / (b^2 + Z^2) -
  // atan2(b, Z), which near the axis is -(b / Z)^3 (2/3 - 4/5 (b / Z)^2 + 6/7 (b / Z)^4 ...).
  template <typename T>
  static HWY_INLINE Scale<T> scale(const double* d, T rho2, T z, T* by_d) {
    const double w = std::abs(d[0]);
    const double g = stretch(w);
    const double t = w * g;  // 2 tan(w / 2)
    const T b2 = t * t * rho2;
    const T in2 = 1 / (b2 + z * z);
    const MaskOf<T> near = (b2 < 0.02 * (z * z)) & (z > 0);
    const T iz = 1 / z;
    const T q = b2 * iz * iz;
    T series = 0;
    for (int k = 10; k > 0; --k) series = 2.0 * k / (2 * k + 1) - q * series;
    const T rho = sqrt(rho2);
    const T angle = atan2(t * rho, z);
    const T rest = t * rho * z * in2 - angle;
    Scale<T> out;
    out.s = select(near, g * iz * (z * z * in2 + q * series), angle / (w * rho));
    out.by_rho = select(near, -g * t * t * iz * iz * iz * series, rest / (w * rho * rho2));
    out.by_z = -g * in2;
    // Straight backwards there is no direction, and from w = pi on there is no lens.
    out.valid = ((z > 0) | (b2 > 1e-12 * (z * z))) & (T(w) < T(std::numbers::pi));
    if (by_d != nullptr) {
      const T slope = select(near, -g * g * t * rho2 * iz * iz * iz * series, rest / (w * w * rho));
      by_d[0] = std::copysign(1.0, d[0]) * (stretch_excess(w) * t * z * in2 + slope);
    }
    return out;
  }

  static double limit(const double* d) {
    if (!(std::abs(d[0]) < std::numbers::pi)) return 0;
    return d[0] == 0 ? std::numbers::pi / 2 : std::numbers::pi;
  }

  static std::optional<double> angle(const double* d, double limit, double r) {
    const double w = std::abs(d[0]);
    const double turned = w * r;
    if (!(turned <= std::numbers::pi)) return std::nullopt;
    const double across = turned < 1e-9 ? r : std::sin(turned) / w;
    return std::min(std::atan2(across, stretch(w) * std::cos(turned)), limit);
  }

  static std::string glsl() {
    return R"(  float across = length(vec2(d.x, d.y));
  float bent = abs(w) > 1e-5 ? atan(2.0 * tan(0.5 * abs(w)) * across, d.z) / abs(w) : across / d.z;
  float x = across > 0.0 ? d.x / across * bent : 0.0;
  float y = across > 0.0 ? d.y / across * bent : 0.0;
)";
  }

 private:
  // 2 tan(w / 2) / w
  static double stretch(double w) { return w < 1e-4 ? 1 + w * w / 12 : 2 * std::tan(w / 2) / w; }

  // (w / sin(w) - 1) / w^2
  static double stretch_excess(double w) {
    const double q = w * w;
    if (w < 0.05) return 1.0 / 6 + q * (7.0 / 360 + q * (31.0 / 15120 + q * (127.0 / 604800)));
    return (w / std::sin(w) - 1) / q;
  }
};

}  // namespace calvin::lens::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // CALVIN_CAMERA_LENSES_FOV_INL_HPP
