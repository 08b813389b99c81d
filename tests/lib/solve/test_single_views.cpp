// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Views taken one after the other say what each says in a problem of its own, whatever the view
// before has left.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/solve/residuals/bundle_problem.hpp"
#include "calvin/solve/residuals/single_views.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

using scenes::kBoard;
using scenes::Random;

// With corners left out, another number in each view.
PointSet seen_from(const Camera& camera, const SE3& pose, int left_out, Random& random) {
  const View view = scenes::observe(camera, kBoard, pose, 0.3, random);
  PointSet set = to_points(kBoard, kBoard.points(), view.observation);
  for (int i = 0; i < left_out; ++i) set.weight[static_cast<std::size_t>(3 * i)] = 0;
  return set;
}

class SingleViewsOf : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Lenses, SingleViewsOf, ::testing::Values("pinhole", "brown5", "fisheye"));

TEST_P(SingleViewsOf, SayWhatEachSaysByItself) {
  Random random(5);
  const Camera camera = scenes::random_camera(GetParam(), random);
  ParameterTable table({{GetParam()}}, {BoardUnknowns()});
  table.tie({1, 0, camera.fy() / camera.fx()});
  ASSERT_TRUE(table.resolve_ties());
  const Eigen::MatrixXd basis = table.basis();
  const std::vector<double> shared(camera.parameters().begin(), camera.parameters().end());
  SingleViews views(table, basis, shared);
  int left_out = 0;
  for (const SE3& pose : scenes::random_poses(camera, kBoard, random, 6)) {
    const PointSet set = seen_from(camera, pose, left_out, random);
    ASSERT_TRUE(views.next(set, BoardShape(), pose));
    const auto ours = views.reduced();
    const ViewPoints points(set, BoardShape());
    BundleProblem problem({{{&points}}, {}, {}}, {&table, basis, {}}, {shared, {pose}, {}, {}},
                          Loss{});
    const auto alone = problem.reduced();
    ASSERT_TRUE(ours && alone);
    EXPECT_GT(ours->cost, 0);
    EXPECT_NEAR(ours->cost, alone->cost, 1e-9 * alone->cost);
    EXPECT_EQ(ours->information.rows(), basis.cols());
    EXPECT_TRUE(ours->information.isApprox(alone->information, 1e-9)) << left_out;
    EXPECT_TRUE(ours->gradient.isApprox(alone->gradient, 1e-9)) << left_out;
    // The rows are those of the corners in use, weighted.
    EXPECT_EQ(views.rows().padded(), points.padded());
    left_out += 3;
  }
}

// A board behind the camera has no projection; the view after it is none the worse for it.
TEST(SingleViews, PassOverOneThatHasNoProjection) {
  Random random(6);
  const Camera camera = scenes::random_camera("brown5", random);
  const ParameterTable table({{"brown5"}}, {BoardUnknowns()});
  const Eigen::MatrixXd basis = table.basis();
  const std::vector<double> shared(camera.parameters().begin(), camera.parameters().end());
  SingleViews views(table, basis, shared);
  const SE3 pose = scenes::random_poses(camera, kBoard, random, 1)[0];
  const PointSet set = seen_from(camera, pose, 0, random);
  ASSERT_TRUE(views.next(set, BoardShape(), pose));
  const auto before = views.reduced();
  SE3 behind = pose;
  behind.translation.z() = -1;
  EXPECT_FALSE(views.next(set, BoardShape(), behind));
  EXPECT_FALSE(views.reduced());
  ASSERT_TRUE(views.next(set, BoardShape(), pose));
  const auto after = views.reduced();
  ASSERT_TRUE(before && after);
  EXPECT_TRUE(after->information.isApprox(before->information, 1e-12));
}

}  // namespace
}  // namespace calvin
