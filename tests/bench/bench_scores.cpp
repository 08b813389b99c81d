// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What each of 250 views would add to ten that are kept: ours by the information of each, beside
// OpenCV, whose calibrateCamera() tells standard deviations of what it has solved, with
// each of them in turn. brown5, one thread.

#include <cstddef>
#include <optional>
#include <vector>

#include <benchmark/benchmark.h>
#include <opencv2/calib3d.hpp>

#include "calvin/solve/view_information.hpp"
#include "ratio_reporter.hpp"
#include "scenes.hpp"

namespace {

using namespace calvin;

constexpr std::size_t kKept = 10;
constexpr std::size_t kViews = 250;

struct Views {
  Views() {
    scenes::Random random(5);
    camera = scenes::random_camera("brown5", random);
    poses = scenes::random_poses(*camera, scenes::kBoard, random, kKept + kViews);
    for (const SE3& pose : poses) {
      views.push_back(scenes::observe(*camera, scenes::kBoard, pose, 0.1, random));
    }
  }
  std::optional<Camera> camera;
  std::vector<SE3> poses;
  std::vector<View> views;
};

const Views& the_views() {
  static const Views kAll;
  return kAll;
}

void ours(benchmark::State& state) {
  const Views& all = the_views();
  const ViewScorer scorer = ViewScorer::make(*all.camera, {}).value();
  Eigen::MatrixXd known = scorer.prior();
  for (std::size_t i = 0; i < kKept; ++i) {
    known += scorer.information(all.views[i], all.poses[i]).value();
  }
  for (auto _ : state) {
    for (std::size_t i = kKept; i < all.views.size(); ++i) {
      const auto information = scorer.information(all.views[i], all.poses[i]);
      double variance = scorer.variance(known + information.value());
      benchmark::DoNotOptimize(variance);
    }
  }
}

void opencv(benchmark::State& state) {
  const Views& all = the_views();
  std::vector<cv::Point3f> board;
  for (const Eigen::Vector3d& p : scenes::kBoard.points()) {
    board.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()), 0.0F);
  }
  std::vector<std::vector<cv::Point2f>> corners;
  for (const View& view : all.views) {
    auto& of = corners.emplace_back();
    for (const Pixel& p : view.observation.uv) {
      of.emplace_back(static_cast<float>(p.u), static_cast<float>(p.v));
    }
  }
  const std::vector<std::vector<cv::Point3f>> boards(kKept + 1, board);
  std::vector<std::vector<cv::Point2f>> seen(corners.begin(), corners.begin() + kKept + 1);
  for (auto _ : state) {
    for (std::size_t i = kKept; i < corners.size(); ++i) {
      seen.back() = corners[i];
      cv::Mat k;
      cv::Mat d;
      cv::Mat sigmas;
      cv::calibrateCamera(boards, seen, {scenes::kSize.width, scenes::kSize.height}, k, d,
                          cv::noArray(), cv::noArray(), sigmas, cv::noArray(), cv::noArray());
      benchmark::DoNotOptimize(sigmas.data);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  bench::initialize_interleaved(argc, argv, 5);
  cv::setNumThreads(1);
  benchmark::RegisterBenchmark("250 views|calvin", ours)->Unit(benchmark::kMillisecond);
  benchmark::RegisterBenchmark("250 views|OpenCV, solved", opencv)->Unit(benchmark::kMillisecond);
  bench::RatioReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  return 0;
}
