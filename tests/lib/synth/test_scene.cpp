// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Boards of every kind as they are rendered: against their artwork sampled ray by ray, and dots
// against the areas and centres of circles.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iostream>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/synth/disc_cut.hpp"
#include "calvin/synth/motion.hpp"
#include "calvin/synth/render.hpp"
#include "calvin/synth/scene.hpp"
#include "calvin/target/artwork/artwork.hpp"
#include "calvin/target/kinds.hpp"

#include "artwork_at.hpp"
#include "board_kinds.hpp"
#include "brute_force.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

constexpr double kPi = std::numbers::pi;
const RenderOptions kOptions;

// Of the artwork at a place, m.
double level_of(const Artwork& artwork, double x, double y) {
  const BoardArea& area = artwork.outline;
  const double margin = artwork.margin;
  if (x < area.left - margin || y < area.top - margin || x >= area.right + margin ||
      y >= area.bottom + margin) {
    return kOptions.background;
  }
  return scenes::is_dark_at(artwork, x, y) ? kOptions.dark : kOptions.light;
}

class EveryKind : public ::testing::TestWithParam<scenes::NamedBoard> {
 protected:
  static const Board& board() { return GetParam().board; }
  static std::vector<Camera> cameras() {
    return {default_camera({640, 480}),
            Camera::make("fisheye", {640, 480}, {180, 181, 322, 238, 0.01, -0.004, 0.001, -2e-4})
                .value()};
  }
};
INSTANTIATE_TEST_SUITE_P(Boards, EveryKind, ::testing::ValuesIn(scenes::board_of_each_kind()),
                         scenes::name_of);

TEST_P(EveryKind, EqualsItsArtwork) {
  const Artwork artwork = artwork_of(board());
  const auto level = [&](double x, double y) { return level_of(artwork, x, y); };
  std::mt19937 random(5);
  double sum = 0;
  double largest = 0;
  int edges = 0;
  for (const Camera& cam : cameras()) {
    const BoardRenderer renderer(cam);
    const Motion motion(MotionKind::kRandom, cam, board(), 3);
    for (int k = 0; k < 6; ++k) {
      SE3 pose = motion.camera_from_board(k);
      if (k % 3 == 2) pose.translation *= 4;  // a pixel sees several cells and dots
      const GrayImage image = renderer.render(board(), pose);
      const BoardArea area = board().outline();
      for (int i = 0; i < 150; ++i) {
        // Anywhere on the board, and a little around it.
        const auto any = [&random](double from, double to) {
          return from + (to - from) * (1.2 * static_cast<double>(random()) / 4294967296.0 - 0.1);
        };
        const auto uv = cam.project(
            pose * Eigen::Vector3d(any(area.left, area.right), any(area.top, area.bottom), 0));
        if (!uv || uv->u < 0 || uv->v < 0 || uv->u > 639 || uv->v > 479) continue;
        const int u = static_cast<int>(std::lround(uv->u));
        const int v = static_cast<int>(std::lround(uv->v));
        const double expected = scenes::mean_seen(cam, pose, kOptions.background, level, u, v);
        const double error = image.view().at(u, v) - expected;
        ASSERT_NEAR(error, 0, 3.5) << u << ", " << v << " of view " << k << " by " << cam.model();
        if (expected == kOptions.dark || expected == kOptions.light) continue;
        ++edges;
        sum += error;
        largest = std::max(largest, std::abs(error));
      }
    }
  }
  std::cout << "  " << edges << " pixels at edges: off by " << sum / edges << ", at most "
            << largest << " grey levels\n";
  EXPECT_GT(edges, 80);
  EXPECT_NEAR(sum / edges, 0, 0.15);
}

// The corners of squares are where colours meet, the points of other boards are dots.
TEST_P(EveryKind, HasItsControlPointsWhereTheTruthIs) {
  const Camera cam = Camera::make("pinhole", {800, 600}, {900, 900, 399.5, 299.5}).value();
  const BoardArea area = board().outline();
  SE3 pose = {exp_so3({0.2, -0.1, 0.3}), {}};
  pose.translation = Eigen::Vector3d(0, 0, 2.5 * std::max(area.width(), area.height())) -
                     pose.rotation * Eigen::Vector3d((area.left + area.right) / 2,
                                                     (area.top + area.bottom) / 2, 0);
  const GrayImage image = render_board(cam, board(), pose);
  const Observation truth = true_observation(cam, board(), pose);
  ASSERT_EQ(truth.ids, board().ids());
  const auto points = board().points();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto level = [&](double x, double y) {
      const double d = 0.06 * board().cell_size(truth.ids[i]);
      const auto uv = cam.project(pose * (points[i] + Eigen::Vector3d(x * d, y * d, 0))).value();
      return image.view().at(static_cast<int>(std::lround(uv.u)),
                             static_cast<int>(std::lround(uv.v)));
    };
    EXPECT_NEAR(truth.uv[i].u, cam.project(pose * points[i])->u, 1e-9);
    const auto* circles = board().as<CircleGrid>();
    if (circles != nullptr) {  // on a disc, or in the hole of a ring
      const bool is_ring = circles->mark(board().grid()->place(truth.ids[i])) == DiscMark::kRing;
      EXPECT_EQ(level(0, 0), is_ring != circles->inverted ? kOptions.light : kOptions.dark)
          << truth.ids[i];
      continue;
    }
    if (!board().grid()) {
      EXPECT_EQ(level(0, 0), kOptions.dark) << truth.ids[i];
      continue;
    }
    if (const auto* tags = board().as<TagGrid>()) {  // a corner of one tag, with nothing beside it
      const GridPlace at = board().grid()->place(truth.ids[i]);
      const int across = at.col % 2 == 0 ? 1 : -1;
      const int down = at.row % 2 == 0 ? 1 : -1;
      // Borders are dark, and light ones have a dark ring around them.
      const bool is_dark_around = tags->inverted != (tags->dictionary->outside > 0);
      const auto around = is_dark_around ? kOptions.dark : kOptions.light;
      EXPECT_EQ(level(across, down), kOptions.dark + kOptions.light - around) << truth.ids[i];
      for (const auto& [x, y] : {std::pair{-1, -1}, {-1, 1}, {1, -1}}) {
        EXPECT_EQ(level(x * across, y * down), around) << truth.ids[i];
      }
      continue;
    }
    EXPECT_EQ(level(-1, -1), level(1, 1)) << truth.ids[i];
    EXPECT_EQ(level(1, -1), level(-1, 1)) << truth.ids[i];
    EXPECT_EQ(level(1, 1) + level(-1, 1), kOptions.dark + kOptions.light) << truth.ids[i];
  }
}

TEST_P(EveryKind, IsABlankCardFromBehind) {
  const Camera cam = Camera::make("pinhole", {320, 240}, {360, 360, 159.5, 119.5}).value();
  const SE3 pose = {exp_so3({0, kPi, 0}), {0, -0.1, 1}};
  EXPECT_FALSE(true_observation(cam, board(), pose).found());
  const GrayImage image = render_board(cam, board(), pose);
  for (const std::uint8_t level : image.pixels) ASSERT_GE(level, 127);
  EXPECT_EQ(*std::max_element(image.pixels.begin(), image.pixels.end()), 220);
}

TEST_P(EveryKind, LiesInTheImageInEveryMotion) {
  for (const Camera& cam : cameras()) {
    for (const auto kind : {MotionKind::kRandom, MotionKind::kOrbit, MotionKind::kHand}) {
      const Motion motion(kind, cam, board(), 1);
      for (int t = 0; t < 10; ++t) {
        const auto seen = true_observation(cam, board(), motion.camera_from_board(t));
        EXPECT_EQ(seen.ids, board().ids()) << static_cast<int>(kind) << " " << t;
      }
    }
  }
}

TEST(PuzzleBoardScene, ShowsTheCodeInTheMiddleOfTheEdges) {
  const PuzzleBoard board = {14, 9, 0.02, 7, 300};
  const Camera cam = Camera::make("pinhole", {800, 600}, {900, 900, 399.5, 299.5}).value();
  const SE3 pose = {exp_so3({0.3, 0.2, 0}), {-0.13, -0.08, 0.5}};
  const GrayImage image = render_board(cam, board, pose);
  int dots = 0;
  const auto expect_dot = [&](double col, double row, bool is_light) {
    const auto uv = cam.project(pose * Eigen::Vector3d(col * board.size, row * board.size, 0));
    const int level =
        image.view().at(static_cast<int>(std::lround(uv->u)), static_cast<int>(std::lround(uv->v)));
    EXPECT_EQ(level, is_light ? 220 : 30) << col << ", " << row;
    ++dots;
  };
  for (int row = 0; row < board.rows; ++row) {
    for (int col = 0; col < board.cols; ++col) {
      const GridPlace p{col, row};
      if (col + 1 < board.cols) expect_dot(col + 0.5, row, board.is_light_after(p));
      if (row + 1 < board.rows) expect_dot(col, row + 0.5, board.is_light_below(p));
    }
  }
  EXPECT_EQ(dots, 13 * 9 + 14 * 8);
}

// Of the disc in a square of side 1 around the origin, by strips.
double area_in_pixel(const Artwork::Disc& disc, int strips = 20000) {
  const double radius = disc.diameter / 2;
  double sum = 0;
  for (int i = 0; i < strips; ++i) {
    const double x = (i + 0.5) / strips - 0.5 - disc.x;
    if (std::abs(x) >= radius) continue;
    const double half = std::sqrt(radius * radius - x * x);
    sum += std::max(0.0, std::min(0.5, disc.y + half) - std::max(-0.5, disc.y - half));
  }
  return sum / strips;
}

// How far the ink of a dot is from where the areas of its disc in the pixels have it, px. These are
// not the middle of a small disc either: where in its pixel ink lies is not seen.
struct Moved {
  double u = 0;
  double v = 0;
  double level = 0;  // the largest difference of a pixel
};

Moved moved(const GrayImage& image, Pixel middle, double diameter) {
  const int column = static_cast<int>(std::lround(middle.u));
  const int row = static_cast<int>(std::lround(middle.v));
  Moved moved;
  double ink = 0;
  for (int y = row - 24; y <= row + 24; ++y) {
    for (int x = column - 24; x <= column + 24; ++x) {
      const double expected = area_in_pixel({middle.u - x, middle.v - y, diameter}, 1000);
      const double more = 1 - image.view().at(x, y) / 255.0 - expected;
      moved.level = std::max(moved.level, 255 * std::abs(more));
      moved.u += more * (x - middle.u);
      moved.v += more * (y - middle.v);
      ink += expected;
    }
  }
  moved.u /= ink;
  moved.v /= ink;
  return moved;
}

// Each of 100 dots, seen head on, where its middle falls anywhere in a pixel.
TEST(Dots, AreNotMoved) {
  constexpr double kPixel = 0.5e-3;  // m
  const Camera cam = Camera::make("pinhole", {640, 640}, {1000, 1000, 319.5, 319.5}).value();
  scenes::Random random(2);
  std::vector<PointBoard::Dot> dots;
  for (int id = 0; id < 100; ++id) {
    const auto any = [&] { return scenes::uniform(random, -0.5, 0.5) * kPixel; };
    const double x = (60 * (id % 10) - 270) * kPixel + any();
    const double y = (60 * (id / 10) - 270) * kPixel + any();
    dots.push_back({id, x, y, scenes::uniform(random, 4, 40) * kPixel});
  }
  const Board board = PointBoard::make("dots", dots).value();
  const SE3 pose = {Eigen::Matrix3d::Identity(), {0, 0, 1000 * kPixel}};
  const RenderOptions black_on_white = {.dark = 0, .light = 255, .background = 255};
  const GrayImage image = render_board(cam, board, pose, black_on_white);
  Moved largest;
  double mean = 0;
  for (const PointBoard::Dot& dot : dots) {
    const Pixel middle = cam.project(pose * Eigen::Vector3d(dot.x, dot.y, 0)).value();
    const Moved one = moved(image, middle, dot.diameter / kPixel);
    largest = {std::max(largest.u, std::abs(one.u)), std::max(largest.v, std::abs(one.v)),
               std::max(largest.level, one.level)};
    mean += (one.u + one.v) / 200;
  }
  std::cout << "  moved by at most " << largest.u << ", " << largest.v << " px, by " << mean
            << " in the mean\n";
  EXPECT_LT(largest.u, 0.002);
  EXPECT_LT(largest.v, 0.002);
  EXPECT_NEAR(mean, 0, 2e-4);
  EXPECT_LT(largest.level, 0.5 + 0.05) << "grey levels are rounded";
}

synth::Vertex vertex(double x, double y) {
  return {static_cast<float>(x + 0.5), static_cast<float>(y + 0.5), x, y, 1};
}
const synth::PixelCorners kPixelCorners = {vertex(-0.5, -0.5), vertex(0.5, -0.5), vertex(0.5, 0.5),
                                           vertex(-0.5, 0.5)};

TEST(DiscCut, HasTheAreaUnderTheCircle) {
  scenes::Random random(4);
  synth::Polygon pixel;
  for (const synth::Vertex& corner : kPixelCorners) pixel.push(corner);
  double largest = 0;
  for (int i = 0; i < 3000; ++i) {
    const double radius = std::exp(scenes::uniform(random, std::log(0.05), std::log(200)));
    const double distance = radius + scenes::uniform(random, -0.8, 0.8);
    const double angle = scenes::uniform(random, 0, 2 * kPi);
    const Artwork::Disc disc = {distance * std::cos(angle), distance * std::sin(angle), 2 * radius};
    synth::Polygon inside;
    const synth::Overlap overlap = synth::cut_disc(pixel, disc, inside);
    const double area = overlap == synth::Overlap::kNone  ? 0
                        : overlap == synth::Overlap::kAll ? 1
                                                          : inside.area();
    const double error = std::abs(area - area_in_pixel(disc));
    ASSERT_LT(error, 1e-4) << "radius " << radius << " at " << disc.x << ", " << disc.y;
    largest = std::max(largest, error);
  }
  std::cout << "  off by at most " << largest << " px\n";
}

// A ring is a disc on a disc, and the colour below shows nowhere else.
TEST(DiscCut, LaterDiscsCoverEarlierOnes) {
  Artwork artwork;
  artwork.outline = {-9, -9, 9, 9};
  artwork.x = {-9, 0.1, 9};
  artwork.y = {-9, 9};
  artwork.dark = {1, 0};
  artwork.discs = {{0, 0, 0.8, true}, {0.02, 0, 0.6, false}, {0, 0.01, 0.2, true}};
  const synth::Scene scene(artwork);
  std::array<synth::Scene::Cell, 4> seen;
  for (std::size_t i = 0; i < 4; ++i) {
    seen[i] = scene.cell_at(kPixelCorners[i].x, kPixelCorners[i].y);
  }
  // Left of 0.1 the sheet is dark; right of it lies a part of the first disc.
  const double part = 0.16 * std::acos(0.25) - 0.1 * std::sqrt(0.16 - 0.01);
  const double dark = 0.6 + part - kPi * (0.09 - 0.01);
  const double mean = scene.mean(
      {1, 0, 0.5}, [] { return kPixelCorners; }, seen);
  EXPECT_NEAR(mean, dark, 1e-4);
}

}  // namespace
}  // namespace calvin
