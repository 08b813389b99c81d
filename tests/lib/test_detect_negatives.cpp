// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Pictures without the board, and boards in the midst of what looks like one.
#include <algorithm>
#include <cmath>
#include <iostream>

#include <gtest/gtest.h>

#include "calvin/detect/detector.hpp"
#include "calvin/synth/render.hpp"
#include "detect_scenes.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

ImageView view_of(const cv::Mat& image) {
  return {image.data, image.cols, image.rows, static_cast<std::ptrdiff_t>(image.step[0]), 1};
}

// Clutter, tiles, textiles, text, keys and boards of other sizes.
TEST(Negatives, HaveNoBoard) {
  const auto finder = std::move(*make_detector(scenes::kBoard));
  const bool full = scenes::full_count();
  const ImageSize size = full ? ImageSize{1920, 1080} : ImageSize{800, 600};
  for (std::uint64_t seed = 0; seed < (full ? 1200 : 72); ++seed) {
    const Detection d = finder->detect(view_of(bench::make_negative(size, 5000 + seed)));
    EXPECT_FALSE(d.observation.found()) << seed;
  }
}

// A floor of tiles is a board far too large; the board that lies on it is still one.
TEST(Boards, AreFoundOnACheckeredFloor) {
  const auto finder = std::move(*make_detector(scenes::kBoard));
  const Camera camera = default_camera({1280, 720});
  const BoardRenderer renderer(camera);
  const int images = scenes::full_count() ? 100 : 8;
  scenes::Random random(6);
  int found = 0;
  for (int n = 0; n < images; ++n) {
    const double tile = scenes::uniform(random, 0.04, 0.15);
    const Board floor = {BoardKind::kCheckerboard, 40, 30, tile};
    const SE3 at = {
        exp_so3({scenes::uniform(random, -0.4, 0.4), 0.2, scenes::uniform(random, 0, 1)}),
        {-20 * tile, -15 * tile, 1.2}};
    const SE3 pose = scenes::random_pose(camera, scenes::kBoard, random, 0.4);
    GrayImage image =
        renderer.render(floor, at, {.noise = 2, .blur = 0.8, .dark = 60, .light = 170});
    const GrayImage on_black = renderer.render(
        scenes::kBoard, pose, {.noise = 2, .blur = 0.8, .seed = 1, .background = 0});
    const GrayImage on_white = renderer.render(
        scenes::kBoard, pose, {.noise = 2, .blur = 0.8, .seed = 1, .background = 255});
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
      if (on_white.pixels[i] - on_black.pixels[i] < 128) image.pixels[i] = on_black.pixels[i];
    }
    const Observation o = finder->detect(image.view()).observation;
    const Observation truth = true_observation(camera, scenes::kBoard, pose);
    for (std::size_t i = 0; i < o.uv.size() && o.ids == truth.ids; ++i) {
      EXPECT_LT(std::hypot(o.uv[i].u - truth.uv[i].u, o.uv[i].v - truth.uv[i].v), 0.2);
    }
    found += o.ids == truth.ids ? 1 : 0;
  }
  std::cout << "  " << found << " of " << images << '\n';
  EXPECT_GE(found, images * 95 / 100);
}

}  // namespace
}  // namespace calvin
