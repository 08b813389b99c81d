// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Known points: objects in space are solved without a method, of as little as one view, a bent
// board is none, and the centres of the images of dots become the images of their centres.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/solve/solve.hpp"
#include "known_points.hpp"

namespace calvin {
namespace {

using scenes::kSize;
using scenes::Object;
using scenes::Random;

// Dots of 20 mm whose images' centres were measured: the bias is seen, and is gone with the camera.
TEST(EllipseCenters, AreMendedWithTheCamera) {
  Random random(29);
  const Camera camera = scenes::random_camera("brown5", random);
  std::vector<PointBoard::Dot> dots;
  for (int i = 0; i < 70; ++i) dots.push_back({i, 0.03 * (i % 10), 0.03 * (i / 10), 0.02});
  const Board board = PointBoard::make("plate", dots).value();
  std::vector<View> views;
  double most = 0;
  for (int v = 0; v < 12; ++v) {
    const SE3 pose = scenes::random_pose(camera, board, random, 0.9);
    views.push_back(scenes::observe(camera, board, pose, 0, random));
    Observation& seen = views.back().observation;
    for (std::size_t i = 0; i < seen.uv.size(); ++i) {
      // The centroid by a way of its own: the sum over small parts of the disc.
      const Eigen::Vector3d middle = board.points()[i];
      Eigen::Vector2d moment = Eigen::Vector2d::Zero();
      double area = 0;
      for (int ring = 0; ring < 20; ++ring) {
        const double r = 0.01 * (ring + 0.5) / 20;
        for (int part = 0; part < 60; ++part) {
          const double a = part * std::numbers::pi / 30;
          const auto at = [&](double radius, double angle) {
            const Eigen::Vector3d rim(std::cos(angle), std::sin(angle), 0);
            const Pixel p = camera.project(pose * (middle + radius * rim)).value();
            return Eigen::Vector2d(p.u, p.v);
          };
          const Eigen::Vector2d along = at(r + 0.00025, a) - at(r - 0.00025, a);
          const Eigen::Vector2d across = at(r, a + 0.05) - at(r, a - 0.05);
          const double size = std::abs(along.x() * across.y() - along.y() * across.x());
          moment += size * at(r, a);
          area += size;
        }
      }
      const Pixel centroid = {moment.x() / area, moment.y() / area};
      most = std::max(most, std::hypot(centroid.u - seen.uv[i].u, centroid.v - seen.uv[i].v));
      seen.uv[i] = centroid;
    }
  }
  EXPECT_GT(most, 0.2) << "nothing to mend";
  SolveOptions options;
  options.warp = false;
  options.reject_outliers = false;
  const auto biased = solve(views, kSize, options);
  options.ellipse_centers = true;
  const auto mended = solve(views, kSize, options);
  ASSERT_TRUE(biased && mended);
  EXPECT_LT(*mended->calibration.rms, 0.02 * *biased->calibration.rms);
  EXPECT_NEAR(mended->calibration.find("fx")->value, camera.fx(), 0.02);
  EXPECT_GT(std::abs(biased->calibration.find("fx")->value - camera.fx()), 0.1);

  const auto none =
      solve({{scenes::observe(camera, scenes::kBoard,
                              {Eigen::Matrix3d::Identity(), {-0.1, -0.06, 0.4}}, 0.1, random)}},
            kSize, options);
  EXPECT_FALSE(none);
}

// Points in space need no method: the search starts by the projection matrix, too.
TEST(PointsInSpace, AreSolvedWithoutAMethod) {
  Random random(23);
  for (const char* model : {"brown5", "fisheye"}) {
    const Camera camera = scenes::random_camera(model, random);
    std::vector<View> views;
    const Board board = scenes::object(Object::kSpace, random);
    for (int v = 0; v < 3; ++v) {
      views.push_back(scenes::observe(
          camera, board, scenes::pose_for(camera, board, Object::kSpace, random), 0.1, random));
    }
    SolveOptions options;
    options.model = model;
    const auto found = solve(views, kSize, options);
    ASSERT_TRUE(found) << found.error().message;
    EXPECT_LT(*found->calibration.rms, 0.16);
    EXPECT_NEAR(found->calibration.find("fx")->value, camera.fx(),
                5 * *found->calibration.find("fx")->sigma);
  }
}

// A sheet whose arch is a twentieth of its width is a plane to the start, and no object in space.
TEST(PointsInSpace, AreNoBentBoards) {
  Random random(31);
  PointSet sheet = scenes::points_of(
      scenes::observe(scenes::random_camera("pinhole", random), scenes::kBoard,
                      {Eigen::Matrix3d::Identity(), {-0.1, -0.06, 0.5}}, 0, random));
  EXPECT_FALSE(spans_space(sheet));
  for (Eigen::Vector3d& p : sheet.points) p.z() = 0.01 * (1 - std::pow(p.x() / 0.1 - 1, 2));
  EXPECT_FALSE(spans_space(sheet));
  EXPECT_FALSE(board_from_plane(sheet));
  for (Eigen::Vector3d& p : sheet.points) p.z() *= 6;
  EXPECT_TRUE(spans_space(sheet));
  // A plane that is not that of the board.
  for (Eigen::Vector3d& p : sheet.points) p.z() = 0.5 * p.x();
  EXPECT_FALSE(spans_space(sheet));
  ASSERT_TRUE(board_from_plane(sheet));
  const SE3 plane_from_board = board_from_plane(sheet)->inverse();
  for (const Eigen::Vector3d& p : sheet.points) EXPECT_NEAR((plane_from_board * p).z(), 0, 1e-12);
}

// Halves are of several views.
TEST(PointsInSpace, OfOneViewHaveNoHalves) {
  Random random(41);
  const Camera camera = scenes::random_camera("pinhole", random);
  const Board board = scenes::object(Object::kSpace, random);
  std::vector<View> views;
  SolveOptions options;
  options.model = "pinhole";
  for (int v = 0; v < 3; ++v) {
    views.push_back(scenes::observe(
        camera, board, scenes::pose_for(camera, board, Object::kSpace, random), 0.1, random));
    const auto found = solve(views, kSize, options);
    ASSERT_TRUE(found) << found.error().message;
    ASSERT_EQ(found->calibration.views.size(), views.size());
    EXPECT_EQ(found->calibration.split_half_ratio.has_value(), views.size() > 1);
  }
}

}  // namespace
}  // namespace calvin
