// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The renderer against brute force and against analytic edges.
#include <cmath>
#include <iostream>
#include <limits>
#include <numbers>
#include <random>
#include <set>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "calvin/synth/motion.hpp"
#include "calvin/synth/render.hpp"
#include "calvin/target/kinds.hpp"

#include "brute_force.hpp"

namespace calvin {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kDegree = std::numbers::pi / 180;

Checkerboard board(const char* text = "checkerboard:9x6:25mm") {
  return *parse_board(text).value().as<Checkerboard>();
}

Camera camera_of(std::string_view model, const std::vector<double>& parameters,
                 ImageSize size = {640, 480}) {
  return Camera::make(model, size, parameters).value();
}
Camera brown() { return camera_of("brown5", {520, 518, 325, 236, -0.28, 0.09, 5e-4, -7e-4, 0.01}); }
Camera fisheye() { return camera_of("fisheye", {180, 181, 322, 238, 0.01, -0.004, 0.001, -2e-4}); }

// The scene as the header describes it, point by point.
double brute_force(const Camera& camera, const Checkerboard& b, const SE3& pose,
                   const RenderOptions& o, int u, int v) {
  const auto level = [&](double x_in_m, double y_in_m) {
    const double x = x_in_m / b.size;
    const double y = y_in_m / b.size;
    if (x < -2 || y < -2 || x >= b.cols + 1 || y >= b.rows + 1) return o.background;
    if (x < -1 || y < -1 || x >= b.cols || y >= b.rows) return o.light;
    const bool same = (static_cast<int>(x + 2) + static_cast<int>(y + 2)) % 2 == 0;
    return same ? o.dark : o.light;
  };
  return scenes::mean_seen(camera, pose, o.background, level, u, v);
}

class RenderedBy : public ::testing::TestWithParam<int> {
 protected:
  static Camera camera() {
    switch (GetParam()) {
      case 0:
        return brown();
      case 1:
        return fisheye();
      default:
        return camera_of("pinhole", {300, 310, 150, 130}, {321, 243});
    }
  }
};
INSTANTIATE_TEST_SUITE_P(Lenses, RenderedBy, ::testing::Range(0, 3));

TEST_P(RenderedBy, EqualsBruteForce) {
  const Camera cam = camera();
  const BoardRenderer renderer(cam);
  const Checkerboard b = board();
  const RenderOptions options;
  const Motion motion(MotionKind::kRandom, cam, b, 3);
  std::mt19937 random(5);
  double sum = 0;
  int edges = 0;
  for (int k = 0; k < 8; ++k) {
    const SE3 pose = motion.camera_from_board(k);
    const GrayImage image = renderer.render(b, pose, options);
    // Random pixels, and pixels around the control points, where the edges are.
    std::vector<std::pair<int, int>> pixels;
    const auto integer = [&random](int n) { return static_cast<int>(random() % unsigned(n)); };
    for (int i = 0; i < 60; ++i) pixels.emplace_back(integer(image.width), integer(image.height));
    for (const Pixel& uv : true_observation(cam, b, pose).uv) {
      const int u = static_cast<int>(std::lround(uv.u));
      const int v = static_cast<int>(std::lround(uv.v));
      pixels.emplace_back(u, v);
      pixels.emplace_back(std::clamp(u + integer(9) - 4, 0, image.width - 1), v);
    }
    for (const auto& [u, v] : pixels) {
      const double expected = brute_force(cam, b, pose, options, u, v);
      const double error = image.view().at(u, v) - expected;
      ASSERT_NEAR(error, 0, 2.5) << u << ", " << v << " of view " << k;
      sum += error;
      edges += expected != 30 && expected != 220 && expected != 128;
    }
  }
  EXPECT_GT(edges, 150);
  EXPECT_NEAR(sum / edges, 0, 0.1);
}

// u of the edge x = column squares at the image row v: the sum of `u` along the projected line.
double edge_at(const Camera& cam, const Checkerboard& b, const SE3& pose, int column, double v) {
  double low = -0.5 * b.size;
  double high = 0.5 * b.size;
  Pixel at;
  for (int i = 0; i < 50; ++i) {
    const double y = (low + high) / 2;
    at = cam.project(pose * Eigen::Vector3d(column * b.size, y, 0)).value();
    (at.v < v ? low : high) = y;
  }
  return at.u;
}

// Where a picture has the edge x = 0 in a row and where it should, in the mean over the row.
struct EdgeInRow {
  double seen;      // u
  double expected;  // u
  double bend;      // of the edge, px per row^2
};

EdgeInRow edge_in_row(const ImageView& image, const Camera& cam, const Checkerboard& b,
                      const SE3& pose, int v) {
  constexpr int kParts = 16;
  double expected = 0;
  for (int i = 0; i < kParts; ++i) {
    expected += edge_at(cam, b, pose, 0, v - 0.5 + (i + 0.5) / kParts) / kParts;
  }
  // Light left of the edge, dark right of it: the light area is where the edge is.
  const int left = static_cast<int>(expected) - 6;
  double light = 0;
  for (int u = left; u < left + 13; ++u) light += (image.at(u, v) - 30) / 190.0;
  const auto edge = [&](int row) { return edge_at(cam, b, pose, 0, row); };
  return {left - 0.5 + light, expected, edge(v - 1) - 2 * edge(v) + edge(v + 1)};
}

TEST_P(RenderedBy, PutsEdgesWhereTheCameraProjectsThem) {
  const Camera cam = camera();
  const BoardRenderer renderer(cam);
  const Checkerboard b = board("checkerboard:2x6:300mm");
  double sum = 0;
  double squares = 0;
  int count = 0;
  for (int k = 0; k < 40; ++k) {
    // The edge between the first two squares, a few degrees off the vertical, anywhere.
    SE3 pose;
    pose.rotation = exp_so3({0.2, 0.3 * std::sin(k), 0.03 + 0.002 * k});
    pose.translation = 0.5 * *cam.unproject({0.2 * cam.image_size().width + 4.13 * k,
                                             0.3 * cam.image_size().height + 2.7 * k});
    const GrayImage image = renderer.render(b, pose, {});
    const Pixel corner = cam.project(pose.translation).value();
    for (int row = 12; row < 19; ++row) {
      const EdgeInRow edge =
          edge_in_row(image.view(), cam, b, pose, static_cast<int>(corner.v) + row);
      const double error = edge.seen - edge.expected;
      ASSERT_LT(std::abs(error), 0.01) << "view " << k;
      sum += error;
      squares += error * error;
      ++count;
    }
  }
  EXPECT_NEAR(sum / count, 0, 5e-4);
  EXPECT_LT(std::sqrt(squares / count), 0.004);  // 8 bits leave 0.0015 to 0.003
}

// Straight lines between the borders of each pixel would be 1/12 of an edge's bend off, or more.
// Rays of a lens that bends little are interpolated, those of one that bends much are exact.
TEST(Renderer, BentEdgesAreNotDrawnToTheirHollowSide) {
  struct Lens {
    double f;
    ImageSize size;
    int views;
  };
  for (const auto& [f, size, views] : {Lens{60, {240, 180}, 240}, Lens{160, {640, 480}, 160}}) {
    const Camera cam =
        camera_of("fisheye", {f, f, size.width / 2.0, size.height / 2.0, 0, 0, 0, 0}, size);
    const BoardRenderer renderer(cam);
    const Checkerboard b = board("checkerboard:2x6:500mm");
    double errors = 0;
    double bends = 0;
    for (int k = 0; k < views; ++k) {
      const Pixel at = {size.width * (0.083 + 0.83 * k / views),
                        size.height * (0.224 + std::fmod(0.1317 * k, 0.389))};
      const Eigen::Vector3d ray = cam.unproject(at).value();
      SE3 pose;
      pose.rotation =
          Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), ray).toRotationMatrix() *
          exp_so3({0, 0, 0.05 * std::sin(k)});
      pose.translation = 0.5 * ray;
      const GrayImage image = renderer.render(b, pose, {});
      const int v = static_cast<int>(cam.project(pose.translation)->v);
      for (int row = 6; row < static_cast<int>(f / 3); ++row) {
        const EdgeInRow edge = edge_in_row(image.view(), cam, b, pose, v + row);
        errors += edge.bend * (edge.seen - edge.expected);
        bends += edge.bend * edge.bend;
      }
    }
    // Of 0.003 px, what 8 bits leave of a row: sum(bend error) / sum(bend^2).
    const double spread = 0.003 / std::sqrt(bends);
    std::cout << "  " << errors / bends << " of the bend, +- " << spread << '\n';
    EXPECT_LT(spread, 0.025);
    EXPECT_NEAR(errors / bends, 0, std::max(0.02, 3 * spread));
  }
}

TEST(Renderer, GreyLevelsAreRounded) {
  const Camera cam = camera_of("pinhole", {500, 500, 320, 240});
  const SE3 away = {Eigen::Matrix3d::Identity(), {0, 0, -1}};
  for (const auto& [level, seen] : {std::pair{100.4, 100}, {100.6, 101}, {0.4, 0}, {254.6, 255}}) {
    EXPECT_EQ(render_board(cam, board(), away, {.background = level}).pixels.front(), seen);
  }
}

TEST(Renderer, ShowsDarkSquareOutsideControlPointZero) {
  const Camera cam = camera_of("pinhole", {500, 500, 320, 240});
  const SE3 pose = {Eigen::Matrix3d::Identity(), {-0.1, -0.06, 0.5}};
  const GrayImage image = render_board(cam, board(), pose);
  const Pixel p = true_observation(cam, board(), pose).uv[0];
  const auto at = [&](int du, int dv) {
    return image.view().at(static_cast<int>(p.u) + du, static_cast<int>(p.v) + dv);
  };
  EXPECT_EQ(at(-5, -5), 30);
  EXPECT_EQ(at(5, 5), 30);
  EXPECT_EQ(at(5, -5), 220);
  EXPECT_EQ(at(-40, -40), 220);
  EXPECT_EQ(at(-60, -60), 128);
}

TEST(Renderer, SeesPast90Degrees) {
  const Camera cam = fisheye();
  const Checkerboard b = board();
  SE3 pose;  // straight to the right and a little behind
  pose.rotation = exp_so3({0, 100 * kDegree, 0});
  pose.translation = pose.rotation * Eigen::Vector3d(-0.1, -0.0625, 0.25);
  const Observation truth = true_observation(cam, b, pose);
  std::size_t behind = 0;
  for (std::size_t i = 0; i < truth.ids.size(); ++i) {
    behind += cam.unproject(truth.uv[i])->z() < 0;
  }
  EXPECT_GT(behind, 10U);
  const GrayImage image = render_board(cam, b, pose);
  for (const Pixel& uv : truth.uv) {
    const int u = static_cast<int>(std::lround(uv.u));
    const int v = static_cast<int>(std::lround(uv.v));
    EXPECT_NEAR(image.view().at(u, v), brute_force(cam, b, pose, {}, u, v), 2.5);
  }
  // A perspective lens sees nothing of it.
  EXPECT_FALSE(true_observation(brown(), b, pose).found());
  for (const std::uint8_t pixel : render_board(brown(), b, pose).pixels) ASSERT_EQ(pixel, 128);
}

TEST(Renderer, ShowsTheBackAsABlankCard) {
  const Camera cam = brown();
  SE3 pose = {exp_so3({0, 180 * kDegree, 0}), {0.1, -0.06, 0.6}};
  EXPECT_FALSE(true_observation(cam, board(), pose).found());
  std::set<std::uint8_t> values;
  for (const std::uint8_t pixel : render_board(cam, board(), pose).pixels) values.insert(pixel);
  EXPECT_EQ(*values.begin(), 128);
  EXPECT_EQ(*values.rbegin(), 220);
}

TEST(Renderer, ARollingShutterShowsEachRowAsOfItsTime) {
  const Camera cam = brown();
  const Motion hand(MotionKind::kHand, cam, board(), 3);
  const PoseOfRow pose = [&](double v) { return hand.camera_from_board(2 + 0.1 * v / 479); };
  const BoardRenderer renderer(cam);
  const GrayImage rolled = renderer.render(board(), pose);
  for (const int y : {0, 100, 240, 333, 479}) {
    const GrayImage still = renderer.render(board(), pose(y));
    for (int x = 0; x < 640; ++x) ASSERT_EQ(rolled.view().at(x, y), still.view().at(x, y)) << y;
  }
  const Observation truth = true_observation(cam, board(), pose);
  const Observation still = true_observation(cam, board(), pose(0));
  ASSERT_EQ(truth.ids.size(), 54U);
  double moved = 0;
  for (std::size_t i = 0; i < truth.ids.size(); ++i) {
    const Pixel p = truth.uv[i];
    const Pixel q = cam.project(pose(p.v) * board().grid().points()[i]).value();
    EXPECT_LT(std::hypot(p.u - q.u, p.v - q.v), 1e-6);
    moved = std::max(moved, std::hypot(p.u - still.uv[i].u, p.v - still.uv[i].v));
  }
  EXPECT_GT(moved, 1);  // px
}

TEST(Renderer, BearsBadInput) {
  const Camera cam = default_camera({33, 17});
  const SE3 good = Motion(MotionKind::kStatic, cam, board(), 0).camera_from_board(0);
  SE3 bad = good;
  bad.translation.setConstant(kNaN);
  EXPECT_FALSE(true_observation(cam, board(), bad).found());
  for (const SE3& pose : {good, bad, SE3{}, SE3{Eigen::Matrix3d::Zero(), {0, 0, 1e300}}}) {
    for (const double x : {kNaN, -1.0, 0.0, 1e300}) {
      EXPECT_EQ(render_board(cam, board(), pose, {.noise = x}).pixels.size(), 33U * 17U);
      EXPECT_EQ(render_board(cam, board(), pose, {.exposure = x}).pixels.size(), 33U * 17U);
    }
    EXPECT_EQ(render_board(cam, board(), pose, {.blur = kNaN}).pixels.size(), 33U * 17U);
  }
}

TEST(DefaultCamera, IsAsWideAsAskedAndValidEverywhere) {
  for (const ImageSize size : {ImageSize{640, 480}, {1920, 1080}, {480, 640}, {17, 16}}) {
    for (const double degrees : {40.0, 70.0, 100.0}) {
      const Camera cam = default_camera(size, degrees * kDegree);
      EXPECT_EQ(cam.image_size(), size);
      EXPECT_EQ(cam.model(), "brown5");
      EXPECT_NE(cam.fx(), cam.fy());
      const bool wide = size.width > size.height;
      const auto first = cam.unproject(wide ? Pixel{-0.5, cam.cy()} : Pixel{cam.cx(), -0.5});
      const auto last = cam.unproject(wide ? Pixel{size.width - 0.5, cam.cy()}
                                           : Pixel{cam.cx(), size.height - 0.5});
      ASSERT_TRUE(first && last);
      EXPECT_NEAR(std::acos(first->dot(*last)) / kDegree, degrees, 0.5);
      for (const Pixel corner : {Pixel{-0.5, -0.5},
                                 {size.width - 0.5, -0.5},
                                 {-0.5, size.height - 0.5},
                                 {size.width - 0.5, size.height - 0.5}}) {
        EXPECT_TRUE(cam.unproject(corner).has_value()) << size.width << " " << degrees;
      }
    }
  }
}

}  // namespace
}  // namespace calvin
