// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Models that the views do not determine: a simpler one is solved, and the user is told.
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/solve/difference.hpp"
#include "calvin/solve/models/simpler_model.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

using scenes::kBoard;
using scenes::kSize;
using scenes::Random;

class AnyModel : public ::testing::TestWithParam<std::string_view> {};
INSTANTIATE_TEST_SUITE_P(Simpler, AnyModel, ::testing::ValuesIn(model_names()),
                         [](const auto& test) { return std::string(test.param); });

// No session ends in an error, and what is promised is kept: twice the expected error, where there
// were corners.
TEST_P(AnyModel, IsSolvedInEverySession) {
  int kept = 0;
  int all = 0;
  const int sessions = scenes::full_count() ? 50 : 15;
  for (const int count : {6, 15}) {
    for (int session = 0; session < sessions; ++session) {
      Random random(session);
      const Camera truth = scenes::random_camera(GetParam(), random);
      const auto views = scenes::observe_all(
          truth, kBoard, scenes::random_poses(truth, kBoard, random, count), 0.1, random);
      SolveOptions options;
      options.model = GetParam();
      const auto solution = solve(views, kSize, options);
      ASSERT_TRUE(solution) << session << " of " << count << ": " << solution.error().message;
      const Calibration& found = solution->calibration;
      const bool told = !found.remarks.empty() && found.remarks[0].starts_with(
                                                      "The views do not determine the "
                                                      "model " +
                                                      options.model + ",");
      EXPECT_EQ(told, found.model != options.model) << session << " of " << count;
      const auto apart = difference(Camera::make(found).value(), truth, {.focus = {found.covered}});
      ASSERT_TRUE(apart) << session << " of " << count << ": " << apart.error().message;
      ASSERT_TRUE(found.expected_error) << session << " of " << count;
      kept += apart->focus.max <= 2 * *found.expected_error;
      ++all;
    }
  }
  // Nine of ten, and two standard deviations of such a count.
  EXPECT_GE(kept, 0.9 * all - 2 * std::sqrt(0.09 * all));
}

TEST(Simpler, ModelsAreThoseWithSomeOfTheCoefficients) {
  using Names = std::vector<std::string_view>;
  EXPECT_EQ(simpler_models("rational8"), (Names{"brown5", "brown4", "pinhole"}));
  EXPECT_EQ(simpler_models("tilted14"),
            (Names{"thinprism12", "rational8", "brown5", "brown4", "pinhole"}));
  EXPECT_EQ(simpler_models("doublesphere"), Names{"ucm"});
  EXPECT_EQ(simpler_models("pinhole"), Names{});
  EXPECT_EQ(simpler_models("fisheye"), Names{});
}

// Views that determine no camera do not determine a simple one: the error is that of the model that
// was asked for.
TEST(Simpler, NoModelIsMadeOfABoardThatIsNeverTilted) {
  Random random(1);
  const Camera truth = scenes::random_camera("rational8", random);
  std::vector<SE3> poses;
  for (int i = 0; poses.size() < 5 && i < 1000; ++i) {
    SE3 pose = scenes::random_pose(truth, kBoard, random, 0.3);
    pose.rotation.setIdentity();
    if (scenes::sees_all(truth, kBoard, pose)) poses.push_back(pose);
  }
  ASSERT_GE(poses.size(), 3U);
  SolveOptions options;
  options.model = "rational8";
  const auto solution =
      solve(scenes::observe_all(truth, kBoard, poses, 0.1, random), kSize, options);
  ASSERT_FALSE(solution);
  EXPECT_EQ(solution.error().code, ErrorCode::kDegenerate);
}

// What is fixed of a coefficient goes with it; the rest stays fixed.
TEST(Simpler, WhatIsFixedStaysSo) {
  int simplified = 0;
  for (int session = 0; session < 30; ++session) {
    Random random(session);
    const Camera truth = scenes::random_camera("tilted14", random);
    SolveOptions options;
    options.model = "tilted14";
    options.fix = {"taux", "s1", "p1", "aspect"};
    const auto solution =
        solve(scenes::observe_all(truth, kBoard, scenes::random_poses(truth, kBoard, random, 6),
                                  0.1, random),
              kSize, options);
    ASSERT_TRUE(solution) << solution.error().message;
    const Calibration& found = solution->calibration;
    simplified += found.model != options.model;
    EXPECT_DOUBLE_EQ(found.find("fx")->value, found.find("fy")->value);
    const Parameter* p1 = found.find("p1");
    if (p1 != nullptr) {
      EXPECT_EQ(p1->value, 0);
      EXPECT_FALSE(p1->sigma);
    }
  }
  EXPECT_GT(simplified, 0);
}

}  // namespace
}  // namespace calvin
