// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The detector where something lies on the board: what can be seen is found, and nothing else is
// taken for a corner.
#include <algorithm>
#include <cmath>
#include <iostream>

#include <gtest/gtest.h>

#include "calvin/detect/checkerboard/fits/stray_corners.hpp"
#include "calvin/detect/detector.hpp"
#include "calvin/synth/motion.hpp"
#include "calvin/synth/render.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

using scenes::kBoard;
using scenes::uniform;

// A bar with a round end: a finger; or half a plane: a card with a straight edge.
struct Cover {
  double u = 0, v = 0, angle = 0, half = 0;
  bool card = false;
  std::uint8_t grey = 0;

  // px from its edge, negative under it.
  [[nodiscard]] double distance(double x, double y) const {
    const double along = (x - u) * std::cos(angle) + (y - v) * std::sin(angle);
    const double across = (y - v) * std::cos(angle) - (x - u) * std::sin(angle);
    if (card) return -along;
    return (along < 0 ? std::hypot(x - u, y - v) : std::abs(across)) - half;
  }
  // An edge as a lens draws it, a pixel wide.
  void lay_on(GrayImage& image) const {
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        const double share = std::clamp(0.5 - distance(x, y), 0.0, 1.0);
        if (share == 0) continue;
        std::uint8_t& pixel = image.row(y)[x];
        pixel = static_cast<std::uint8_t>(std::lround(pixel + share * (grey - pixel)));
      }
    }
  }
};

struct Tally {
  int images = 0;
  int wrong_images = 0;
  int enough = 0;   // images with 80 % of what can be seen
  int corners = 0;  // right ones

  void add(const Cover& cover, const Observation& truth, const Observation& found) {
    ++images;
    int visible = 0;
    int right = 0;
    for (const Pixel& p : truth.uv) visible += cover.distance(p.u, p.v) > 4 ? 1 : 0;
    bool wrong = false;
    for (std::size_t i = 0; i < found.ids.size(); ++i) {
      // Where the labelling is open, any corner of the board is right.
      double least = 1e9;
      for (std::size_t k = 0; k < truth.ids.size(); ++k) {
        if (found.ambiguous.empty() && truth.ids[k] != found.ids[i]) continue;
        least = std::min(least,
                         std::hypot(truth.uv[k].u - found.uv[i].u, truth.uv[k].v - found.uv[i].v));
      }
      wrong = wrong || least > 1;
      right += least <= 1 ? 1 : 0;
    }
    wrong_images += wrong ? 1 : 0;
    corners += right;
    enough += 10 * right >= 8 * visible ? 1 : 0;
  }
};

Tally tally(bool cards, std::uint64_t seed, int images) {
  const Camera camera = default_camera({640, 480});
  const BoardRenderer renderer(camera);
  const Motion motion(MotionKind::kRandom, camera, kBoard, seed);
  const auto finder = std::move(*make_detector(kBoard));
  scenes::Random random(seed + 1);
  Tally t;
  for (int n = 0; n < images; ++n) {
    const SE3 pose = motion.camera_from_board(n);
    const Observation truth = true_observation(camera, kBoard, pose);
    GrayImage image = renderer.render(
        kBoard, pose, {.noise = 2, .blur = 0.8, .seed = static_cast<std::uint64_t>(n)});
    const auto& on = truth.uv[static_cast<std::size_t>(uniform(random, 0, 53.9))];
    Cover cover = {on.u,
                   on.v,
                   uniform(random, 0, 2 * std::numbers::pi),
                   uniform(random, 6, 16),
                   cards,
                   static_cast<std::uint8_t>(uniform(random, 20, 235))};
    if (cards) {
      // No more than a third of the board.
      const Pixel middle = truth.uv[22];
      const double past = cover.distance(middle.u, middle.v);
      cover.u += std::max(0.0, 30 - past) * std::cos(cover.angle);
      cover.v += std::max(0.0, 30 - past) * std::sin(cover.angle);
    }
    cover.lay_on(image);
    t.add(cover, truth, finder->detect(image.view()).observation);
  }
  std::cout << "  " << t.enough << " of " << images << " with 80 % of what can be seen, "
            << t.wrong_images << " with a wrong corner, " << t.corners << " right corners\n";
  return t;
}

TEST(CoveredBoards, HaveNoWrongCornersBesideFingers) {
  const int images = scenes::full_count() ? 400 : 40;
  const Tally t = tally(false, 9, images);
  EXPECT_EQ(t.wrong_images, 0);
  EXPECT_GE(t.enough, images * 95 / 100);
}

TEST(CoveredBoards, HaveNoWrongCornersBesideCards) {
  const int images = scenes::full_count() ? 400 : 40;
  const Tally t = tally(true, 11, images);
  EXPECT_EQ(t.wrong_images, 0);
  EXPECT_GE(t.enough, images * 95 / 100);
}

// A finger that ends 6 px from a corner at the board's edge covers none.
TEST(CoveredBoards, AreWholeWhereFingersEndBesideThem) {
  const Camera camera = default_camera({640, 480});
  const BoardRenderer renderer(camera);
  const auto finder = std::move(*make_detector(kBoard));
  scenes::Random random(6);
  const int images = 40;
  int whole = 0;
  for (int n = 0; n < images; ++n) {
    const double turn = uniform(random, 0, 2 * std::numbers::pi);
    const double square = uniform(random, 16, 24);  // px
    const SE3 pose = {exp_so3({0, 0, turn}) * exp_so3({uniform(random, -0.5, 0.5), 0, 0}),
                      exp_so3({0, 0, turn}) * Eigen::Vector3d(-0.1, -0.06, 0) +
                          Eigen::Vector3d(0, 0, camera.fx() * kBoard.cell_size(0) / square)};
    const Observation truth = true_observation(camera, kBoard, pose);
    GrayImage image = renderer.render(
        kBoard, pose, {.noise = 2, .blur = 0.8, .seed = static_cast<std::uint64_t>(n)});
    const auto row = static_cast<std::size_t>(uniform(random, 0, 5.9));
    const Pixel on = truth.uv[9 * row + 8];
    const Pixel before = truth.uv[9 * row + 7];
    Cover finger = {0,
                    0,
                    std::atan2(on.v - before.v, on.u - before.u),
                    uniform(random, 6, 10),
                    false,
                    static_cast<std::uint8_t>(uniform(random, 70, 190))};
    finger.u = on.u + (6 + finger.half) * std::cos(finger.angle);
    finger.v = on.v + (6 + finger.half) * std::sin(finger.angle);
    finger.lay_on(image);
    const Observation seen = finder->detect(image.view()).observation;
    whole += seen.ids == truth.ids ? 1 : 0;
    for (std::size_t i = 0; i < seen.ids.size(); ++i) {
      const Pixel p = truth.uv[static_cast<std::size_t>(seen.ids[i])];
      EXPECT_LT(std::hypot(p.u - seen.uv[i].u, p.v - seen.uv[i].v), 0.2) << n;
    }
  }
  std::cout << "  " << whole << " of " << images << " whole\n";
  EXPECT_GE(whole, images * 9 / 10);
}

// Corners of a board through a lens, some of them moved: those go, and no other.
struct Lens {
  const char* model;
  double tilt;   // rad, of the board at most
  double least;  // squares, by which one was moved
};
class StrayNodes : public ::testing::TestWithParam<Lens> {};
INSTANTIATE_TEST_SUITE_P(Lenses, StrayNodes,
                         ::testing::Values(Lens{"brown5", 1.1, 0.02}, Lens{"fisheye", 0.5, 0.2}),
                         [](const auto& lens) { return lens.param.model; });

TEST_P(StrayNodes, AreThoseThatWereMoved) {
  scenes::Random random(3);
  const Camera camera = scenes::random_camera(GetParam().model, random);
  detect::StrayCorners stray;
  detect::Lattice lattice(12);
  std::normal_distribution<double> noise(0, 0.01);
  int lost = 0;
  for (int n = 0; n < 100; ++n) {
    const SE3 pose =
        scenes::random_pose(camera, kBoard, random, uniform(random, 0, GetParam().tilt));
    lattice.clear();
    const auto points = kBoard.points();
    const auto moved = static_cast<std::size_t>(uniform(random, 0, 53.9));
    const Pixel a = camera.project(pose * points[21]).value();
    const Pixel b = camera.project(pose * points[22]).value();
    const double square = std::hypot(a.u - b.u, a.v - b.v);
    const double by = std::max(0.8, GetParam().least * square) + uniform(random, 0, 5);
    const double angle = uniform(random, 0, 2 * std::numbers::pi);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Pixel at = camera.project(pose * points[i]).value();
      const double share = n % 4 != 0 && i == moved ? by : 0;
      detect::Node node;
      node.x = static_cast<float>(at.u + noise(random) + share * std::cos(angle));
      node.y = static_cast<float>(at.v + noise(random) + share * std::sin(angle));
      node.sigma = 0.01F;
      lattice.put({static_cast<int>(i) % 9, static_cast<int>(i) / 9}, node);
    }
    stray.remove_from(lattice, {}, {319.5, 239.5});
    const detect::Cell cell = {static_cast<int>(moved) % 9, static_cast<int>(moved) / 9};
    if (n % 4 != 0) {
      EXPECT_FALSE(lattice.has(cell))
          << n << ": " << by << " px at " << cell.col << ", " << cell.row;
    }
    lost += 54 - lattice.count() - (n % 4 != 0 ? 1 : 0);
  }
  EXPECT_LE(lost, 2);
}

}  // namespace
}  // namespace calvin
