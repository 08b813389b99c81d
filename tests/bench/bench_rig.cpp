// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where the cameras of a rig stand, from observations: ours from nothing to the covariances, beside
// Ceres, which gets a start near the truth and refines it: a cost function per view with analytic
// derivatives by two poses, boards eliminated first. "the fit alone" is ours from the same start:
// robust, then without what contradicts the rest, to the covariances. Intrinsics are known. One
// thread. With `--large`: ours alone, 64 cameras and 1000 instants, and how its time grows with the
// instants.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <iostream>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <sys/resource.h>

#include <benchmark/benchmark.h>
#include <ceres/ceres.h>

#include "calvin/rig/board_views.hpp"
#include "calvin/rig/joint/rig_fit.hpp"
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

  // Where run() starts, as ours takes it.
  [[nodiscard]] rig::RigPlaces start(const std::vector<rig::BoardView>& views,
                                     std::size_t cameras) const {
    const auto motion = [&](std::size_t block) {
      const double* numbers = start_[block].data();
      return SE3{exp_so3(Eigen::Vector3d(numbers)), Eigen::Vector3d(numbers + 3)};
    };
    rig::RigPlaces places;
    for (std::size_t c = 0; c < cameras; ++c) places.camera_from_rig.push_back(motion(c));
    for (const auto& [block, instant] : boards_) {
      for (const auto& group : rig::group_views({{instant}, 0}, views)) {
        for (const std::size_t v : group) {
          places.views.push_back({v, places.rig_from_board.size(), SE3()});
        }
      }
      places.rig_from_board.push_back(motion(block));
    }
    return places;
  }

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

// Ours from where Ceres starts.
class FitAlone {
 public:
  FitAlone(const RigProblem& problem, const RigSolution& solved, const CeresRig& peer)
      : seen_(problem.seen) {
    for (const RigCamera& camera : solved.rig.cameras) {
      cameras_.push_back(Camera::make(camera.calibration).value());
    }
    views_ = rig::board_views(seen_, cameras_).value();
    start_ = peer.start(views_, cameras_.size());
  }
  [[nodiscard]] rig::RigFit run() const {
    return rig::fit_rig(views_, start_, seen_, cameras_, {}, {}).value();
  }

 private:
  const std::vector<RigCameraViews>& seen_;
  std::vector<Camera> cameras_;
  std::vector<rig::BoardView> views_;
  rig::RigPlaces start_;
};

// All end in one place, or their times say nothing.
void check_optimum(const std::string& name, const RigSolution& ours, const rig::RigFit& fit,
                   CeresRig& ceres) {
  const double rms = ceres.run();
  double apart = 0;
  for (std::size_t c = 1; c < ours.rig.cameras.size(); ++c) {
    const SE3 moved = ceres.camera_from_rig(c) * to_se3(ours.rig.cameras[c].rig_from_camera);
    const SE3 alone = fit.places.camera_from_rig[c] * to_se3(ours.rig.cameras[c].rig_from_camera);
    for (const SE3& motion : {moved, alone}) {
      apart = std::max({apart, log_so3(motion.rotation).norm(), motion.translation.norm()});
    }
  }
  std::cout << name << ": " << ceres.views() << " views, rms " << ours.rig.rms.value_or(0)
            << " px, Ceres " << rms << " px, cameras within " << apart << " (rad, m)\n";
  if (!(apart < 1e-6)) std::exit(1);
}

using SeenViews = std::vector<RigCameraViews>;

// s of one thread.
double seconds_of(const SeenViews& seen) {
  const std::clock_t from = std::clock();
  if (!solve_rig(seen)) return -1;
  return static_cast<double>(std::clock() - from) / CLOCKS_PER_SEC;
}

// The views of so many parts of the time that all took.
std::vector<SeenViews> parts_of(const SeenViews& all, std::size_t parts) {
  std::uint64_t end = 0;
  for (const RigCameraViews& camera : all) {
    end = std::max(end, camera.views.back().observation.timestamp + 1);
  }
  std::vector<SeenViews> split(parts);
  for (SeenViews& part : split) {
    for (const RigCameraViews& camera : all) part.push_back({camera.calibration, {}});
  }
  for (std::size_t c = 0; c < all.size(); ++c) {
    for (const View& view : all[c].views) {
      split[view.observation.timestamp * parts / end][c].views.push_back(view);
    }
  }
  return split;
}

// One long recording, as a whole and in parts: the same views each time, so that caches are as cold
// for a part as for the whole. The least of a few rounds.
void show_growth() {
  constexpr int kRounds = 5;
  constexpr int kInstants = 4000;
  const SeenViews all = make_problem(4, kInstants).seen;
  double whole = 0;
  for (const std::size_t parts : {1, 4, 16}) {
    const std::vector<SeenViews> split = parts_of(all, parts);
    double least = 1e9;
    for (int round = 0; round < kRounds; ++round) {
      double sum = 0;
      for (const SeenViews& part : split) sum += seconds_of(part);
      least = std::min(least, sum / static_cast<double>(parts));
    }
    std::cout << "4 cameras, " << kInstants / parts << " instants: " << 1e3 * least << " ms";
    if (parts > 1) {
      std::cout << ", from there to the whole as N^"
                << std::log(whole / least) / std::log(static_cast<double>(parts));
    }
    std::cout << '\n';
    if (parts == 1) whole = least;
  }
}

double peak_megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  constexpr double kKilobytes = 1024;  // in a megabyte; Linux counts kilobytes
  return static_cast<double>(usage.ru_maxrss) / kKilobytes;
}

int solve_large() {
  show_growth();
  const RigProblem problem = make_problem(64, 1000);
  std::size_t views = 0;
  for (const RigCameraViews& camera : problem.seen) views += camera.views.size();
  const double without = peak_megabytes();
  const double seconds = seconds_of(problem.seen);
  std::cout << "64 cameras, 1000 instants, " << views << " views: " << seconds << " s, "
            << peak_megabytes() << " MB at the most, of which " << without << " MB are the views\n";
  return seconds >= 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && std::string_view(argv[1]) == "--large") return solve_large();
  struct Case {
    int cameras;
    int instants;
  };
  std::vector<std::unique_ptr<RigProblem>> problems;
  std::vector<std::unique_ptr<CeresRig>> peers;
  std::vector<std::unique_ptr<FitAlone>> fits;
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
    fits.push_back(std::make_unique<FitAlone>(problem, *solved, peer));
    const FitAlone& fit = *fits.back();
    check_optimum(name, *solved, fit.run(), peer);
    benchmark::RegisterBenchmark((name + "|calvin").c_str(), [&problem](benchmark::State& state) {
      for (auto _ : state) benchmark::DoNotOptimize(solve_rig(problem.seen).has_value());
    });
    benchmark::RegisterBenchmark((name + "|calvin, the fit alone").c_str(),
                                 [&fit](benchmark::State& state) {
                                   for (auto _ : state) benchmark::DoNotOptimize(fit.run().rms);
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
