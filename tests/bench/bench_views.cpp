// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Views other than the plain one, GRAY8 of 1080p on one thread: our kernels beside cv::remap with
// a 16SC2 map of the same view.

#include <memory>
#include <string>
#include <vector>

#include <hwy/highway.h>
#include <opencv2/imgproc.hpp>

#include "calvin/remap/undistorter.hpp"
#include "ratio_reporter.hpp"
#include "remap_reference.hpp"

namespace {

using namespace calvin;
using reference::view_of;

constexpr ImageSize kSource = {1920, 1080};
constexpr int kFrames = 4;  // so that the next one is not in the nearest cache

struct NamedView {
  const char* name;
  bool fisheye;
  ViewOptions options;
};

ViewOptions projected(Projection projection) {
  ViewOptions options;
  options.projection = projection;
  return options;
}

const std::vector<NamedView> kViews = {
    {"alpha 0", false, view_of(0, 1, 0)},
    {"alpha 1", false, view_of(1, 1, 0)},
    {"zoom 2", false, view_of(0, 2, 0)},
    {"roll 20 degrees", false, view_of(0, 1, 0.35)},
    {"roll 90 degrees", false, view_of(0, 1, 1.5708)},
    {"960x540", false, view_of(0, 1, 0, {960, 540})},
    {"480x270", false, view_of(0, 1, 0, {480, 270})},
    {"fisheye", true, view_of(0, 1, 0)},
    {"fisheye, alpha 1", true, view_of(1, 1, 0)},
    {"fisheye, cylindrical", true, projected(Projection::kCylindrical)},
    {"fisheye, Panini", true, projected(Projection::kPanini)},
};

Camera camera_of(bool fisheye) {
  const double f = (fisheye ? 0.33 : 0.6) * kSource.width;
  std::vector<double> p = {f, 1.002 * f, kSource.width / 2.0 + 6.8, kSource.height / 2.0 - 4.6};
  if (fisheye) {
    p.insert(p.end(), {-0.02, 0.003, -0.001, 0});
  } else {
    p.insert(p.end(), {-0.3, 0.1, 0.0005, -0.0003, -0.01});
  }
  return Camera::make(fisheye ? "fisheye" : "brown5", kSource, p).value();
}

struct Pictures {
  explicit Pictures(const NamedView& view)
      : undistorter(
            Undistorter::make(camera_of(view.fisheye), view.options, {PlaneLayout{}}).value()) {
    const ImageSize size = undistorter.output().image_size();
    cv::RNG random(1);
    for (int i = 0; i < kFrames; ++i) {
      cv::Mat noise(kSource.height, kSource.width, CV_8U);
      random.fill(noise, cv::RNG::UNIFORM, 0, 256);
      cv::GaussianBlur(noise, noise, {5, 5}, 0);
      inputs.push_back(noise);
      outputs.emplace_back(size.height, size.width, CV_8U, cv::Scalar(1));
    }
  }
  Undistorter undistorter;
  std::vector<cv::Mat> inputs;
  std::vector<cv::Mat> outputs;
};

void ours(benchmark::State& state, Pictures& pictures, std::int64_t disabled) {
  hwy::DisableTargets(disabled);
  std::size_t n = 0;
  for (auto _ : state) {
    const cv::Mat& in = pictures.inputs[n % kFrames];
    cv::Mat& out = pictures.outputs[n++ % kFrames];
    pictures.undistorter.apply(0, {in.data, static_cast<std::ptrdiff_t>(in.step)},
                               {out.data, static_cast<std::ptrdiff_t>(out.step)});
  }
  hwy::DisableTargets(0);
}

void opencv(benchmark::State& state, Pictures& pictures) {
  const cv::Mat& like = pictures.outputs.front();
  cv::Mat places(like.size(), CV_32FC2, cv::Scalar(-9, -9));
  for (int y = 0; y < places.rows; ++y) {
    for (int x = 0; x < places.cols; ++x) {
      const auto place = pictures.undistorter.to_source({1.0 * x, 1.0 * y});
      if (place) places.at<cv::Vec2f>(y, x) = cv::Vec2d(place->u, place->v);
    }
  }
  cv::Mat whole;
  cv::Mat rest;
  cv::convertMaps(places, cv::Mat(), whole, rest, CV_16SC2);
  std::size_t n = 0;
  for (auto _ : state) {
    cv::remap(pictures.inputs[n % kFrames], pictures.outputs[n % kFrames], whole, rest,
              cv::INTER_LINEAR);
    ++n;
  }
}

}  // namespace

int main(int argc, char** argv) {
  bench::initialize_interleaved(argc, argv);
  cv::setNumThreads(1);
  for (const NamedView& view : kViews) {
    const auto pictures = std::make_shared<Pictures>(view);
    const auto add = [&](const char* subject, auto run) {
      benchmark::RegisterBenchmark(
          (std::string(view.name) + "|" + subject).c_str(),
          [pictures, run](benchmark::State& state) { run(state, *pictures); })
          ->Unit(benchmark::kMillisecond);
    };
    add("calvin", [](auto& state, Pictures& p) { ours(state, p, 0); });
#if HWY_ARCH_X86
    // Bits below that of AVX2 are of later instructions.
    add("calvin, AVX2", [](auto& state, Pictures& p) { ours(state, p, HWY_AVX2 - 1); });
    add("calvin, 128 bit", [](auto& state, Pictures& p) { ours(state, p, HWY_SSE4 - 1); });
#endif
    add("cv::remap, 16SC2", opencv);
  }
  bench::RatioReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  return 0;
}
