// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Camera model = lens model + affine map to pixels, and the table of all of them:
//   u = fx x_d + skew y_d + cx
//   v = fy y_d + cy
// Scalar code says lens::Brown5 and Model<lens::Brown5>; a kernel that Highway compiles once per
// target takes lens::HWY_NAMESPACE::Brown5 and includes this after hwy/foreach_target.h.
// AllLenses is made from the list in camera/meson.build, which a new lens is added to.
#if defined(CALVIN_CAMERA_MODELS_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_CAMERA_MODELS_HPP
#undef CALVIN_CAMERA_MODELS_HPP
#else
#define CALVIN_CAMERA_MODELS_HPP
#endif

#include "calvin/camera/lens_list-inl.hpp"

#endif  // CALVIN_CAMERA_MODELS_HPP

// The names without a target: those of the static one, once.
#if HWY_ONCE && !defined(CALVIN_CAMERA_MODELS_HPP_ONCE)
#define CALVIN_CAMERA_MODELS_HPP_ONCE

namespace calvin::lens {

using namespace HWY_NAMESPACE;  // NOLINT(google-build-using-namespace)

}  // namespace calvin::lens

namespace calvin {

using lens::AllLenses;

// Functions over a bare parameter vector fx fy cx cy d0 d1 ...: what the solver varies.
template <typename L>
struct Model {
  using Lens = L;
  static constexpr std::string_view kName = Lens::kName;
  static constexpr int kCount = 4 + Lens::kCount;

  static constexpr std::array<std::string_view, kCount> names() {
    std::array<std::string_view, kCount> all = {"fx", "fy", "cx", "cy"};
    std::copy(Lens::kNames.begin(), Lens::kNames.end(), all.begin() + 4);
    return all;
  }

  // Point in the camera frame (any unit) -> uv in px. j_point: 2x3, j_parameters: 2xkCount,
  // row-major, nullptr where not wanted. The formula alone: it does not know Lens::limit().
  static bool project(const double* parameters, double skew, const Eigen::Vector3d& point,
                      double* uv, double* j_point, double* j_parameters) {
    const double fx = parameters[0];
    const double fy = parameters[1];
    double xy[2];
    double jd[2 * std::max(Lens::kCount, 1)];
    if (!Lens::template distort<double>(parameters + 4, point.data(), xy, j_point,
                                        j_parameters != nullptr ? jd : nullptr)) {
      return false;
    }
    uv[0] = fx * xy[0] + skew * xy[1] + parameters[2];
    uv[1] = fy * xy[1] + parameters[3];
    if (j_point != nullptr) {
      for (int i = 0; i < 3; ++i) {
        j_point[i] = fx * j_point[i] + skew * j_point[3 + i];
        j_point[3 + i] *= fy;
      }
    }
    if (j_parameters != nullptr) {
      double* ju = j_parameters;
      double* jv = j_parameters + kCount;
      ju[0] = xy[0], ju[1] = 0, ju[2] = 1, ju[3] = 0;
      jv[0] = 0, jv[1] = xy[1], jv[2] = 0, jv[3] = 1;
      for (int i = 0; i < Lens::kCount; ++i) {
        ju[4 + i] = fx * jd[i] + skew * jd[Lens::kCount + i];
        jv[4 + i] = fy * jd[Lens::kCount + i];
      }
    }
    return true;
  }
};

// Calls f.template operator()<Model<Lens>>() for the model of that name; false for an unknown one.
template <typename F>
bool visit_model(std::string_view name, F&& f) {
  return [&]<typename... Lens>(std::tuple<Lens...>*) {
    return ((Lens::kName == name && (f.template operator()<Model<Lens>>(), true)) || ...);
  }(static_cast<AllLenses*>(nullptr));
}

}  // namespace calvin

#endif  // HWY_ONCE
