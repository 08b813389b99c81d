// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// model=auto over views of which little can be seen: nothing of them is lost.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "calvin/solve/difference.hpp"
#include "scenes.hpp"
#include "true_error.hpp"

namespace calvin {
namespace {

using scenes::Random;

// Leaves, at times, 4 to 9 corners of a view.
void thin_out(View& view, Random& random) {
  Observation& seen = view.observation;
  for (Pixel& p : seen.uv) {
    p = {std::clamp(p.u, 0.0, scenes::kSize.width - 1.0),
         std::clamp(p.v, 0.0, scenes::kSize.height - 1.0)};
  }
  if (scenes::uniform(random, 0, 1) > 0.4) return;
  const auto count = 4 + static_cast<std::size_t>(scenes::uniform(random, 0, 6));
  std::set<std::size_t> kept;
  while (kept.size() < count) {
    kept.insert(static_cast<std::size_t>(scenes::uniform(random, 0, 54)));
  }
  const Observation all = seen;
  seen.ids.clear();
  seen.uv.clear();
  seen.sigma.clear();
  for (const std::size_t i : kept) {
    seen.ids.push_back(all.ids[i]);
    seen.uv.push_back(all.uv[i]);
    seen.sigma.push_back(all.sigma[i]);
  }
}

// Whatever model wins, a view that it did not use is named: poses belong to the views that are
// left. Few corners of some views, so that a model may have no pose for one that another had.
TEST(AutoModel, EveryViewIsUsedOrNamed) {
  constexpr const char* kTruths[] = {"fisheye", "ucm", "brown5", "eucm"};
  for (const int seed : {127, 128, 130, 179, 246, 307}) {
    Random random(seed);
    const Camera camera = scenes::random_camera(kTruths[seed % 4], random);
    const double noise = scenes::uniform(random, 0.1, 3);
    const auto poses = scenes::random_poses(camera, scenes::kBoard, random, 3 + seed % 6,
                                            seed % 3 != 0 ? 0.3 : 0.8);
    auto views = scenes::observe_all(camera, scenes::kBoard, poses, noise, random);
    for (View& view : views) thin_out(view, random);
    SolveOptions options;
    options.model = "auto";
    const auto solution = solve(views, camera.image_size(), options);
    ASSERT_TRUE(solution) << solution.error().message;
    std::set<std::uint64_t> used;
    for (const ViewRecord& view : solution->calibration.views) used.insert(view.timestamp);
    for (const RejectedView& view : solution->rejected) {
      EXPECT_TRUE(used.insert(views[view.index].observation.timestamp).second) << seed;
    }
    EXPECT_EQ(used.size(), views.size()) << seed << ' ' << solution->calibration.model;
  }
}

class AutoOfLens : public ::testing::TestWithParam<std::string_view> {};
INSTANTIATE_TEST_SUITE_P(AutoModel, AutoOfLens, ::testing::ValuesIn(model_names()),
                         [](const auto& test) { return std::string(test.param); });

// Whatever lens there is, what is promised of the model that was taken is kept: twice the expected
// error, where there were corners.
TEST_P(AutoOfLens, PromisesNoMoreThanItKeeps) {
  const int sessions = scenes::full_count() ? 50 : 2;
  int kept = 0;
  for (int session = 0; session < sessions; ++session) {
    Random random(100 + session);
    const Camera truth = scenes::random_camera(GetParam(), random);
    const auto poses = scenes::random_poses(truth, scenes::kBoard, random, 15);
    const auto views = scenes::observe_all(truth, scenes::kBoard, poses, 0.1, random);
    SolveOptions options;
    options.model = "auto";
    const auto solution = solve(views, scenes::kSize, options);
    ASSERT_TRUE(solution) << session << ": " << solution.error().message;
    const Calibration& found = solution->calibration;
    const auto apart = difference(Camera::make(found).value(), truth, {.focus = {found.covered}});
    ASSERT_TRUE(apart) << session << ": " << apart.error().message;
    ASSERT_TRUE(found.expected_error) << session;
    kept += apart->focus.max <= 2 * *found.expected_error ? 1 : 0;
  }
  // Nine of ten, and two standard deviations of such a count.
  EXPECT_GE(kept, 0.9 * sessions - 2 * std::sqrt(0.09 * sessions));
}

// Where a lens is wide and the model is not, the model is to blame, whatever else the residuals
// look like; and the one that removes the misfit is named.
TEST(OtherModels, TheOneThatRemovesAMisfitIsNamed) {
  Random random(31);
  const int trials = scenes::full_count() ? 50 : 5;
  int named = 0;
  for (int i = 0; i < trials; ++i) {
    const Camera camera = scenes::random_camera("fisheye", random);
    const auto poses = scenes::random_poses(camera, scenes::kBoard, random, 20);
    const auto views = scenes::observe_all(camera, scenes::kBoard, poses, 0.1, random);
    SolveOptions options;
    options.model = "brown5";
    const auto solution = solve(views, camera.image_size(), options);
    if (!solution) continue;
    const Calibration& c = solution->calibration;
    ASSERT_FALSE(c.remarks.empty());
    const bool right =
        c.misfit == "model" && solution->misfit.cause == Misfit::Cause::kModel &&
        c.remarks.front().find("brown5") != std::string::npos &&
        c.remarks.front().find("predicts views held out to 0.1") != std::string::npos;
    named += right ? 1 : 0;
    if (!right) ADD_FAILURE() << c.misfit << ": " << c.remarks.front();
  }
  EXPECT_GT(named, 0);
}

// Where no corner was seen models that fit as well differ by pixels, and each is sure of itself.
TEST(AutoModel, PromisesNothingOfWhatModelsDifferIn) {
  const Camera camera =
      Camera::make("fisheye", {1280, 720}, {420, 421, 633, 366, -0.012, 0.004, -0.002, 0.0002})
          .value();
  constexpr double kSeen = 430;  // px from the middle, 59 degrees from the axis
  int wrong = 0;
  int kept = 0;
  const int sessions = scenes::full_count() ? 40 : 10;
  for (int seed = 0; seed < sessions; ++seed) {
    Random random(seed);
    std::vector<View> views;
    while (views.size() < 14) {
      const SE3 pose = scenes::random_pose(camera, scenes::kBoard, random, 0.8);
      View view = scenes::observe(camera, scenes::kBoard, pose, 0.03, random);
      const bool is_near = std::ranges::all_of(view.observation.uv, [](const Pixel& p) {
        return std::hypot(p.u - 633, p.v - 366) < kSeen;
      });
      if (is_near) views.push_back(std::move(view));
    }
    SolveOptions options;
    options.model = "auto";
    const auto solution = solve(views, camera.image_size(), options);
    ASSERT_TRUE(solution) << solution.error().message;
    const Calibration& calibration = solution->calibration;
    if (calibration.model == "fisheye") continue;
    ++wrong;
    const double error = scenes::worst_error(calibration, camera, {});
    const double promise = 2 * calibration.expected_error_anywhere.value_or(HUGE_VAL);
    kept += error <= promise ? 1 : 0;
    // One remark says where that is, with the same figure.
    std::vector<std::string> places;
    std::ranges::copy_if(calibration.remarks, std::back_inserter(places), [](const auto& remark) {
      return remark.starts_with("No corner was seen");
    });
    ASSERT_EQ(places.size(), 1U);
    const bool is_known = promise < 50;
    EXPECT_NE(places[0].find(is_known ? fmt::format("accurate to {:.3g} px only", promise)
                                      : "of which nothing is known"),
              std::string::npos)
        << places[0];
  }
  EXPECT_GE(kept, 0.85 * wrong);
}

}  // namespace
}  // namespace calvin
