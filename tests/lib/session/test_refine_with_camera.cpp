// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Corners that are refined with the camera in their patches, on rendered boards, whose corners are
// known.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/detect/detector.hpp"
#include "calvin/detect/patches.hpp"
#include "calvin/session/refine_with_camera.hpp"
#include "calvin/synth/motion.hpp"
#include "calvin/synth/render.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

struct Picture {
  SE3 pose;
  View view;  // as it was detected, with patches
  Observation truth;
};

struct Album {
  Camera camera;
  std::vector<Picture> pictures;

  [[nodiscard]] std::vector<View> views() const {
    std::vector<View> views;
    for (const Picture& p : pictures) views.push_back(p.view);
    return views;
  }
};

Album make_album(const Camera& camera, int count, const Board& board = scenes::kBoard) {
  Album album = {camera, {}};
  scenes::Random random(3);
  const BoardRenderer renderer(camera);
  const auto detector = make_detector(board).value();
  for (int i = 0; static_cast<int>(album.pictures.size()) < count; ++i) {
    Picture p;
    p.pose = scenes::random_pose(camera, board, random, scenes::uniform(random, 0, 0.7));
    RenderOptions options;
    options.noise = 2;
    options.blur = 1;
    options.seed = static_cast<std::uint64_t>(i);
    const GrayImage image = renderer.render(board, p.pose, options);
    p.view.board = board;
    p.view.observation = detector->detect(image.view()).observation;
    p.view.observation.image_size = camera.image_size();
    p.truth = true_observation(camera, board, p.pose);
    if (p.view.observation.ids != p.truth.ids) continue;
    p.view.observation.patches = cut_patches(image.view(), p.view.observation, board);
    album.pictures.push_back(std::move(p));
  }
  return album;
}

double squares(const Observation& seen, const Observation& truth) {
  double sum = 0;
  for (std::size_t i = 0; i < truth.uv.size(); ++i) {
    sum += std::pow(seen.uv[i].u - truth.uv[i].u, 2) + std::pow(seen.uv[i].v - truth.uv[i].v, 2);
  }
  return sum / static_cast<double>(truth.uv.size());
}

void disturb(Observation& seen, double sigma, std::mt19937_64& random) {
  std::normal_distribution<double> noise(0, sigma);
  for (Pixel& p : seen.uv) p = {p.u + noise(random), p.v + noise(random)};
}

class CornerRefinement : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Corners, CornerRefinement, ::testing::Values("brown5", "fisheye"),
                         [](const auto& test) { return std::string(test.param); });

TEST_P(CornerRefinement, FindsCornersAsWellAsTheDetectorFromNearTheirPlace) {
  scenes::Random random(5);
  const Album album = make_album(scenes::random_camera(GetParam(), random), 12);
  double detected = 0;
  double again = 0;
  double disturbed = 0;
  for (const Picture& p : album.pictures) {
    ASSERT_NE(p.view.observation.patches, nullptr);
    detected += squares(p.view.observation, p.truth);
    const Observation seen =
        refine_with_camera(p.view.observation, scenes::kBoard, album.camera, p.pose);
    EXPECT_EQ(seen.ids, p.view.observation.ids);
    EXPECT_EQ(seen.sigma, p.view.observation.sigma);
    again += squares(seen, p.truth);
    Observation moved = p.view.observation;
    disturb(moved, 0.2, random);
    disturbed += squares(refine_with_camera(moved, scenes::kBoard, album.camera, p.pose), p.truth);
  }
  RecordProperty("detected", std::to_string(std::sqrt(detected / 12)));
  RecordProperty("again", std::to_string(std::sqrt(again / 12)));
  EXPECT_LT(std::sqrt(again), 1.05 * std::sqrt(detected));
  // What was left of the first places is nothing.
  EXPECT_NEAR(std::sqrt(disturbed / again), 1, 1e-3);
}

// Its corners have a near line on one side and a far one on the other.
TEST(AprilGridRefinement, FindsCornersAsWellAsTheDetector) {
  const auto board = parse_board("aprilgrid:4x3:40mm:0.3");
  if (!board) GTEST_SKIP() << "this build knows no dictionary of markers";
  const Album album = make_album(default_camera({1280, 960}), 8, *board);
  scenes::Random random(5);
  double detected = 0;
  double disturbed = 0;
  for (const Picture& p : album.pictures) {
    detected += squares(p.view.observation, p.truth);
    Observation moved = p.view.observation;
    disturb(moved, 0.2, random);
    disturbed += squares(refine_with_camera(moved, *board, album.camera, p.pose), p.truth);
  }
  EXPECT_LT(std::sqrt(disturbed), 1.05 * std::sqrt(detected));
}

// A lamp beside the board: corners are not drawn to its brighter side, in its first and last column
// neither, by more than the detector itself.
TEST(CornerRefinement, IsNotDrawnToTheLight) {
  constexpr double kBias = 0.001;  // px
  scenes::Random random(6);
  Album album = make_album(scenes::random_camera("brown5", random), 12);
  const BoardRenderer renderer(album.camera);
  std::vector<double> inside;
  std::vector<double> border;
  for (Picture& p : album.pictures) {
    GrayImage image = renderer.render(scenes::kBoard, p.pose, {.blur = 1});
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        const double grey = image.row(y)[x] * 0.35 * std::exp((p.truth.uv[22].u - x) / 400);
        image.row(y)[x] = static_cast<std::uint8_t>(std::lround(std::min(grey, 255.0)));
      }
    }
    p.view.observation.patches = cut_patches(image.view(), p.view.observation, scenes::kBoard);
    const Observation seen =
        refine_with_camera(p.view.observation, scenes::kBoard, album.camera, p.pose);
    for (std::size_t i = 0; i < seen.ids.size(); ++i) {
      const int col = seen.ids[i] % 9;
      (col == 0 || col == 8 ? border : inside).push_back(seen.uv[i].u - p.truth.uv[i].u);
    }
  }
  for (std::vector<double>* offs : {&inside, &border}) {
    std::nth_element(offs->begin(), offs->begin() + static_cast<std::ptrdiff_t>(offs->size() / 2),
                     offs->end());
    const double median = (*offs)[offs->size() / 2];
    std::cout << "  " << median << '\n';
    EXPECT_NEAR(median, 0, kBias);
  }
}

TEST(SolveInRuns, TakesOutWhatAPoorDetectorPutIn) {
  scenes::Random random(7);
  const Album album = make_album(scenes::random_camera("brown5", random), 12);
  std::vector<View> views = album.views();
  for (View& view : views) disturb(view.observation, 0.2, random);
  SolveOptions options;
  options.checks = false;
  const ImageSize size = album.camera.image_size();
  const double once = *solve_in_runs(views, size, options, 1).value().calibration.rms;
  const double often = *solve_in_runs(views, size, options, 5).value().calibration.rms;
  EXPECT_GT(once, 0.2);
  EXPECT_LT(often, 0.03);
  // Nothing can be refined without patches.
  for (View& view : views) view.observation.patches.reset();
  EXPECT_EQ(*solve_in_runs(views, size, options, 5).value().calibration.rms, once);
}

TEST(CornerRefinement, LeavesWhatItDoesNotFind) {
  scenes::Random random(9);
  const Album album = make_album(scenes::random_camera("brown5", random), 1);
  const Picture& p = album.pictures.front();
  const Observation& seen = p.view.observation;
  const auto same = [&seen](const Observation& other) {
    bool result = other.ids == seen.ids;
    for (std::size_t i = 0; i < seen.uv.size(); ++i) {
      result = result && other.uv[i].u == seen.uv[i].u && other.uv[i].v == seen.uv[i].v;
    }
    return result;
  };
  // A pose from which the board is somewhere else, and one behind the camera.
  SE3 aside = p.pose;
  aside.translation.x() += 0.2 * aside.translation.z();
  EXPECT_TRUE(same(refine_with_camera(seen, scenes::kBoard, album.camera, aside)));
  SE3 behind = p.pose;
  behind.translation.z() = -behind.translation.z();
  EXPECT_TRUE(same(refine_with_camera(seen, scenes::kBoard, album.camera, behind)));
  // Patches without a corner.
  auto grey = std::make_shared<CornerPatches>(*seen.patches);
  const auto count = seen.ids.size() * static_cast<std::size_t>(grey->side * grey->side);
  grey->pixels = std::make_shared<std::uint8_t[]>(count, std::uint8_t{128});
  Observation plain = seen;
  plain.patches = grey;
  EXPECT_TRUE(same(refine_with_camera(plain, scenes::kBoard, album.camera, p.pose)));
  // Patches that are not of these corners.
  grey->origin.pop_back();
  EXPECT_TRUE(same(refine_with_camera(plain, scenes::kBoard, album.camera, p.pose)));
}

TEST(Patches, LieWithinTheImage) {
  GrayImage image(100, 80, 7);
  Observation seen;
  seen.ids = {0, 1, 2};
  seen.uv = {{0, 0}, {30, 20}, {99, 79}};
  const auto patches = cut_patches(image.view(), seen, scenes::kBoard);
  ASSERT_NE(patches, nullptr);
  for (const auto& [x, y] : patches->origin) {
    EXPECT_GE(x, 0);
    EXPECT_GE(y, 0);
    EXPECT_LE(x + patches->side, 100);
    EXPECT_LE(y + patches->side, 80);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const ImageView patch = patch_view(*patches, i);
    EXPECT_EQ(patch.at(patch.width - 1, patch.height - 1), 7);
  }
  EXPECT_EQ(cut_patches(GrayImage(9, 9).view(), seen, scenes::kBoard), nullptr);
}

}  // namespace
}  // namespace calvin
