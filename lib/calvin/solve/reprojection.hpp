// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The residuals and derivatives of one view, condensed to its normal equations. Internal.
#pragma once

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

#include "calvin/camera/models.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/solve/loss.hpp"
#include "calvin/solve/points.hpp"
#include "calvin/solve/pose_block.hpp"

namespace calvin {

// J^T J of one view, J = [pose | parameters | residual]. The pose moves by exp(d) from the left:
// three components of rotation (rad), then three of translation (m).
template <typename M>
struct ViewEquations {
  static constexpr int kPose = 6;
  static constexpr int kShared = M::kCount;
  static constexpr int kSize = kPose + kShared + 1;

  Eigen::Matrix<double, kSize, kSize> normal;  // lower triangle, px^2 per unit^2
  double cost = 0;                             // px^2

  [[nodiscard]] auto pose() const { return normal.template topLeftCorner<kPose, kPose>(); }
  [[nodiscard]] auto cross() const { return normal.template block<kShared, kPose>(kPose, 0); }
  [[nodiscard]] auto shared() const {
    return normal.template block<kShared, kShared>(kPose, kPose);
  }
  [[nodiscard]] auto pose_gradient() const {
    return normal.template block<1, kPose>(kSize - 1, 0).transpose();
  }
  [[nodiscard]] auto shared_gradient() const {
    return normal.template block<1, kShared>(kSize - 1, kPose).transpose();
  }
};

// Stands for the distance of a corner that has no projection, px.
inline constexpr double kFarthest = 1e6;

// Evaluates views one after the other; holds the rows of one view only.
template <typename M>
class Reprojection {
 public:
  using Equations = ViewEquations<M>;

  explicit Reprojection(Loss loss = {}, double skew = 0) : loss_(loss), skew_(skew) {}

  // `parameters` as in Model. False where a point has no projection: out is then undefined.
  [[nodiscard]] bool evaluate(const PointSet& view, const double* parameters,
                              const SE3& camera_from_board, Equations& out) {
    rows_.resize(Eigen::NoChange, static_cast<Eigen::Index>(2 * view.size()));
    Eigen::Index count = 0;
    out.cost = 0;
    for (std::size_t i = 0; i < view.size(); ++i) {
      if (!(view.weight[i] > 0)) continue;
      const Eigen::Vector3d point = camera_from_board * view.points[i];
      if (!append(view, i, parameters, point, count, out.cost)) return false;
      count += 2;
    }
    set_normal(rows_.leftCols(count), out.normal);
    return std::isfinite(out.cost);
  }

  // Weighted distance of every corner from where it belongs, px, never above kFarthest.
  [[nodiscard]] std::vector<double> distances(const PointSet& view, const double* parameters,
                                              const SE3& camera_from_board) const {
    std::vector<double> result(view.size(), kFarthest);
    for (std::size_t i = 0; i < view.size(); ++i) {
      double uv[2];
      if (!M::project(parameters, skew_, camera_from_board * view.points[i], uv, nullptr,
                      nullptr)) {
        continue;
      }
      const double distance = std::hypot(uv[0] - view.uv[i].u, uv[1] - view.uv[i].v);
      if (std::isfinite(distance)) result[i] = std::min(view.weight[i] * distance, kFarthest);
    }
    return result;
  }

 private:
  static constexpr int kSize = Equations::kSize;

  bool append(const PointSet& view, std::size_t i, const double* parameters,
              const Eigen::Vector3d& point, Eigen::Index at, double& cost) {
    double uv[2];
    double jp[6];
    double jq[2 * M::kCount];
    if (!M::project(parameters, skew_, point, uv, jp, jq)) return false;
    const double w = view.weight[i];
    const double residual[2] = {uv[0] - view.uv[i].u, uv[1] - view.uv[i].v};
    const Loss::Value loss = loss_(w * w * (residual[0] * residual[0] + residual[1] * residual[1]));
    cost += loss.cost;
    const double scale = w * std::sqrt(loss.weight);
    for (int k = 0; k < 2; ++k) {
      double* row = rows_.col(at + k).data();
      const double gx = scale * jp[3 * k];
      const double gy = scale * jp[3 * k + 1];
      const double gz = scale * jp[3 * k + 2];
      row[0] = point[1] * gz - point[2] * gy;
      row[1] = point[2] * gx - point[0] * gz;
      row[2] = point[0] * gy - point[1] * gx;
      row[3] = gx;
      row[4] = gy;
      row[5] = gz;
      for (int j = 0; j < M::kCount; ++j) row[6 + j] = scale * jq[M::kCount * k + j];
      row[kSize - 1] = scale * residual[k];
    }
    return true;
  }

  Loss loss_;
  double skew_;
  Eigen::Matrix<double, kSize, Eigen::Dynamic> rows_;  // one column per residual
};

// exp(d) * pose, d as in ViewEquations.
[[nodiscard]] inline SE3 moved(const SE3& pose, const Vector6& d) {
  const Eigen::Matrix3d turn = exp_so3(d.head<3>());
  return {turn * pose.rotation, turn * pose.translation + d.tail<3>()};
}

}  // namespace calvin
