// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Whether a solve keeps its promise where corners have more than noise: boards whose corners are
// not where they were printed, views that are bent each in its own way, and both, and a lens that
// the model does not have; against the truth.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/solve/difference.hpp"
#include "calvin/solve/judge/agreement.hpp"
#include "calvin/solve/judge/contradiction.hpp"
#include "calvin/synth/motion.hpp"
#include "calvin/synth/render.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

using scenes::Random;

constexpr double kNoise = 0.1;  // px
constexpr int kViews = 25;

int sessions() { return scenes::full_count() ? 200 : 25; }

struct Fault {
  const char* name;
  const char* model;
  double offset = 0;      // mm, of each corner of the board along each axis, 1 sigma
  double roll = 0;        // px, at most, by which the rows of a view are moved from top to bottom
  double noise = kNoise;  // px
  const char* asked = nullptr;  // the model that is solved for, if it is another one
  [[nodiscard]] const char* solved() const { return asked != nullptr ? asked : model; }
};

std::vector<View> session(const Camera& camera, const Fault& fault, Random& random) {
  std::normal_distribution<double> normal(0, 1);
  auto printed = scenes::kBoard.points();
  for (Eigen::Vector3d& p : printed) {
    p.x() += 1e-3 * fault.offset * normal(random);
    p.y() += 1e-3 * fault.offset * normal(random);
  }
  std::vector<View> views;
  for (const SE3& pose : scenes::random_poses(camera, scenes::kBoard, random, kViews)) {
    View view = scenes::observe(camera, scenes::kBoard, pose, 0, random);
    Observation& seen = view.observation;
    const double du = scenes::uniform(random, -fault.roll, fault.roll);
    const double dv = scenes::uniform(random, -fault.roll, fault.roll);
    for (std::size_t i = 0; i < seen.uv.size(); ++i) {
      const Pixel at =
          camera.project(pose * printed[static_cast<std::size_t>(seen.ids[i])]).value();
      const double when = at.v / scenes::kSize.height - 0.5;
      seen.uv[i] = {at.u + when * du + fault.noise * normal(random),
                    at.v + when * dv + fault.noise * normal(random)};
    }
    seen.sigma.assign(seen.uv.size(), fault.noise);
    views.push_back(std::move(view));
  }
  return views;
}

// In the whole picture, and where corners were seen.
Result<Difference> apart_from(const Camera& truth, const Calibration& found) {
  DifferenceOptions where;
  where.focus = {found.covered};
  return difference(Camera::make(found).value(), truth, where);
}

class Promise : public ::testing::TestWithParam<Fault> {};
INSTANTIATE_TEST_SUITE_P(Kept, Promise,
                         ::testing::Values(Fault{"nothing", "brown5"},
                                           Fault{"printing", "brown5", 0.05},
                                           Fault{"bad_printing", "brown5", 0.3},
                                           Fault{"printing_fisheye", "fisheye", 0.1},
                                           Fault{"rolling", "brown5", 0, 3},
                                           Fault{"both", "brown5", 0.1, 3},
                                           Fault{"poor_wide", "doublesphere", 0, 0, 0.002, "ucm"},
                                           Fault{"far_too_poor", "brown5", 0, 0, 0.05, "pinhole"}),
                         [](const auto& test) { return std::string(test.param.name); });

TEST_P(Promise, IsKeptAndNoLargerThanItHasToBe) {
  Random random(11);
  int kept = 0;
  int kept_anywhere = 0;
  std::vector<double> ratios;
  for (int i = 0; i < sessions(); ++i) {
    const Camera camera = scenes::random_camera(GetParam().model, random);
    SolveOptions options;
    options.model = GetParam().solved();
    const auto solution = solve(session(camera, GetParam(), random), camera.image_size(), options);
    ASSERT_TRUE(solution) << solution.error().message;
    const Calibration& c = solution->calibration;
    const auto apart = apart_from(camera, c);
    ASSERT_TRUE(apart && c.expected_error);
    kept += apart->focus.max <= 2 * *c.expected_error ? 1 : 0;
    kept_anywhere += apart->image.max <= 2 * *c.expected_error_anywhere ? 1 : 0;
    ratios.push_back(*c.expected_error / apart->focus.max);
  }
  const double part = 0.9 - 3 * std::sqrt(0.9 * 0.1 / sessions());
  EXPECT_GE(kept, part * sessions());
  EXPECT_GE(kept_anywhere, part * sessions());
  std::nth_element(ratios.begin(), ratios.begin() + sessions() / 2, ratios.end());
  EXPECT_LE(ratios[static_cast<std::size_t>(sessions()) / 2], 3);
}

// Few corners lie where the highest term of a lens counts, and a model without it bends the others
// to make good for that: what another model tells of the rest of the picture is in the promise.
TEST(PromiseOfAPoorModel, HoldsWhatItsLensLacks) {
  const Camera camera = default_camera({640, 480});
  const std::uint64_t trials = scenes::full_count() ? 60 : 12;
  std::uint64_t kept = 0;
  std::uint64_t named = 0;
  double largest = 0;
  for (std::uint64_t seed = 0; seed < trials; ++seed) {
    const Motion motion(MotionKind::kRandom, camera, scenes::kBoard, seed);
    Random random(seed);
    std::vector<View> views;
    for (int n = 0; n < 100; ++n) {
      const SE3 pose = motion.camera_from_board(n);
      views.push_back(scenes::observe(camera, scenes::kBoard, pose, 0.003, random));
    }
    SolveOptions options;
    options.model = "brown4";
    const auto solution = solve(views, camera.image_size(), options);
    ASSERT_TRUE(solution) << solution.error().message;
    const Calibration& c = solution->calibration;
    const auto apart = apart_from(camera, c);
    ASSERT_TRUE(apart && c.expected_error);
    const bool both = apart->focus.max <= 2 * *c.expected_error &&
                      apart->image.max <= 2 * *c.expected_error_anywhere;
    kept += both ? 1 : 0;
    largest = std::max(largest, *c.expected_error_anywhere / apart->image.max);
    const bool is_named =
        !c.remarks.empty() && c.remarks.front().find("Take brown5") != std::string::npos;
    named += solution->misfit.noticed == Misfit::Cause::kModel && is_named ? 1 : 0;
  }
  EXPECT_GE(kept, 0.9 * static_cast<double>(trials));
  EXPECT_GE(named, 0.9 * static_cast<double>(trials));
  EXPECT_LT(largest, 3);
}

// A remark on the board tells what a measured one would bring: the accuracy of the same views of a
// board that is as it was printed.
TEST(MeasuredBoard, IsAsGoodAsOneThatIsAsPrinted) {
  constexpr double kOffset = 0.2;  // mm
  Random random(23);
  double ratios = 0;
  for (int i = 0; i < 10; ++i) {
    const Camera camera = scenes::random_camera("brown5", random);
    Random same = random;
    const auto good = solve(session(camera, {"", "brown5"}, same), camera.image_size(), {});
    const auto bad =
        solve(session(camera, {"", "brown5", kOffset}, random), camera.image_size(), {});
    ASSERT_TRUE(good && bad && !bad->calibration.remarks.empty());
    double offset = 0;
    double accuracy = 0;
    double measured = 0;
    ASSERT_EQ(std::sscanf(bad->calibration.remarks.front().c_str(),
                          "The corners of the board are %lf mm from where they were printed. That "
                          "is in the accuracy of %lf px, which a measured or stiffer board would "
                          "bring to %lf px.",
                          &offset, &accuracy, &measured),
              3)
        << bad->calibration.remarks.front();
    EXPECT_NEAR(offset, kOffset, 0.25 * kOffset);
    EXPECT_NEAR(accuracy, 2 * *bad->calibration.expected_error, 0.05 * accuracy);
    ratios += std::log(measured / (2 * *good->calibration.expected_error)) / 10;
  }
  EXPECT_NEAR(std::exp(ratios), 1, 0.25);
}

// Scores of 40 parts in 12 views, each with the information 4: noise of their own, a bend that
// every view has for itself, and what all of them share.
double agreement_of(double bend, double shared, Random& random, double* variance = nullptr) {
  std::normal_distribution<double> normal(0, 1);
  constexpr std::size_t kParts = 40;
  constexpr double kInformation = 4;
  std::vector<double> common(kParts);
  for (double& c : common) c = shared * normal(random);
  Agreement agreement(kParts);
  for (std::size_t v = 0; v < 12; ++v) {
    const double slope = bend * normal(random);
    for (std::size_t p = 0; p < kParts; ++p) {
      const double along = static_cast<double>(p) / kParts - 0.5;
      const double shift = common[p] + slope * along;
      agreement.add(v, p, kInformation * shift + 2 * normal(random), kInformation);
    }
  }
  if (variance != nullptr) *variance += agreement.variance();
  return agreement.deviations();
}

TEST(Agreement, IsOfWhatAllViewsShareAndNotOfBends) {
  Random random(3);
  constexpr int kTrials = 200;
  int noise = 0;
  int bends = 0;
  int shared = 0;
  double variance = 0;
  for (int i = 0; i < kTrials; ++i) {
    noise += agreement_of(0, 0, random) > 2.33 ? 1 : 0;
    bends += agreement_of(3, 0, random) > 2.33 ? 1 : 0;
    shared += agreement_of(0, 0.3, random, &variance) > 2.33 ? 1 : 0;
  }
  EXPECT_LE(noise, 0.05 * kTrials);
  EXPECT_LE(bends, 0.05 * kTrials);
  EXPECT_GE(shared, 0.95 * kTrials);
  EXPECT_NEAR(variance / kTrials, 0.09, 0.01);
}

// Views that each measure three numbers with noise twice what they say, along the first one alone.
TEST(Contradiction, TellsTheCovarianceThatViewsHave) {
  Random random(5);
  std::normal_distribution<double> normal(0, 1);
  constexpr int kMany = 40;
  constexpr int kTrials = 200;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<Eigen::Vector3d> seen;
    Eigen::Vector3d best = Eigen::Vector3d::Zero();
    for (int v = 0; v < kMany; ++v) {
      seen.emplace_back(2 * normal(random), normal(random), normal(random));
      best += seen.back() / kMany;
    }
    Contradiction contradiction(Eigen::Matrix3d::Identity() / kMany);
    for (const Eigen::Vector3d& x : seen) {
      contradiction.add(contradiction.share(Eigen::Matrix3d::Identity(), best - x));
    }
    mean += contradiction.covariance().value().diagonal() * kMany / kTrials;
    EXPECT_EQ(contradiction.chi_square().degrees, 3 * kMany);
  }
  // 4, 1 and 1, of which the mean counts as two views of 42.
  EXPECT_NEAR(mean[0], (40 * 4 + 2 * 2) / 42.0, 0.2);
  EXPECT_NEAR(mean[1], (40 * 1 + 2 * 2) / 42.0, 0.06);
  EXPECT_NEAR(mean[2], (40 * 1 + 2 * 2) / 42.0, 0.06);
}

}  // namespace
}  // namespace calvin
