// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The rig of rig_scene.hpp, solved by Ceres until it stands still.
#pragma once

#include <algorithm>
#include <array>
#include <deque>
#include <memory>
#include <vector>

#include "ceres_formulas.hpp"
#include "rig_scene.hpp"

namespace calvin::formulas {

// The same residuals for Ceres' automatic derivatives.
template <typename Lens>
struct Seen {
  Pixel at;
  double weight;

  template <typename T>
  bool residual(const T* camera, const T* rig, const T* in_rig, T* out) const {
    T p[3];
    ceres::AngleAxisRotatePoint(rig, in_rig, p);
    for (int k = 0; k < 3; ++k) p[k] += rig[3 + k];
    T xy[2];
    if (!Lens::distort(camera + 4, p, xy)) return false;
    const T u = camera[0] * xy[0] + camera[4 + Lens::kCount] * xy[1] + camera[2];
    const T v = camera[1] * xy[1] + camera[3];
    out[0] = weight * (u - at.u);
    out[1] = weight * (v - at.v);
    return true;
  }
};

template <typename Lens>
struct OnBoard : Seen<Lens> {
  Eigen::Vector3d printed;
  double bend[2];  // 1 - x^2 and 1 - y^2

  template <typename T>
  bool operator()(const T* camera, const T* rig, const T* pose, const T* warp, T* out) const {
    const T on_board[3] = {T(printed.x()), T(printed.y()),
                           printed.z() + warp[0] * bend[0] + warp[1] * bend[1]};
    T in_rig[3];
    ceres::AngleAxisRotatePoint(pose, on_board, in_rig);
    for (int k = 0; k < 3; ++k) in_rig[k] += pose[3 + k];
    return this->residual(camera, rig, in_rig, out);
  }
};

template <typename Lens>
struct Free : Seen<Lens> {
  SE3 rig_from_world;

  template <typename T>
  bool operator()(const T* camera, const T* rig, const T* point, T* out) const {
    T in_rig[3];
    for (int i = 0; i < 3; ++i) {
      in_rig[i] = T(rig_from_world.translation[i]);
      for (int k = 0; k < 3; ++k) in_rig[i] += rig_from_world.rotation(i, k) * point[k];
    }
    return this->residual(camera, rig, in_rig, out);
  }
};

struct WarpPrior {
  template <typename T>
  bool operator()(const T* warp, T* out) const {
    for (int i = 0; i < 2; ++i) out[i] = warp[i] / scenes::kWarpSigma;
    return true;
  }
};

using Numbers = std::array<double, 6>;
inline Numbers numbers_of(const SE3& pose) {
  const Eigen::Vector3d w = log_so3(pose.rotation);
  const Eigen::Vector3d& t = pose.translation;
  return {w[0], w[1], w[2], t[0], t[1], t[2]};
}

class CeresRig {
 public:
  CeresRig(const scenes::Scene& scene, const ParameterTable& table, const BundlePoint& start) {
    for (std::size_t c = 0; c < 2; ++c) {
      const auto own = values_of(start.shared, table.intrinsics(c));
      cameras_[c].assign(own.begin(), own.end());
      cameras_[c].push_back(table.skew_at(c, start.shared));
      rig_[c] = numbers_of(start.camera_from_rig[c]);
    }
    const auto warp = values_of(start.shared, table.warp(0));
    std::copy(warp.begin(), warp.end(), warp_[0].begin());
    for (const SE3& pose : start.rig_from_board) poses_.push_back(numbers_of(pose));
    points_ = start.points;
    for (std::size_t v = 0; v < scene.seen.size(); ++v) {
      scene.seen[v].camera == 0 ? add_board<Brown5>(scene, v) : add_board<Fisheye>(scene, v);
    }
    for (const PointResiduals& block : scene.points) {
      block.camera == 0 ? add_points<Brown5>(block) : add_points<Fisheye>(block);
    }
    problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<WarpPrior, 2, 2>(new WarpPrior),
                              nullptr, warp_[0].data());
    problem_.SetParameterBlockConstant(warp_[1].data());
    problem_.SetParameterBlockConstant(rig_[0].data());
    const auto count = static_cast<int>(cameras_[1].size());
    problem_.SetManifold(cameras_[1].data(), new ceres::SubsetManifold(count, {count - 1}));
    options_.linear_solver_type = ceres::DENSE_SCHUR;
    options_.linear_solver_ordering = ordering();
    options_.max_num_iterations = 1000;
    options_.function_tolerance = 1e-17;
    options_.gradient_tolerance = 1e-20;
    options_.parameter_tolerance = 1e-15;
    options_.logging_type = ceres::SILENT;
  }

  double cost() {
    double half = 0;
    problem_.Evaluate(ceres::Problem::EvaluateOptions(), &half, nullptr, nullptr, nullptr);
    return 2 * half;
  }
  double solve() {
    ceres::Solver::Summary summary;
    ceres::Solve(options_, &problem_, &summary);
    return cost();
  }
  [[nodiscard]] const std::vector<double>& camera(std::size_t c) const { return cameras_[c]; }
  [[nodiscard]] const Numbers& rig(std::size_t c) const { return rig_[c]; }
  [[nodiscard]] const std::array<double, 2>& warp() const { return warp_[0]; }

 private:
  template <typename Lens>
  void add_board(const scenes::Scene& scene, std::size_t v) {
    const BoardResiduals& block = scene.seen[v];
    const PointSet& set = scene.sets[v];
    for (std::size_t i = 0; i < set.ids.size(); ++i) {
      auto* corner = new OnBoard<Lens>{{set.uv[i], set.weight[i]}, set.points[i], {0, 0}};
      if (block.board == 0) {
        const double x = 2 * set.points[i].x() / scenes::kBoard.extent().width() - 1;
        const double y = 2 * set.points[i].y() / scenes::kBoard.extent().height() - 1;
        corner->bend[0] = 1 - x * x;
        corner->bend[1] = 1 - y * y;
      }
      problem_.AddResidualBlock(
          new ceres::AutoDiffCostFunction<OnBoard<Lens>, 2, 5 + Lens::kCount, 6, 6, 2>(corner),
          nullptr, cameras_[block.camera].data(), rig_[block.camera].data(),
          poses_[block.pose].data(), warp_[block.board].data());
    }
  }
  template <typename Lens>
  void add_points(const PointResiduals& block) {
    for (std::size_t i = 0; i < block.seen.ids.size(); ++i) {
      auto* point = new Free<Lens>{{block.seen.uv[i], block.seen.weight[i]}, block.rig_from_world};
      problem_.AddResidualBlock(
          new ceres::AutoDiffCostFunction<Free<Lens>, 2, 5 + Lens::kCount, 6, 3>(point), nullptr,
          cameras_[block.camera].data(), rig_[block.camera].data(),
          points_[static_cast<std::size_t>(block.seen.ids[i])].data());
    }
  }
  [[nodiscard]] std::shared_ptr<ceres::ParameterBlockOrdering> ordering() {
    auto order = std::make_shared<ceres::ParameterBlockOrdering>();
    for (Numbers& pose : poses_) order->AddElementToGroup(pose.data(), 0);
    for (Eigen::Vector3d& point : points_) order->AddElementToGroup(point.data(), 0);
    for (std::size_t i = 0; i < 2; ++i) {
      order->AddElementToGroup(cameras_[i].data(), 1);
      order->AddElementToGroup(rig_[i].data(), 1);
      order->AddElementToGroup(warp_[i].data(), 1);
    }
    return order;
  }

  std::vector<double> cameras_[2];
  Numbers rig_[2];
  std::array<double, 2> warp_[2] = {};
  std::deque<Numbers> poses_;
  std::vector<Eigen::Vector3d> points_;
  ceres::Problem problem_;
  ceres::Solver::Options options_;
};

}  // namespace calvin::formulas
