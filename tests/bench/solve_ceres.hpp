// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Ceres as fast as it goes here: a cost function per view with analytic derivatives by the camera
// and by a Rodrigues vector and translation, poses eliminated first.
#pragma once

#include <cmath>
#include <memory>

#include <ceres/ceres.h>

#include "calvin/camera/models.hpp"
#include "calvin/geometry/se3.hpp"
#include "solve_problem.hpp"

namespace bench {

// exp(w + dw) = exp(w) exp(Jr dw) (G. S. Chirikjian, Stochastic Models, Information Theory, and
// Lie Groups 2, 2012, section 10.6).
inline Eigen::Matrix3d right_jacobian(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  Eigen::Matrix3d cross;
  cross << 0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0;
  if (angle < 1e-8) return Eigen::Matrix3d::Identity() - 0.5 * cross;
  const double square = angle * angle;
  return Eigen::Matrix3d::Identity() - (1 - std::cos(angle)) / square * cross +
         (angle - std::sin(angle)) / (square * angle) * cross * cross;
}

// Residuals u v of all corners of a view; parameter blocks: intrinsics, pose (Rodrigues vector,
// translation).
template <typename Model>
class ViewCost : public ceres::CostFunction {
 public:
  explicit ViewCost(const calvin::View& view) : points_(kBoard.points()), uv_(view.observation.uv) {
    set_num_residuals(2 * static_cast<int>(points_.size()));
    *mutable_parameter_block_sizes() = {Model::kCount, 6};
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const double* pose = parameters[1];
    const Eigen::Vector3d w(pose);
    const Eigen::Vector3d t(pose + 3);
    const Eigen::Matrix3d r = calvin::exp_so3(w);
    const Eigen::Matrix3d jr = right_jacobian(w);
    const bool wanted = jacobians != nullptr && jacobians[1] != nullptr;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      double uv[2];
      double by_point[6];
      double* by_camera = jacobians != nullptr && jacobians[0] != nullptr
                              ? jacobians[0] + 2 * Model::kCount * i
                              : nullptr;
      if (!Model::project(parameters[0], 0, r * points_[i] + t, uv, wanted ? by_point : nullptr,
                          by_camera)) {
        return false;
      }
      residuals[2 * i] = uv[0] - uv_[i].u;
      residuals[2 * i + 1] = uv[1] - uv_[i].v;
      if (!wanted) continue;
      // d(R X) = -R [X] Jr dw with X = (x y 0).
      const Eigen::Map<const Eigen::Matrix<double, 2, 3, Eigen::RowMajor>> g(by_point);
      const Eigen::Matrix<double, 2, 3> h = g * r;
      const double x = points_[i].x();
      const double y = points_[i].y();
      Eigen::Matrix<double, 2, 3> hx;
      hx << h.col(2) * y, h.col(2) * -x, h.col(1) * x - h.col(0) * y;
      Eigen::Map<Eigen::Matrix<double, 2, 6, Eigen::RowMajor>> j(jacobians[1] + 12 * i);
      j.leftCols<3>().noalias() = hx * jr;
      j.rightCols<3>() = g;
    }
    return true;
  }

 private:
  std::vector<Eigen::Vector3d> points_;
  std::vector<calvin::Pixel> uv_;
};

// One problem, built once; run() solves it from near_truth().
class Ceres {
 public:
  Ceres(const Problem& problem, ceres::LinearSolverType linear_solver)
      : start_(near_truth(problem)), poses_(6 * problem.views.size()) {
    intrinsics_ = start_.intrinsics;
    ceres::Problem::Options ownership;
    ownership.disable_all_safety_checks = true;
    problem_ = std::make_unique<ceres::Problem>(ownership);
    options_.linear_solver_type = linear_solver;
    options_.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    options_.num_threads = 1;
    options_.max_num_iterations = 100;
    options_.function_tolerance = 1e-12;
    options_.gradient_tolerance = 1e-15;
    options_.parameter_tolerance = 1e-12;
    options_.logging_type = ceres::SILENT;
    for (std::size_t i = 0; i < problem.views.size(); ++i) {
      double* pose = poses_.data() + 6 * i;
      problem_->AddResidualBlock(make_cost(problem.model, problem.views[i]), nullptr,
                                 intrinsics_.data(), pose);
      options_.linear_solver_ordering->AddElementToGroup(pose, 0);
    }
    options_.linear_solver_ordering->AddElementToGroup(intrinsics_.data(), 1);
  }

  Fitted run() {
    intrinsics_ = start_.intrinsics;
    for (std::size_t i = 0; i < start_.camera_from_board.size(); ++i) {
      const SE3& pose = start_.camera_from_board[i];
      Eigen::Map<Eigen::Vector3d>(poses_.data() + 6 * i) = calvin::log_so3(pose.rotation);
      Eigen::Map<Eigen::Vector3d>(poses_.data() + 6 * i + 3) = pose.translation;
    }
    ceres::Solver::Summary summary;
    ceres::Solve(options_, problem_.get(), &summary);
    Fitted fitted{intrinsics_, {}};
    for (std::size_t i = 0; i < start_.camera_from_board.size(); ++i) {
      const Eigen::Vector3d w(poses_.data() + 6 * i);
      const Eigen::Vector3d t(poses_.data() + 6 * i + 3);
      fitted.camera_from_board.push_back({calvin::exp_so3(w), t});
    }
    return fitted;
  }

 private:
  static ceres::CostFunction* make_cost(const std::string& model, const calvin::View& view) {
    ceres::CostFunction* cost = nullptr;
    calvin::visit_model(model, [&]<typename Model>() { cost = new ViewCost<Model>(view); });
    return cost;
  }

  Fitted start_;
  std::vector<double> intrinsics_;
  std::vector<double> poses_;
  std::unique_ptr<ceres::Problem> problem_;
  ceres::Solver::Options options_;
};

}  // namespace bench
