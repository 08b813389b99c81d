// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The calibration of one camera by Ceres, run until it stands still.
#pragma once

#include <algorithm>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "calvin/camera/camera.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/solve/solve.hpp"
#include "ceres_formulas.hpp"

namespace calvin::formulas {

struct CeresFit {
  double cost = 0;  // px^2
  std::vector<double> camera;
};

class CeresSolver {
 public:
  CeresSolver(std::string_view model, const std::vector<View>& views, std::vector<int> fixed)
      : fixed_(std::move(fixed)) {
    camera_.resize(parameter_names(model).size() + 1);
    poses_.resize(6 * views.size());
    fixed_.push_back(static_cast<int>(camera_.size()) - 1);  // the skew
    options_.linear_solver_type = ceres::DENSE_SCHUR;
    options_.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    for (std::size_t v = 0; v < views.size(); ++v) {
      const auto points = views[v].board.points();
      const Observation& seen = views[v].observation;
      for (std::size_t i = 0; i < seen.ids.size(); ++i) {
        auto* cost =
            formulas::make_cost(model, points[static_cast<std::size_t>(seen.ids[i])], seen.uv[i]);
        if (cost == nullptr) return;
        problem_.AddResidualBlock(cost, nullptr, camera_.data(), poses_.data() + 6 * v);
      }
      options_.linear_solver_ordering->AddElementToGroup(poses_.data() + 6 * v, 0);
    }
    options_.linear_solver_ordering->AddElementToGroup(camera_.data(), 1);
    problem_.SetManifold(camera_.data(),
                         new ceres::SubsetManifold(static_cast<int>(camera_.size()), fixed_));
    options_.max_num_iterations = 1000;
    options_.function_tolerance = 1e-17;
    options_.gradient_tolerance = 1e-20;
    options_.parameter_tolerance = 1e-15;
    options_.logging_type = ceres::SILENT;
    usable_ = true;
  }

  [[nodiscard]] bool usable() const { return usable_; }

  void start(const std::vector<double>& camera, const std::vector<SE3>& poses) {
    std::copy(camera.begin(), camera.end(), camera_.begin());
    for (std::size_t v = 0; v < poses.size(); ++v) {
      const Eigen::Vector3d w = log_so3(poses[v].rotation);
      std::copy(w.data(), w.data() + 3, poses_.begin() + 6 * static_cast<std::ptrdiff_t>(v));
      std::copy(poses[v].translation.data(), poses[v].translation.data() + 3,
                poses_.begin() + 6 * static_cast<std::ptrdiff_t>(v) + 3);
    }
  }

  // At the start, and at the end.
  [[nodiscard]] double cost() {
    double half = 0;
    problem_.Evaluate(ceres::Problem::EvaluateOptions(), &half, nullptr, nullptr, nullptr);
    return 2 * half;
  }
  CeresFit solve() {
    ceres::Solver::Summary summary;
    ceres::Solve(options_, &problem_, &summary);
    return {cost(), camera_};
  }

 private:
  std::vector<int> fixed_;
  std::vector<double> camera_;
  std::vector<double> poses_;
  ceres::Problem problem_;
  ceres::Solver::Options options_;
  bool usable_ = false;
};

}  // namespace calvin::formulas
