// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The pose of one board before a known camera.
#include <gtest/gtest.h>

#include "calvin/core/text.hpp"
#include "calvin/solve/pose.hpp"
#include "calvin/solve/solve.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

using scenes::kBoard;
using scenes::Random;

class Pose_ : public ::testing::TestWithParam<std::string_view> {};
INSTANTIATE_TEST_SUITE_P(Pose, Pose_, ::testing::ValuesIn(model_names()),
                         [](const auto& test) { return std::string(test.param); });

TEST_P(Pose_, IsRecoveredFromExactCorners) {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const Camera camera = scenes::random_camera(GetParam(), random);
    const SE3 truth = scenes::random_pose(camera, kBoard, random, 0.01 * i);
    const View view = scenes::observe(camera, kBoard, truth, 0, random);
    PoseQuality quality;
    const auto pose = solve_pose(camera, kBoard, view.observation, &quality);
    ASSERT_TRUE(pose.has_value()) << pose.error().message;
    EXPECT_LT((pose->translation - truth.translation).norm(), 1e-9) << i;
    EXPECT_LT((pose->rotation - truth.rotation).norm(), 1e-8) << i;
    EXPECT_LT(quality.rms, 1e-8);
    EXPECT_GE(quality.other_rms, quality.rms);
  }
}

// The error of a pose in units of its covariance: sigma^2 (J^T J)^-1 with J by differences.
double normalised_pose_error(const Camera& camera, const View& view, const SE3& truth,
                             const SE3& found, double sigma) {
  const SE3 left = found * truth.inverse();
  Eigen::Matrix<double, 6, 1> d;
  d << log_so3(left.rotation), left.translation;
  const std::vector<Eigen::Vector3d> board = view.board.points();
  constexpr double kStep = 1e-6;
  double squares = 0;
  for (const int id : view.observation.ids) {
    const Eigen::Vector3d& point = board[static_cast<std::size_t>(id)];
    const auto moved = [&](double factor) {
      const SE3 by = {exp_so3(factor * d.head<3>()), factor * d.tail<3>()};
      return camera.project(by * (truth * point)).value();
    };
    const double step = kStep / d.norm();
    const Pixel ahead = moved(step);
    const Pixel behind = moved(-step);
    const double du = (ahead.u - behind.u) / (2 * step);
    const double dv = (ahead.v - behind.v) / (2 * step);
    squares += du * du + dv * dv;
  }
  return squares / (sigma * sigma) / 6;
}

TEST_P(Pose_, HasTheErrorThatTheNoiseImplies) {
  Random random(2);
  double sum = 0;
  constexpr int kTrials = 400;
  for (int i = 0; i < kTrials; ++i) {
    const Camera camera = scenes::random_camera(GetParam(), random);
    const SE3 truth = scenes::random_pose(camera, kBoard, random, 0.4);
    const View view = scenes::observe(camera, kBoard, truth, 0.2, random);
    const auto pose = solve_pose(camera, kBoard, view.observation);
    ASSERT_TRUE(pose.has_value());
    sum += normalised_pose_error(camera, view, truth, *pose, 0.2) / kTrials;
  }
  // 2400 squared normal deviates: a standard deviation of 0.03.
  EXPECT_NEAR(sum, 1, 0.12);
}

// Each corner alike, whatever its sigma.
TEST(PoseQuality, IsTheMeanDistanceOfTheCorners) {
  Random random(5);
  const Camera camera = scenes::random_camera("brown5", random);
  View view = scenes::observe(camera, kBoard, scenes::random_pose(camera, kBoard, random, 0.4), 0.3,
                              random);
  for (double& sigma : view.observation.sigma) sigma = scenes::uniform(random, 0.01, 0.6);
  PoseQuality quality;
  const auto pose = solve_pose(camera, kBoard, view.observation, &quality);
  ASSERT_TRUE(pose.has_value());
  const std::vector<Eigen::Vector3d> board = kBoard.points();
  double sum = 0;
  for (std::size_t i = 0; i < view.observation.ids.size(); ++i) {
    const auto id = static_cast<std::size_t>(view.observation.ids[i]);
    const Pixel at = camera.project(*pose * board[id]).value();
    sum +=
        std::pow(at.u - view.observation.uv[i].u, 2) + std::pow(at.v - view.observation.uv[i].v, 2);
  }
  EXPECT_NEAR(quality.rms, std::sqrt(sum / static_cast<double>(board.size())), 1e-9);
}

TEST(PoseAmbiguity, TheBetterOfTheTwoTiltsIsFound) {
  // A board far away covers few pixels: a descent from one start ends in either minimum.
  Random random(3);
  const Camera camera = scenes::random_camera("brown5", random);
  int found = 0;
  constexpr int kTrials = 200;
  for (int i = 0; i < kTrials; ++i) {
    const double side = scenes::uniform(random, 0, 6.28);
    const SE3 truth = {exp_so3({0.5 * std::cos(side), 0.5 * std::sin(side), 0}), {-0.1, 0, 3}};
    const View view = scenes::observe(camera, kBoard, truth, 0.01, random);
    PoseQuality quality;
    const auto pose = solve_pose(camera, kBoard, view.observation, &quality);
    ASSERT_TRUE(pose.has_value());
    EXPECT_LE(quality.rms, quality.other_rms);
    found += (pose->rotation - truth.rotation).norm() < 0.1 ? 1 : 0;
  }
  EXPECT_EQ(found, kTrials);
}

TEST(PoseErrors, SayWhatIsWrong) {
  Random random(4);
  const Camera camera = scenes::random_camera("brown5", random);
  const SE3 truth = scenes::random_pose(camera, kBoard, random, 0.3);
  const Observation good = scenes::observe(camera, kBoard, truth, 0, random).observation;
  const auto code = [&](const Observation& seen) {
    const auto pose = solve_pose(camera, kBoard, seen);
    EXPECT_FALSE(pose.has_value());
    return pose ? ErrorCode::kIo : pose.error().code;
  };
  Observation seen = good;
  seen.ids.resize(9);
  seen.uv.resize(9);
  EXPECT_EQ(code(seen), ErrorCode::kDegenerate);
  EXPECT_EQ(code(Observation{}), ErrorCode::kDegenerate);
  seen = good;
  seen.image_size = {640, 480};
  EXPECT_EQ(code(seen), ErrorCode::kInvalidArgument);
  seen = good;
  seen.uv[0].u = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(code(seen), ErrorCode::kInvalidArgument);
  seen = good;
  seen.ids[0] = 99;
  EXPECT_EQ(code(seen), ErrorCode::kInvalidArgument);
  seen = good;
  std::fill(seen.uv.begin(), seen.uv.end(), Pixel{100, 100});
  EXPECT_EQ(code(seen), ErrorCode::kDegenerate);
}

// solve() with the whole camera held: poses, and the camera as it was.
TEST(Poses, AreAllThatIsSolvedWhereTheCameraIsHeld) {
  Random random(5);
  const Camera camera = scenes::random_camera("brown5", random);
  std::vector<View> views;
  std::vector<SE3> truths;
  for (int i = 0; i < 3; ++i) {
    truths.push_back(scenes::random_pose(camera, kBoard, random, 0.3));
    views.push_back(scenes::observe(camera, kBoard, truths.back(), 0, random));
  }
  View line = views.front();
  line.observation.ids.resize(5);
  line.observation.uv.resize(5);
  line.observation.sigma.clear();
  views.insert(views.begin() + 1, line);
  SolveOptions options;
  options.fix = {" all"};
  EXPECT_FALSE(check(options)) << "of no camera";
  EXPECT_FALSE(solve(views, scenes::kSize, options));
  options.initial = camera.to_calibration();
  options.initial->expected_error = 0.07;
  ASSERT_TRUE(check(options));
  const auto found = solve(views, scenes::kSize, options);
  ASSERT_TRUE(found) << found.error().message;
  ASSERT_EQ(found->rejected.size(), 1U);
  EXPECT_EQ(found->rejected[0].index, 1U);
  ASSERT_EQ(found->calibration.views.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const SE3 pose = to_se3(found->calibration.views[i].camera_from_board);
    EXPECT_LT((pose.translation - truths[i].translation).norm(), 1e-8);
    EXPECT_LT((pose.rotation - truths[i].rotation).norm(), 1e-8);
  }
  EXPECT_LT(*found->calibration.rms, 1e-7);
  EXPECT_EQ(found->calibration.expected_error, 0.07);
  EXPECT_EQ(found->calibration.find("k1")->value, camera.to_calibration().find("k1")->value);
  EXPECT_FALSE(solve(views, {640, 480}, options)) << "a camera of another size";
  EXPECT_FALSE(solve(std::vector{line}, scenes::kSize, options));
  options.method = "zhang";
  EXPECT_FALSE(check(options)) << "two cameras";
}

// So many views, each of a board that is tilted by up to `tilt`, with corners that are off by
// `noise` px.
std::vector<View> tilted_views(const Camera& camera, int count, double tilt, double noise,
                               Random& random) {
  std::vector<View> views;
  for (int i = 0; i < count; ++i) {
    const SE3 pose = scenes::random_pose(camera, kBoard, random, tilt);
    views.push_back(scenes::observe(camera, kBoard, pose, noise, random));
  }
  return views;
}

SolveOptions holding(Calibration camera) {
  SolveOptions options;
  options.fix = {"all"};
  options.initial = std::move(camera);
  return options;
}

// Poses before a wrong camera look like any: the corners say that it is none of theirs.
TEST(Poses, SayThatTheCameraThatIsHeldIsAnother) {
  Random random(3);
  const Camera camera = scenes::random_camera("brown5", random);
  const auto views = tilted_views(camera, 8, 0.3, 0.05, random);
  SolveOptions options = holding(camera.to_calibration());
  options.initial->misfit = "board";
  options.initial->remarks = {"of the views before"};
  const auto right = solve(views, scenes::kSize, options);
  ASSERT_TRUE(right.has_value());
  EXPECT_NEAR(right->calibration.chi.value_or(0), 1, 0.2);
  EXPECT_EQ(right->calibration.misfit, "none");
  EXPECT_TRUE(right->calibration.remarks.empty());
  options.initial->parameters[0].value *= 0.8;
  options.initial->parameters[1].value *= 0.8;
  const auto wrong = solve(views, scenes::kSize, options);
  ASSERT_TRUE(wrong.has_value());
  EXPECT_GT(wrong->calibration.chi.value_or(0), 5);
  EXPECT_EQ(wrong->calibration.misfit, "model");
  ASSERT_EQ(wrong->calibration.remarks.size(), 1U);
  EXPECT_NE(wrong->calibration.remarks[0].find("another camera"), std::string::npos);
}

// A camera that differs by less than five times the noise is told by what all views have in common.
TEST(Poses, SayThatTheCameraThatIsHeldIsASimilarOne) {
  Random random(3);
  const Camera camera = scenes::random_camera("brown5", random);
  const auto views = tilted_views(camera, 12, 0.7, 0.15, random);
  SolveOptions options = holding(camera.to_calibration());
  options.initial->expected_error = 0.07;
  const auto right = solve(views, scenes::kSize, options);
  ASSERT_TRUE(right.has_value());
  EXPECT_EQ(right->calibration.misfit, "none") << join(right->calibration.remarks, " ");
  EXPECT_EQ(right->calibration.expected_error, 0.07) << "what is known of it";
  options.initial->parameters[2].value += 20;
  const auto similar = solve(views, scenes::kSize, options);
  ASSERT_TRUE(similar.has_value());
  EXPECT_LT(similar->calibration.chi.value_or(0), 5);
  EXPECT_EQ(similar->calibration.misfit, "model");
  ASSERT_EQ(similar->calibration.remarks.size(), 1U);
  EXPECT_NE(similar->calibration.remarks[0].find("The picture is"), std::string::npos);
}

}  // namespace
}  // namespace calvin
