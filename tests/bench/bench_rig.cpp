// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where the cameras of a rig stand, from observations: ours from nothing to the covariances, beside
// Ceres, which gets a start near the truth and refines it: a cost function per view with analytic
// derivatives by two poses, boards eliminated first. Intrinsics are known. One thread.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <ceres/ceres.h>

#include "calvin/rig/solve_rig.hpp"
#include "calvin/solve/pose.hpp"
#include "ratio_reporter.hpp"
#include "simulated_rig.hpp"
#include "solve_ceres.hpp"

namespace {

using namespace calvin;

struct RigProblem {
  scenes::SimulatedRig rig;
  std::vector<RigCameraViews> seen;
};

RigProblem make_problem(int cameras, int instants) {
  scenes::Random random(9);
  RigProblem problem{scenes::ring_rig(cameras, random), {}};
  problem.seen = scenes::seen_by(problem.rig, instants, 0.7, random);
  return problem;
}

// Residuals u v of all corners of a view; parameter blocks: camera_from_rig and rig_from_board,
// each a Rodrigues vector and a translation.
template <typename Model>
class PlacedViewCost : public ceres::CostFunction {
 public:
  PlacedViewCost(const View& view, const Camera& camera)
      : points_(view.board.points()), seen_(view.observation), camera_(camera.parameters()) {
    set_num_residuals(2 * static_cast<int>(seen_.ids.size()));
    *mutable_parameter_block_sizes() = {6, 6};
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const Eigen::Vector3d camera_turn(parameters[0]);
    const Eigen::Vector3d board_turn(parameters[1]);
    const SE3 camera_from_rig = {exp_so3(camera_turn), Eigen::Vector3d(parameters[0] + 3)};
    const SE3 rig_from_board = {exp_so3(board_turn), Eigen::Vector3d(parameters[1] + 3)};
    const Eigen::Matrix3d by_camera_turn = bench::right_jacobian(camera_turn);
    const Eigen::Matrix3d by_board_turn = bench::right_jacobian(board_turn);
    for (std::size_t i = 0; i < seen_.ids.size(); ++i) {
      const Eigen::Vector3d& x = points_[static_cast<std::size_t>(seen_.ids[i])];
      const Eigen::Vector3d in_rig = rig_from_board * x;
      double uv[2];
      double by_point[6];
      if (!Model::project(camera_.data(), 0, camera_from_rig * in_rig, uv,
                          jacobians != nullptr ? by_point : nullptr, nullptr)) {
        return false;
      }
      residuals[2 * i] = uv[0] - seen_.uv[i].u;
      residuals[2 * i + 1] = uv[1] - seen_.uv[i].v;
      if (jacobians == nullptr) continue;
      using Rows = Eigen::Matrix<double, 2, 6, Eigen::RowMajor>;
      const Eigen::Map<const Eigen::Matrix<double, 2, 3, Eigen::RowMajor>> g(by_point);
      const Eigen::Matrix<double, 2, 3> h = g * camera_from_rig.rotation;
      if (jacobians[0] != nullptr) {
        Eigen::Map<Rows> j(jacobians[0] + 12 * i);
        j.leftCols<3>() = -h * cross(in_rig) * by_camera_turn;
        j.rightCols<3>() = g;
      }
      if (jacobians[1] != nullptr) {
        Eigen::Map<Rows> j(jacobians[1] + 12 * i);
        j.leftCols<3>() = -h * rig_from_board.rotation * cross(x) * by_board_turn;
        j.rightCols<3>() = h;
      }
    }
    return true;
  }

 private:
  static Eigen::Matrix3d cross(const Eigen::Vector3d& p) {
    Eigen::Matrix3d m;
    m << 0, -p.z(), p.y(), p.z(), 0, -p.x(), -p.y(), p.x(), 0;
    return m;
  }

  std::vector<Eigen::Vector3d> points_;
  Observation seen_;
  std::vector<double> camera_;
};

ceres::CostFunction* make_cost(const View& view, const Camera& camera) {
  ceres::CostFunction* cost = nullptr;
  visit_model(std::string(camera.model()),
              [&]<typename Model>() { cost = new PlacedViewCost<Model>(view, camera); });
  return cost;
}

// One problem, built once; run() solves it from a start near the truth.
class CeresRig {
 public:
  CeresRig(const RigProblem& problem, const RigSolution& truth) {
    scenes::Random random(3);
    const auto near = [&](const SE3& pose) {
      std::vector<double> numbers(6);
      const auto little = [&] { return scenes::uniform(random, -1e-3, 1e-3); };
      Eigen::Map<Eigen::Vector3d>(numbers.data()) =
          log_so3(pose.rotation) + Eigen::Vector3d(little(), little(), little());
      Eigen::Map<Eigen::Vector3d>(numbers.data() + 3) =
          pose.translation + Eigen::Vector3d(little(), little(), little());
      return numbers;
    };
    options_.linear_solver_type = ceres::DENSE_SCHUR;
    options_.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    options_.num_threads = 1;
    options_.max_num_iterations = 100;
    options_.function_tolerance = 1e-12;
    options_.gradient_tolerance = 1e-15;
    options_.parameter_tolerance = 1e-12;
    options_.logging_type = ceres::SILENT;
    std::vector<Camera> cameras;
    for (const RigCamera& camera : truth.rig.cameras) {
      cameras.push_back(Camera::make(camera.calibration).value());
      start_.push_back(near(to_se3(camera.rig_from_camera).inverse()));
    }
    std::fill(start_[0].begin(), start_[0].end(), 0.0);
    // A board is where the first camera of its instant sees it.
    const Instants instants = pair_instants(problem.seen, 10'000'000);
    for (const Instant& instant : instants.instants) {
      const RigView& first = instant.views.front();
      const View& view = problem.seen[first.camera].views[first.view];
      const auto pose = solve_pose(cameras[first.camera], view.board, view.observation);
      if (!pose) continue;
      const SE3 rig_from_camera = to_se3(truth.rig.cameras[first.camera].rig_from_camera);
      start_.push_back(near(rig_from_camera * *pose));
      boards_.push_back({start_.size() - 1, instant});
    }
    values_ = start_;
    ceres::Problem::Options ownership;
    ownership.disable_all_safety_checks = true;
    problem_ = std::make_unique<ceres::Problem>(ownership);
    for (const auto& [board, instant] : boards_) {
      for (const RigView& of : instant.views) {
        problem_->AddResidualBlock(
            make_cost(problem.seen[of.camera].views[of.view], cameras[of.camera]), nullptr,
            values_[of.camera].data(), values_[board].data());
        ++views_;
      }
      options_.linear_solver_ordering->AddElementToGroup(values_[board].data(), 0);
    }
    for (std::size_t c = 0; c < cameras.size(); ++c) {
      options_.linear_solver_ordering->AddElementToGroup(values_[c].data(), 1);
    }
    problem_->SetParameterBlockConstant(values_[0].data());
  }

  // px, root mean square per corner.
  double run() {
    for (std::size_t i = 0; i < values_.size(); ++i) {
      std::copy(start_[i].begin(), start_[i].end(), values_[i].begin());
    }
    ceres::Solver::Summary summary;
    ceres::Solve(options_, problem_.get(), &summary);
    return std::sqrt(2 * summary.final_cost / (summary.num_residuals / 2));
  }
  SE3 camera_from_rig(std::size_t camera) const {
    const double* numbers = values_[camera].data();
    return {exp_so3(Eigen::Vector3d(numbers)), Eigen::Vector3d(numbers + 3)};
  }
  [[nodiscard]] std::size_t views() const { return views_; }

 private:
  struct Board {
    std::size_t block;
    Instant instant;
  };
  std::vector<std::vector<double>> start_;  // the cameras, then the boards
  std::vector<std::vector<double>> values_;
  std::vector<Board> boards_;
  std::unique_ptr<ceres::Problem> problem_;
  ceres::Solver::Options options_;
  std::size_t views_ = 0;
};

// Both end in one place, or their times say nothing.
void check_optimum(const std::string& name, const RigSolution& ours, CeresRig& ceres) {
  const double rms = ceres.run();
  double apart = 0;
  for (std::size_t c = 1; c < ours.rig.cameras.size(); ++c) {
    const SE3 moved = ceres.camera_from_rig(c) * to_se3(ours.rig.cameras[c].rig_from_camera);
    apart = std::max({apart, log_so3(moved.rotation).norm(), moved.translation.norm()});
  }
  std::cout << name << ": " << ceres.views() << " views, rms " << ours.rig.rms.value_or(0)
            << " px, Ceres " << rms << " px, cameras within " << apart << " (rad, m)\n";
  if (!(apart < 1e-6)) std::exit(1);
}

}  // namespace

int main(int argc, char** argv) {
  struct Case {
    int cameras;
    int instants;
  };
  std::vector<std::unique_ptr<RigProblem>> problems;
  std::vector<std::unique_ptr<CeresRig>> peers;
  for (const Case& c : {Case{4, 50}, Case{4, 200}, Case{4, 800}, Case{8, 300}}) {
    const std::string name =
        std::to_string(c.cameras) + " cameras, " + std::to_string(c.instants) + " instants";
    problems.push_back(std::make_unique<RigProblem>(make_problem(c.cameras, c.instants)));
    const RigProblem& problem = *problems.back();
    const auto solved = solve_rig(problem.seen);
    if (!solved) {
      std::cerr << solved.error().message << '\n';
      return 1;
    }
    peers.push_back(std::make_unique<CeresRig>(problem, *solved));
    CeresRig& peer = *peers.back();
    check_optimum(name, *solved, peer);
    benchmark::RegisterBenchmark((name + "|calvin").c_str(), [&problem](benchmark::State& state) {
      for (auto _ : state) benchmark::DoNotOptimize(solve_rig(problem.seen).has_value());
    });
    benchmark::RegisterBenchmark((name + "|Ceres").c_str(), [&peer](benchmark::State& state) {
      for (auto _ : state) benchmark::DoNotOptimize(peer.run());
    });
  }
  bench::initialize_interleaved(argc, argv, 5);
  bench::RatioReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  return 0;
}
