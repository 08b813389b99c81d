// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Every camera model once more, for Ceres' automatic derivatives, written from the papers and from
// OpenCV's documentation and not from lib/calvin/camera: an independent opinion.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <tuple>

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include "calvin/core/image.hpp"

namespace calvin::formulas {

// Until the solver stands still.
inline ceres::Solver::Options settled(ceres::LinearSolverType type) {
  ceres::Solver::Options options;
  options.linear_solver_type = type;
  options.max_num_iterations = 500;
  options.function_tolerance = 1e-16;
  options.gradient_tolerance = 1e-16;
  options.parameter_tolerance = 1e-14;
  options.logging_type = ceres::SILENT;
  return options;
}

// OpenCV 4.6, "Camera Calibration and 3D Reconstruction", detailed description: k1 k2 p1 p2 k3 k4
// k5 k6 s1 s2 s3 s4 taux tauy, of which the first `kCoefficients` are given.
template <int kCoefficients>
struct OpenCvLens {
  static constexpr int kCount = kCoefficients;

  template <typename T>
  static bool distort(const T* given, const T* p, T* xy) {
    if (!(p[2] > 0.0)) return false;
    std::array<T, 14> d;
    for (int i = 0; i < 14; ++i) d[static_cast<std::size_t>(i)] = i < kCount ? given[i] : T(0);
    const auto& [k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4, taux, tauy] = d;
    const T x = p[0] / p[2];
    const T y = p[1] / p[2];
    const T r2 = x * x + y * y;
    const T r4 = r2 * r2;
    const T r6 = r4 * r2;
    const T radial = (1.0 + k1 * r2 + k2 * r4 + k3 * r6) / (1.0 + k4 * r2 + k5 * r4 + k6 * r6);
    xy[0] = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x) + s1 * r2 + s2 * r4;
    xy[1] = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y + s3 * r2 + s4 * r4;
    if constexpr (kCount == 14) tilt(taux, tauy, xy);
    return true;
  }

 private:
  // s (x y 1) = [R33 0 -R13; 0 R33 -R23; 0 0 1] R (x'' y'' 1)
  template <typename T>
  static void tilt(const T& taux, const T& tauy, T* xy) {
    const Eigen::Matrix<T, 3, 3> about_y{
        {cos(tauy), T(0), -sin(tauy)}, {T(0), T(1), T(0)}, {sin(tauy), T(0), cos(tauy)}};
    const Eigen::Matrix<T, 3, 3> about_x{
        {T(1), T(0), T(0)}, {T(0), cos(taux), sin(taux)}, {T(0), -sin(taux), cos(taux)}};
    const Eigen::Matrix<T, 3, 3> r = about_y * about_x;
    const Eigen::Matrix<T, 3, 3> back{
        {r(2, 2), T(0), -r(0, 2)}, {T(0), r(2, 2), -r(1, 2)}, {T(0), T(0), T(1)}};
    const Eigen::Matrix<T, 3, 1> at = back * r * Eigen::Matrix<T, 3, 1>(xy[0], xy[1], T(1));
    xy[0] = at[0] / at[2];
    xy[1] = at[1] / at[2];
  }
};

struct Pinhole : OpenCvLens<0> {
  static constexpr std::string_view kName = "pinhole";
};
struct Brown4 : OpenCvLens<4> {
  static constexpr std::string_view kName = "brown4";
};
struct Brown5 : OpenCvLens<5> {
  static constexpr std::string_view kName = "brown5";
};
struct Rational8 : OpenCvLens<8> {
  static constexpr std::string_view kName = "rational8";
};
struct ThinPrism12 : OpenCvLens<12> {
  static constexpr std::string_view kName = "thinprism12";
};
struct Tilted14 : OpenCvLens<14> {
  static constexpr std::string_view kName = "tilted14";
};

// J. Kannala, S. Brandt, A Generic Camera Model and Calibration Method, PAMI 28(8), 2006, eq. 6, as
// OpenCV's fisheye has it, with the angle taken over the whole sphere.
struct Fisheye {
  static constexpr std::string_view kName = "fisheye";
  static constexpr int kCount = 4;
  template <typename T>
  static bool distort(const T* k, const T* p, T* xy) {
    const T r = sqrt(p[0] * p[0] + p[1] * p[1] + 1e-30);
    const T a = atan2(r, p[2]);
    const T a2 = a * a;
    const T a4 = a2 * a2;
    const T bent = a * (1.0 + k[0] * a2 + k[1] * a4 + k[2] * a4 * a2 + k[3] * a4 * a4);
    xy[0] = bent * p[0] / r;
    xy[1] = bent * p[1] / r;
    return true;
  }
};

// V. Usenko, N. Demmel, D. Cremers, The Double Sphere Camera Model, 3DV 2018: section 3.2 (UCM),
// 3.3 (EUCM: B. Khomutenko, G. Garcia, P. Martinet, RA-L 1(1), 2016) and eq. 40-42.
struct Ucm {
  static constexpr std::string_view kName = "ucm";
  static constexpr int kCount = 1;
  template <typename T>
  static bool distort(const T* alpha, const T* p, T* xy) {
    const T d = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    const T w = alpha[0] * d + (1.0 - alpha[0]) * p[2];
    xy[0] = p[0] / w;
    xy[1] = p[1] / w;
    return w > 0.0;
  }
};

struct Eucm {
  static constexpr std::string_view kName = "eucm";
  static constexpr int kCount = 2;
  template <typename T>
  static bool distort(const T* alpha_beta, const T* p, T* xy) {
    const T d = sqrt(alpha_beta[1] * (p[0] * p[0] + p[1] * p[1]) + p[2] * p[2]);
    const T w = alpha_beta[0] * d + (1.0 - alpha_beta[0]) * p[2];
    xy[0] = p[0] / w;
    xy[1] = p[1] / w;
    return w > 0.0;
  }
};

struct DoubleSphere {
  static constexpr std::string_view kName = "doublesphere";
  static constexpr int kCount = 2;
  template <typename T>
  static bool distort(const T* xi_alpha, const T* p, T* xy) {
    const T r2 = p[0] * p[0] + p[1] * p[1];
    const T d1 = sqrt(r2 + p[2] * p[2]);
    const T z = xi_alpha[0] * d1 + p[2];
    const T d2 = sqrt(r2 + z * z);
    const T w = xi_alpha[1] * d2 + (1.0 - xi_alpha[1]) * z;
    xy[0] = p[0] / w;
    xy[1] = p[1] / w;
    return w > 0.0;
  }
};

// F. Devernay, O. Faugeras, Straight lines have to be straight, MVA 13(1), 2001, with the
// arctangent taken over the half circle.
struct Fov {
  static constexpr std::string_view kName = "fov";
  static constexpr int kCount = 1;
  template <typename T>
  static bool distort(const T* w, const T* p, T* xy) {
    const T r = sqrt(p[0] * p[0] + p[1] * p[1] + 1e-30);
    const T bent = atan2(2.0 * r * tan(w[0] / 2.0), p[2]) / w[0];
    xy[0] = bent * p[0] / r;
    xy[1] = bent * p[1] / r;
    return true;
  }
};

using All = std::tuple<Pinhole, Brown4, Brown5, Rational8, ThinPrism12, Tilted14, Fisheye, Ucm,
                       Eucm, DoubleSphere, Fov>;

// Of one corner: parameter blocks camera (fx fy cx cy and the coefficients, then the skew) and pose
// (Rodrigues vector, translation).
template <typename Lens>
struct Residual {
  Eigen::Vector3d point;
  Pixel seen;

  template <typename T>
  bool operator()(const T* camera, const T* pose, T* residual) const {
    const T on_board[3] = {T(point.x()), T(point.y()), T(point.z())};
    T at[3];
    ceres::AngleAxisRotatePoint(pose, on_board, at);
    for (int i = 0; i < 3; ++i) at[i] += pose[3 + i];
    T xy[2];
    if (!Lens::distort(camera + 4, at, xy)) return false;
    residual[0] = camera[0] * xy[0] + camera[4 + Lens::kCount] * xy[1] + camera[2] - seen.u;
    residual[1] = camera[1] * xy[1] + camera[3] - seen.v;
    return true;
  }
};

// nullptr for a model whose formula is not above.
inline ceres::CostFunction* make_cost(std::string_view model, const Eigen::Vector3d& point,
                                      Pixel seen) {
  ceres::CostFunction* cost = nullptr;
  [&]<typename... Lens>(std::tuple<Lens...>*) {
    ((Lens::kName == model &&
      (cost = new ceres::AutoDiffCostFunction<Residual<Lens>, 2, 5 + Lens::kCount, 6>(
           new Residual<Lens>{point, seen}))),
     ...);
  }(static_cast<All*>(nullptr));
  return cost;
}

}  // namespace calvin::formulas
