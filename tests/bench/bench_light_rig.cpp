// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Cameras around a room and where a light was in it: ours from what the cameras have seen,
// reflections among it, to the covariances; beside Ceres, which gets a start near the end and only
// the sightings that ours has found to be none: the same bundle adjustment with analytic
// derivatives, positions of the light eliminated first. One thread.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <ceres/ceres.h>

#include "calvin/camera/models.hpp"
#include "calvin/rig/solve_light.hpp"
#include "ratio_reporter.hpp"
#include "simulated_light.hpp"
#include "solve_ceres.hpp"

namespace {

using namespace calvin;

using Brown = Model<lens::Brown4>;
using Lens = std::array<double, 5>;      // f cx cy k1 k2
using Numbers = std::array<double, 6>;   // a Rodrigues vector and a translation
using Position = std::array<double, 3>;  // of the light

// Residuals u v of one sighting; parameter blocks: lens, camera_from_rig, position.
class SightingCost : public ceres::SizedCostFunction<2, 5, 6, 3> {
 public:
  SightingCost(Pixel seen, double sigma) : seen_(seen), weight_(1 / sigma) {}

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const double* lens = parameters[0];
    const double camera[Brown::kCount] = {lens[0], lens[0], lens[1], lens[2], lens[3], lens[4]};
    const Eigen::Vector3d turn(parameters[1]);
    const Eigen::Matrix3d rotation = exp_so3(turn);
    const Eigen::Vector3d at(parameters[2]);
    double uv[2];
    double by_point[6];
    double by_camera[2 * Brown::kCount];
    const Eigen::Vector3d in_camera = rotation * at + Eigen::Vector3d(parameters[1] + 3);
    if (!Brown::project(camera, 0, in_camera, uv, by_point, by_camera)) return false;
    residuals[0] = weight_ * (uv[0] - seen_.u);
    residuals[1] = weight_ * (uv[1] - seen_.v);
    if (jacobians == nullptr) return true;
    const Eigen::Map<const Eigen::Matrix<double, 2, 3, Eigen::RowMajor>> g(by_point);
    if (jacobians[0] != nullptr) {
      for (int row = 0; row < 2; ++row) {
        const double* from = by_camera + row * Brown::kCount;
        double* to = jacobians[0] + row * 5;
        to[0] = weight_ * (from[0] + from[1]);
        for (int k = 1; k < 5; ++k) to[k] = weight_ * from[k + 1];
      }
    }
    if (jacobians[1] != nullptr) {
      Eigen::Matrix3d cross;
      cross << 0, -at.z(), at.y(), at.z(), 0, -at.x(), -at.y(), at.x(), 0;
      Eigen::Map<Eigen::Matrix<double, 2, 6, Eigen::RowMajor>> j(jacobians[1]);
      j.leftCols<3>() = -weight_ * g * rotation * cross * bench::right_jacobian(turn);
      j.rightCols<3>() = weight_ * g;
    }
    if (jacobians[2] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 2, 3, Eigen::RowMajor>> j(jacobians[2]);
      j = weight_ * g * rotation;
    }
    return true;
  }

 private:
  Pixel seen_;
  double weight_;
};

// What is known of an axis.
class CenterCost : public ceres::SizedCostFunction<2, 5> {
 public:
  CenterCost(Pixel center, double sigma) : center_(center), weight_(1 / sigma) {}

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    residuals[0] = weight_ * (parameters[0][1] - center_.u);
    residuals[1] = weight_ * (parameters[0][2] - center_.v);
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    std::fill_n(jacobians[0], 10, 0.0);
    jacobians[0][1] = jacobians[0][5 + 2] = weight_;
    return true;
  }

 private:
  Pixel center_;
  double weight_;
};

// One problem, built once; run() solves it from a start near the solution.
class CeresRoom {
 public:
  CeresRoom(const std::vector<LightCamera>& seen, const LightSolution& solved) {
    set_start(solved);
    values_ = start_;
    ceres::Problem::Options ownership;
    ownership.disable_all_safety_checks = true;
    problem_ = std::make_unique<ceres::Problem>(ownership);
    auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    for (std::size_t c = 0; c < seen.size(); ++c) {
      for (std::size_t i = 0; i < seen[c].seen.size(); ++i) {
        if (!solved.used[c][i]) continue;
        problem_->AddResidualBlock(new SightingCost(seen[c].seen[i]->uv, seen[c].seen[i]->sigma),
                                   nullptr, values_.lenses[c].data(), values_.poses[c].data(),
                                   values_.positions[i].data());
        ++sightings_;
      }
      const double sigma = LightOptions().center_sigma * seen[c].image_size.width;
      problem_->AddResidualBlock(
          new CenterCost(image_center(seen[c].image_size), sigma / solved.sigma_factor), nullptr,
          values_.lenses[c].data());
      ordering->AddElementToGroup(values_.lenses[c].data(), 1);
      ordering->AddElementToGroup(values_.poses[c].data(), 1);
    }
    for (std::size_t i = 0; i < solved.points.size(); ++i) {
      if (solved.points[i]) ordering->AddElementToGroup(values_.positions[i].data(), 0);
    }
    hold_frame();
    options_.linear_solver_type = ceres::DENSE_SCHUR;
    options_.linear_solver_ordering = ordering;
    options_.num_threads = 1;
    options_.max_num_iterations = 100;
    options_.function_tolerance = 1e-12;
    options_.gradient_tolerance = 1e-15;
    options_.parameter_tolerance = 1e-12;
    options_.logging_type = ceres::SILENT;
  }

  void run() {
    // The blocks stay where they are.
    std::ranges::copy(start_.lenses, values_.lenses.begin());
    std::ranges::copy(start_.poses, values_.poses.begin());
    std::ranges::copy(start_.positions, values_.positions.begin());
    ceres::Solver::Summary summary;
    ceres::Solve(options_, problem_.get(), &summary);
  }
  [[nodiscard]] double focal(std::size_t camera) const { return values_.lenses[camera][0]; }
  [[nodiscard]] std::size_t sightings() const { return sightings_; }

 private:
  struct Values {
    std::vector<Lens> lenses;
    std::vector<Numbers> poses;
    std::vector<Position> positions;
  };

  void set_start(const LightSolution& solved) {
    constexpr double kOff = 2e-3;  // rad, and of the length of the rig
    scenes::Random random(3);
    const auto little = [&] { return scenes::uniform(random, -kOff, kOff); };
    for (const RigCamera& camera : solved.rig.cameras) {
      const auto& p = camera.calibration.parameters;
      start_.lenses.push_back({p[0].value * (1 + 5 * little()), p[2].value, p[3].value,
                               p[4].value + little(), p[5].value});
      const SE3 pose = to_se3(camera.rig_from_camera).inverse();
      const Eigen::Vector3d turn = log_so3(pose.rotation);
      Numbers& numbers = start_.poses.emplace_back();
      for (int k = 0; k < 3; ++k) {
        numbers[static_cast<std::size_t>(k)] = turn[k] + little();
        numbers[static_cast<std::size_t>(k + 3)] = pose.translation[k] + little();
      }
    }
    start_.poses.front() = {};
    for (const auto& point : solved.points) {
      const auto at = point.value_or(Position{});
      start_.positions.push_back({at[0] + little(), at[1] + little(), at[2] + little()});
    }
  }

  // The first camera is the rig, and one number of the one farthest from it the unit.
  void hold_frame() {
    problem_->SetParameterBlockConstant(values_.poses.front().data());
    const auto distance = [](const Numbers& pose) { return std::hypot(pose[3], pose[4], pose[5]); };
    Numbers& farthest = *std::ranges::max_element(values_.poses, {}, distance);
    int largest = 3;
    for (int k = 4; k < 6; ++k) {
      if (std::abs(farthest[static_cast<std::size_t>(k)]) >
          std::abs(farthest[static_cast<std::size_t>(largest)])) {
        largest = k;
      }
    }
    problem_->SetManifold(farthest.data(), new ceres::SubsetManifold(6, {largest}));
  }

  Values start_;
  Values values_;
  std::unique_ptr<ceres::Problem> problem_;
  ceres::Solver::Options options_;
  std::size_t sightings_ = 0;
};

// Both end in one place, or their times say nothing: focal lengths do not depend on the unit.
void check_optimum(const std::string& name, const LightSolution& ours, CeresRoom& ceres) {
  ceres.run();
  double apart = 0;
  for (std::size_t c = 0; c < ours.rig.cameras.size(); ++c) {
    const double f = ours.rig.cameras[c].calibration.parameters.front().value;
    apart = std::max(apart, std::abs(ceres.focal(c) / f - 1));
  }
  std::cout << name << ": " << ceres.sightings() << " sightings, rms " << ours.rig.rms.value_or(0)
            << " px, focal lengths within " << apart << " of Ceres'\n";
  if (!(apart < 1e-5)) std::exit(1);
}

}  // namespace

int main(int argc, char** argv) {
  struct Case {
    int cameras;
    int positions;
  };
  std::vector<std::unique_ptr<std::vector<LightCamera>>> problems;
  std::vector<std::unique_ptr<CeresRoom>> peers;
  for (const Case& c : {Case{4, 300}, Case{4, 1000}, Case{16, 1000}}) {
    const std::string name =
        std::to_string(c.cameras) + " cameras, " + std::to_string(c.positions) + " positions";
    scenes::Random random(9);
    const scenes::LitRoom room = scenes::lit_room(c.cameras, random);
    problems.push_back(std::make_unique<std::vector<LightCamera>>(
        scenes::see_lights(room, scenes::lights_in(room, c.positions, random), random)));
    const std::vector<LightCamera>& seen = *problems.back();
    const auto solved = solve_light(seen);
    if (!solved) {
      std::cerr << solved.error().message << '\n';
      return 1;
    }
    peers.push_back(std::make_unique<CeresRoom>(seen, *solved));
    CeresRoom& peer = *peers.back();
    check_optimum(name, *solved, peer);
    benchmark::RegisterBenchmark((name + "|calvin").c_str(), [&seen](benchmark::State& state) {
      for (auto _ : state) benchmark::DoNotOptimize(solve_light(seen).has_value());
    });
    benchmark::RegisterBenchmark((name + "|Ceres").c_str(), [&peer](benchmark::State& state) {
      for (auto _ : state) {
        peer.run();
        benchmark::ClobberMemory();
      }
    });
  }
  bench::initialize_interleaved(argc, argv, 5);
  bench::RatioReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  return 0;
}
