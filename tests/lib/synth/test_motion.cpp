// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The motions of a rendered board.
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include <gtest/gtest.h>

#include "calvin/synth/motion.hpp"
#include "calvin/synth/render.hpp"
#include "calvin/target/kinds.hpp"

namespace calvin {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kDegree = std::numbers::pi / 180;

constexpr Checkerboard board() { return {9, 6, 0.025}; }

Camera fisheye(const std::vector<double>& parameters) {
  return Camera::make("fisheye", {640, 480}, parameters).value();
}

class MotionOf : public ::testing::TestWithParam<int> {
 protected:
  static Camera camera() {
    switch (GetParam()) {
      case 0:
        return default_camera({640, 480});
      case 1:
        return fisheye({180, 181, 322, 238, 0.01, -0.004, 0.001, -2e-4});
      case 2:
        return default_camera({480, 853});
      default:  // an image circle well inside the image
        return fisheye({90, 90, 310, 230, 0, 0, 0, 0});
    }
  }
  // All points are seen, with the outer squares inside the image.
  static bool whole(const Camera& cam, const Checkerboard& b, const SE3& pose) {
    const Checkerboard larger = {b.cols + 2, b.rows + 2, b.size};
    const SE3 shifted = {pose.rotation, pose * Eigen::Vector3d(-b.size, -b.size, 0)};
    return true_observation(cam, larger, shifted).ids.size() ==
           static_cast<std::size_t>(larger.grid().count());
  }
};
INSTANTIATE_TEST_SUITE_P(Cameras, MotionOf, ::testing::Range(0, 4));

TEST_P(MotionOf, RandomKeepsTheBoardInsideAndCoversTheImage) {
  const Camera cam = camera();
  const Motion motion(MotionKind::kRandom, cam, board(), 11);
  constexpr int kCells = 8;
  std::set<int> covered;
  double widest = 0;
  for (int i = 0; i < 400; ++i) {
    const SE3 pose = motion.camera_from_board(i);
    ASSERT_TRUE(whole(cam, board(), pose)) << "pose " << i;
    const double facing = pose.rotation.col(2).dot(pose.translation.normalized());
    ASSERT_GT(facing, 0.1);
    for (const Pixel& uv : true_observation(cam, board(), pose).uv) {
      covered.insert(static_cast<int>(uv.u * kCells / cam.image_size().width) * kCells +
                     static_cast<int>(uv.v * kCells / cam.image_size().height));
      widest = std::max(widest, std::acos(cam.unproject(uv)->z()));
    }
  }
  if (GetParam() != 3) {
    EXPECT_EQ(covered.size(), static_cast<std::size_t>(kCells * kCells));
  }
  if (cam.model() == "fisheye") {
    EXPECT_GT(widest, 100 * kDegree);
  }
}

TEST_P(MotionOf, SmoothKindsAreSmoothAndInside) {
  const Camera cam = camera();
  const double width = cam.image_size().width;
  for (const MotionKind kind : {MotionKind::kOrbit, MotionKind::kHand}) {
    const Motion motion(kind, cam, board(), 4);
    const Motion other(kind, cam, board(), 5);
    const SE3 first = motion.camera_from_board(0);
    EXPECT_FALSE(first.translation.isApprox(other.camera_from_board(0).translation, 1e-6));
    int inside = 0;
    double path = 0;
    for (int i = 1; i <= 600; ++i) {
      const SE3 before = motion.camera_from_board((i - 1) / 30.0);
      const SE3 pose = motion.camera_from_board(i / 30.0);
      inside += whole(cam, board(), pose);
      const auto a = cam.project(before.translation);
      const auto b = cam.project(pose.translation);
      ASSERT_TRUE(a && b);
      const double step = std::hypot(a->u - b->u, a->v - b->v);
      EXPECT_LT(step, 0.04 * width);
      path += step;
    }
    EXPECT_GT(inside, 570) << static_cast<int>(kind);
    EXPECT_GT(path, 0.5 * width);
  }
}

TEST(MotionKinds, AreRepeatable) {
  const Camera cam = default_camera({640, 480});
  for (const MotionKind kind :
       {MotionKind::kRandom, MotionKind::kOrbit, MotionKind::kHand, MotionKind::kStatic}) {
    const Motion a(kind, cam, board(), 9);
    const Motion b(kind, cam, board(), 9);
    EXPECT_EQ(a.camera_from_board(17).translation, b.camera_from_board(17).translation);
    EXPECT_EQ(a.camera_from_board(-3).translation, a.camera_from_board(0).translation);
    EXPECT_EQ(a.camera_from_board(kNaN).translation, a.camera_from_board(0).translation);
    const bool moves = a.camera_from_board(17).translation != a.camera_from_board(0).translation;
    EXPECT_EQ(moves, kind != MotionKind::kStatic);
  }
}

}  // namespace
}  // namespace calvin
