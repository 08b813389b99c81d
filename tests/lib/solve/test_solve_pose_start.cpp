// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A pose that is fitted roughly, as the start of a joint fit: it is the pose of the whole fit but
// for a part of its noise, and tells whether the mirrored tilt fits nearly as well, as that does.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "calvin/solve/start/pose_fit.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

using scenes::kBoard;
using scenes::kSize;
using scenes::Random;
using scenes::uniform;

constexpr RivalTilt kRival = {6, 1e-6};

// Before the camera, tilted by up to 60 degrees, from as large as the picture to a small part of
// it.
SE3 random_pose(Random& random) {
  const double away = uniform(random, 0.35, 3);
  const double direction = uniform(random, 0, 2 * std::numbers::pi);
  const double tilt = uniform(random, 0, std::numbers::pi / 3);
  const Eigen::Matrix3d turn =
      exp_so3({tilt * std::cos(direction), tilt * std::sin(direction), 0}) *
      exp_so3({0, 0, uniform(random, -std::numbers::pi, std::numbers::pi)});
  const Eigen::Vector3d middle(0.1, 0.0625, 0);
  const Eigen::Vector3d at(uniform(random, -0.2, 0.2) * away, uniform(random, -0.2, 0.2) * away,
                           away);
  return {turn, at - turn * middle};
}

struct Verdict {
  bool has_two = false;
  bool is_close = false;  // to the limit, where either answer is right
};

Verdict tilts_of(const PoseFit& fit, std::size_t corners) {
  constexpr double kSame = 0.02;  // of rotations: the minimum of the best was found again
  constexpr double kClose = 1.1;
  const double limit = kRival.limit(fit.cost, corners);
  const bool is_other = (fit.other.rotation - fit.camera_from_board.rotation).norm() > kSame;
  return {is_other && fit.other_cost <= limit,
          is_other && fit.other_cost > limit / kClose && fit.other_cost < limit * kClose};
}

// px, root mean square, from where one pose has the corners to where another one does.
double apart(const Camera& camera, const SE3& one, const SE3& other) {
  double squares = 0;
  for (const Eigen::Vector3d& point : kBoard.points()) {
    const auto a = camera.project(one * point);
    const auto b = camera.project(other * point);
    if (!a || !b) return 1e6;
    squares += std::pow(a->u - b->u, 2) + std::pow(a->v - b->v, 2);
  }
  return std::sqrt(squares / kBoard.point_count());
}

TEST(PoseStart, IsNearTheWholeFitAndTellsTheSameTilts) {
  Random random(21);
  const int views = scenes::full_count() ? 20000 : 2000;
  int seen = 0;
  int with_two = 0;
  int differ = 0;
  int rough_ones = 0;
  for (int i = 0; i < views; ++i) {
    const Camera camera = scenes::random_camera(i % 2 == 0 ? "brown5" : "fisheye", random);
    const SE3 pose = random_pose(random);
    if (!scenes::sees_all(camera, kBoard, pose)) continue;
    const double noise = uniform(random, 0.03, 0.4);
    const View view = scenes::observe(camera, kBoard, pose, noise, random);
    const PointSet set = to_points(kBoard, kBoard.points(), view.observation);
    const auto whole = fit_pose(set, camera, Loss{});
    const auto rough = fit_pose_roughly(set, rays_of(set, camera), camera, kRival);
    ASSERT_TRUE(whole && rough);
    const Verdict wanted = tilts_of(*whole, set.size());
    const Verdict found = tilts_of(*rough, set.size());
    ++seen;
    with_two += wanted.has_two ? 1 : 0;
    if (wanted.is_close || found.is_close) continue;
    differ += wanted.has_two != found.has_two ? 1 : 0;
    // Of two tilts that fit alike either may be the better one by chance of the last digits.
    double off = apart(camera, rough->camera_from_board, whole->camera_from_board);
    if (wanted.has_two) {
      off = std::min(off, apart(camera, rough->other, whole->camera_from_board));
    }
    EXPECT_LT(off, 0.5 * noise) << i;
    rough_ones += off > 0.1 * noise ? 1 : 0;
  }
  EXPECT_GT(seen, views / 2);
  EXPECT_GT(with_two, seen / 50);
  EXPECT_LT(with_two, seen - seen / 50);
  EXPECT_LE(differ, seen / 1000);
  EXPECT_LE(rough_ones, seen / 1000);
}

}  // namespace
}  // namespace calvin
