// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The calibration of one camera from the corners of a 9x6 board, ours beside its peers, one thread.
// Ours and OpenCV's take the corners alone and give a camera with its uncertainty (ours) or without
// (OpenCV's). Ceres and mrcal take a start near the truth besides, and give no uncertainty.
// "calvin" is that alone; with "all checks" it looks for outliers, judges the views and makes the
// promise too, as elements have it, of a board that is flat or one whose warp is estimated.
// After the times: how far each end is from ours.
#include <cstdio>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>
#include <ceres/version.h>
#include <fmt/format.h>
#include <opencv2/core/version.hpp>

#include "calvin/solve/solve.hpp"
#include "plain_options.hpp"
#include "ratio_reporter.hpp"
#include "solve_cancel.hpp"
#include "solve_ceres.hpp"
#if BENCH_HAVE_MRCAL
#include "solve_mrcal.hpp"
#endif
#include "solve_opencv.hpp"
#include "solve_problem.hpp"

namespace bench {
namespace {

struct Outcome {
  std::string subject;
  Fitted fitted;
};

// Everything measured on one problem.
struct Case {
  std::string name;
  Problem problem;
  calvin::Calibration ours;
  std::vector<Outcome> outcomes;
};

constexpr const char* kFlat = "calvin, all checks, flat";
constexpr const char* kWarped = "calvin, all checks, warp";
constexpr const char* kCeres = "Ceres DENSE_SCHUR";

calvin::SolveOptions checked_options(const Problem& problem, bool warp) {
  calvin::SolveOptions options;
  options.model = problem.model;
  options.warp = warp;
  return options;
}

calvin::Calibration calibrate(const Problem& problem, const calvin::SolveOptions& options) {
  auto solution = calvin::solve(problem.views, kSize, options);
  return solution ? std::move(solution->calibration) : calvin::Calibration();
}

Fitted fitted_of(const calvin::Calibration& calibration) {
  Fitted fitted;
  for (const calvin::Parameter& p : calibration.parameters) fitted.intrinsics.push_back(p.value);
  for (const calvin::ViewRecord& view : calibration.views) {
    fitted.camera_from_board.push_back(calvin::to_se3(view.camera_from_board));
  }
  return fitted;
}

void add(Case& c, const std::string& subject, std::function<Fitted()> run) {
  benchmark::RegisterBenchmark((c.name + "|" + subject).c_str(), [&c, subject,
                                                                  run = std::move(run)](
                                                                     benchmark::State& state) {
    Fitted fitted;
    for (auto _ : state) {
      try {
        fitted = run();
      } catch (const std::exception& error) {
        state.SkipWithError(error.what());
        return;
      }
    }
    std::erase_if(c.outcomes, [&](const Outcome& o) { return o.subject == subject; });
    c.outcomes.push_back({subject, std::move(fitted)});
  })->Unit(benchmark::kMillisecond);
}

void register_case(Case& c, const std::string& model, int views) {
  c.name = fmt::format("{} {} views", model, views);
  c.problem = make_problem(model, views);
  const Problem& problem = c.problem;
  add(c, "calvin", [&c] {
    c.ours = calibrate(c.problem, calvin::scenes::plain_options(c.problem.model));
    return Fitted();
  });
  for (const bool warp : {false, true}) {
    add(c, warp ? kWarped : kFlat,
        [&c, warp] { return fitted_of(calibrate(c.problem, checked_options(c.problem, warp))); });
  }
  const auto ceres = [&](const char* name, ceres::LinearSolverType type) {
    add(c, name, [solver = std::make_shared<Ceres>(problem, type)] { return solver->run(); });
  };
  ceres(kCeres, ceres::DENSE_SCHUR);
  ceres("Ceres SPARSE_SCHUR", ceres::SPARSE_SCHUR);
  const auto opencv = std::make_shared<OpenCv>(problem);
  if (model == "fisheye") {
    add(c, "cv::fisheye", [opencv] { return opencv->fisheye(); });
    return;
  }
#if BENCH_HAVE_MRCAL
  add(c, "mrcal OPENCV5", [solver = std::make_shared<Mrcal>(problem)] { return solver->run(); });
#endif
  // Their time grows with a power of the views above 2.
  if (views <= 400) add(c, "cv USE_LU", [opencv] { return opencv->brown5(cv::CALIB_USE_LU); });
  if (views <= 100) add(c, "cv default", [opencv] { return opencv->brown5(0); });
}

// What all checks cost beside a peer's bare fit, and the growth of our own time from one number of
// views to another, as a power of it.
class Reporter : public RatioReporter {
 public:
  explicit Reporter(const std::vector<Case>& cases) : cases_(cases) {}

  void Finalize() override {
    RatioReporter::Finalize();
    std::printf("\n");
    for (const Case& c : cases_) {
      for (const char* subject : {kFlat, kWarped}) {
        const Spread ratio = ratio_of(c.name, kCeres, subject);
        if (std::isnan(ratio.median)) continue;
        std::printf("%s: %s takes %.2f (%.2f .. %.2f) times as long as %s\n", c.name.c_str(),
                    kCeres, ratio.median, ratio.least, ratio.most, subject);
      }
    }
    const double growth = our_median("brown5 1000 views") / our_median("brown5 25 views");
    if (std::isnan(growth)) return;
    std::printf("\ncalvin, brown5: time grows as N^%.3f from 25 to 1000 views\n",
                std::log(growth) / std::log(40.0));
  }

 private:
  const std::vector<Case>& cases_;
};

void print_agreement(const std::vector<Case>& cases) {
  fmt::print("\n{:<20} {:<20} {:>16} {:>20}\n", "case", "subject", "cost - ours, rel.",
             "parameters, sigma");
  for (const Case& c : cases) {
    if (c.ours.parameters.empty()) continue;  // not run
    const auto ours = cost_of(c.problem, fitted_of(c.ours));
    for (const Outcome& o : c.outcomes) {
      if (o.subject.starts_with("calvin")) continue;
      const auto theirs = cost_of(c.problem, o.fitted);
      double sigmas = 0;
      for (std::size_t i = 0; i < o.fitted.intrinsics.size(); ++i) {
        const calvin::Parameter& p = c.ours.parameters.at(i);
        sigmas = std::max(sigmas, std::abs(o.fitted.intrinsics[i] - p.value) / p.sigma.value_or(1));
      }
      const std::string cost = ours && theirs ? fmt::format("{:.1e}", *theirs / *ours - 1) : "-";
      fmt::print("{:<20} {:<20} {:>16} {:>20.1e}\n", c.name, o.subject, cost, sigmas);
    }
  }
}

}  // namespace
}  // namespace bench

int main(int argc, char** argv) {
  constexpr int kRuns = 5;  // the longest take half a minute each
  bench::initialize_interleaved(argc, argv, kRuns);
  cv::setNumThreads(1);
  const std::vector<std::pair<std::string, int>> kinds = {
      {"brown5", 5},   {"brown5", 10},   {"brown5", 25},  {"brown5", 100},
      {"brown5", 400}, {"brown5", 1000}, {"fisheye", 25}, {"fisheye", 400}};
  std::vector<bench::Case> cases(kinds.size());
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    bench::register_case(cases[i], kinds[i].first, kinds[i].second);
  }
  bench::Reporter reporter(cases);
  benchmark::RunSpecifiedBenchmarks(&reporter);
  bench::print_agreement(cases);
  fmt::print("\n");
  for (const bench::Case& c : cases) {
    if (c.outcomes.empty()) continue;
    fmt::print("{}: ends at most {:.1f} ms after it is told to stop\n", c.name,
               bench::longest_stop(c.problem));
  }
#if BENCH_HAVE_MRCAL
  const std::string mrcal = bench::Mrcal::library();
#else
  const std::string mrcal = "no mrcal";
#endif
  fmt::print("\nOpenCV {}, Ceres {}, {}\n", CV_VERSION, CERES_VERSION_STRING, mrcal);
  return 0;
}
