// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Rays and distances of many points at once are those that Camera says of each by itself, and so is
// what has none: beyond the fold of a lens, behind it, past the rim of its picture.
#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/camera/models.hpp"
#include "calvin/solve/linear/aligned.hpp"
#include "calvin/solve/residuals/lens_points.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

using scenes::Random;
using scenes::uniform;

constexpr ImageSize kSize = {640, 480};

std::vector<std::string> all_models() {
  std::vector<std::string> names;
  [&]<typename... L>(std::tuple<L...>*) {
    (names.emplace_back(L::kName), ...);
  }(static_cast<AllLenses*>(nullptr));
  return names;
}

// Pixels all over the picture, and as far again around it. How many have a ray.
int expect_rays(const Camera& camera, Random& random) {
  std::vector<Pixel> pixels = {{camera.cx(), camera.cy()}};
  for (int i = 0; i < 400; ++i) {
    pixels.push_back({uniform(random, -0.5, 1.5) * kSize.width,  //
                      uniform(random, -0.5, 1.5) * kSize.height});
  }
  const std::vector<Eigen::Vector3d> rays = CameraPoints(camera).rays(pixels);
  int found = 0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const auto ray = camera.unproject(pixels[i]);
    const Eigen::Vector3d wanted = ray.value_or(Eigen::Vector3d::Zero());
    EXPECT_LT((rays[i] - wanted).norm(), 1e-9) << pixels[i].u << " " << pixels[i].v;
    found += ray ? 1 : 0;
  }
  return found;
}

// Points on all sides of the camera. How many have a projection.
int expect_squares(const Camera& camera, Random& random) {
  PointSet set;
  for (int i = 0; i < 301; ++i) {
    set.ids.push_back(i);
    set.points.emplace_back(uniform(random, -1, 1), uniform(random, -1, 1),
                            uniform(random, -0.3, 1));
    set.uv.push_back({uniform(random, 0, kSize.width), uniform(random, 0, kSize.height)});
    set.weight.push_back(uniform(random, 0.5, 2));
  }
  const SE3 pose = {exp_so3({0.1, -0.2, 0.3}), {0.05, -0.02, 0.1}};
  const ViewPoints view(set, BoardShape());
  const AlignedArray squares = aligned_array(view.padded());
  CameraPoints(camera).squares(view, pose, squares.get());
  int seen = 0;
  for (std::size_t i = 0; i < set.size(); ++i) {
    const auto at = camera.project(pose * set.points[i]);
    EXPECT_EQ(std::isfinite(squares[i]), at.has_value()) << (pose * set.points[i]).transpose();
    if (!at || !std::isfinite(squares[i])) continue;
    const double off = set.weight[i] * std::hypot(at->u - set.uv[i].u, at->v - set.uv[i].v);
    EXPECT_NEAR(std::sqrt(squares[i]), off, 1e-9 * (1 + off));
    ++seen;
  }
  return seen;
}

class LensPoints : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(EveryModel, LensPoints, ::testing::ValuesIn(all_models()),
                         [](const auto& model) { return model.param; });

TEST_P(LensPoints, AreThoseOfEachByItself) {
  Random random(7);
  for (int i = 0; i < 5; ++i) {
    const Camera camera = scenes::random_camera(GetParam(), random, kSize);
    EXPECT_GT(expect_rays(camera, random), 50);
    EXPECT_GT(expect_squares(camera, random), 50);
  }
}

// k1 = -0.3 alone folds back 1.05 focal lengths off the axis, at .70 of them in the picture.
TEST(LensPoints, EndWhereALensFoldsBack) {
  Random random(8);
  const Camera camera =
      Camera::make("brown4", kSize, {450, 450, 319.5, 239.5, -0.3, 0, 0, 0}).value();
  EXPECT_LT(expect_rays(camera, random), 300);
  EXPECT_GT(expect_squares(camera, random), 20);
}

TEST(LensPoints, OfNoneAreNone) {
  const Camera camera = Camera::make("pinhole", kSize, {450, 450, 319.5, 239.5}).value();
  EXPECT_TRUE(CameraPoints(camera).rays({}).empty());
  const std::vector<Pixel> unknown = {{std::nan(""), 3}, {4, 5}};
  const auto rays = CameraPoints(camera).rays(unknown);
  EXPECT_TRUE(rays[0].isZero(0));
  EXPECT_NEAR(rays[1].norm(), 1, 1e-12);
}

}  // namespace
}  // namespace calvin
