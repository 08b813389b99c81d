// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Recheck: silent about a camera that is still the same, and right about one that is not.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "calvin/solve/recheck.hpp"
#include "recheck_truth.hpp"

namespace calvin {
namespace {

using scenes::kBoard;
using scenes::kSize;
using scenes::Random;
using scenes::true_change;
using scenes::views_of;

class EveryModel : public ::testing::TestWithParam<std::string_view> {};
INSTANTIATE_TEST_SUITE_P(Recheck, EveryModel, ::testing::ValuesIn(scenes::kSolvedModels),
                         [](const auto& test) { return std::string(test.param); });

// The corners of a view claim a noise of 0.1 px; what they have is another matter.
TEST_P(EveryModel, AnUnchangedCameraHasNotMoved) {
  for (const double sigma : {0.02, 0.1, 0.3}) {
    int alarms = 0;
    const int kSessions = scenes::full_count() ? 200 : 20;
    for (int session = 0; session < kSessions; ++session) {
      Random random(session);
      const Camera camera = scenes::random_camera(GetParam(), random);
      SolveOptions options;
      options.model = GetParam();
      const auto solution = solve(views_of(camera, random, 25, sigma), kSize, options);
      ASSERT_TRUE(solution) << solution.error().message;
      const Camera calibrated = Camera::make(solution->calibration).value();
      Recheck recheck(calibrated, solution->calibration);
      double moved = 0;
      double rms = 0;
      for (View view : views_of(camera, random, 15, sigma)) {
        for (double& s : view.observation.sigma) s = 0.1;
        const auto report = recheck.add(view);
        ASSERT_TRUE(report);
        moved = report->displacement;
        rms = report->rms;
        EXPECT_EQ(report->points, 54);
      }
      EXPECT_NEAR(rms, std::sqrt(2.0) * sigma, 0.5 * sigma);
      alarms += moved > 0;
    }
    // One session in twenty, and two standard deviations of such a count.
    EXPECT_LE(alarms, kSessions / 20.0 + 2 * std::sqrt(kSessions / 20.0 * 0.95)) << sigma;
  }
}

// A board that bends by 0.5 mm, which the calibration has found out.
TEST(Recheck, ABentBoardIsNoChangeOfTheCamera) {
  constexpr double kBend = 0.5e-3;
  const auto bend = [](View& view, const Camera& camera, const SE3& pose, Random& random) {
    std::normal_distribution<double> noise(0, 0.05);
    const auto points = view.board.points();
    for (std::size_t i = 0; i < view.observation.ids.size(); ++i) {
      Eigen::Vector3d point = points[static_cast<std::size_t>(view.observation.ids[i])];
      const double x = 2 * point.x() / points.back().x() - 1;
      point.z() = kBend * (1 - x * x);
      const Pixel at = camera.project(pose * point).value();
      view.observation.uv[i] = {at.u + noise(random), at.v + noise(random)};
    }
    view.observation.sigma.assign(view.observation.ids.size(), 0.05);
  };
  int alarms = 0;
  constexpr int kSessions = 20;
  for (int session = 0; session < kSessions; ++session) {
    Random random(session);
    const Camera camera = scenes::random_camera("brown5", random);
    const auto bent_views = [&](int count) {
      std::vector<View> views;
      for (const SE3& pose : scenes::random_poses(camera, kBoard, random, count)) {
        views.push_back(scenes::observe(camera, kBoard, pose, 0, random));
        bend(views.back(), camera, pose, random);
      }
      return views;
    };
    const auto solution = solve(bent_views(25), kSize, {});
    ASSERT_TRUE(solution && solution->calibration.warp);
    Recheck recheck(Camera::make(solution->calibration).value(), solution->calibration);
    double moved = 0;
    for (const View& view : bent_views(15)) {
      const auto report = recheck.add(view);
      ASSERT_TRUE(report);
      moved = report->displacement;
      EXPECT_LT(report->rms, 0.1);
    }
    alarms += moved > 0;
  }
  EXPECT_LE(alarms, kSessions / 20);
}

TEST_P(EveryModel, AChangedCameraHasMovedByWhatItHas) {
  for (int session = 0; session < 20; ++session) {
    Random random(session);
    const Camera camera = scenes::random_camera(GetParam(), random);
    std::vector<double> p = camera.parameters();
    p[0] *= 1.01;
    p[1] *= 1.01;
    p[2] += 5;
    p[3] -= 3;
    if (p.size() > 4) p[4] += scenes::is_wide(GetParam()) ? 0.001 : 0.005;
    const Camera now = Camera::make(GetParam(), kSize, p).value();
    const auto views = views_of(now, random, 20, 0.05);
    const double truth = true_change(camera, now, views);
    Recheck recheck(camera, camera.to_calibration());
    double moved = 0;
    for (const View& view : views) {
      const auto report = recheck.add(view);
      ASSERT_TRUE(report);
      moved = report->displacement;
    }
    EXPECT_NEAR(moved, truth, 0.2 * truth) << session;
  }
}

Camera with_skew(const Camera& camera, double skew) {
  return Camera::make(camera.model(), camera.image_size(), camera.parameters(), skew).value();
}

// The covariance counts for a calibration that has a skew too: what few views left unsure is no
// change of the camera.
TEST(Recheck, OfACameraWithSkewTakesItsCovarianceIntoAccount) {
  constexpr int kSessions = 30;
  int alarms = 0;
  for (int session = 0; session < kSessions; ++session) {
    Random random(session);
    const Camera camera = with_skew(scenes::random_camera("brown4", random), 2);
    SolveOptions options;
    options.model = "brown4";
    options.skew = true;
    const auto solution = solve(views_of(camera, random, 6, 0.1), kSize, options);
    ASSERT_TRUE(solution) << solution.error().message;
    Recheck recheck(Camera::make(solution->calibration).value(), solution->calibration);
    double moved = 0;
    for (const View& view : views_of(camera, random, 25, 0.1))
      moved = recheck.add(view)->displacement;
    alarms += moved > 0;
  }
  EXPECT_LE(alarms, kSessions / 10);
}

TEST(Recheck, ASkewThatChangedHasMoved) {
  Random random(21);
  const Camera plain = scenes::random_camera("brown5", random);
  const Camera camera = with_skew(plain, 1);
  const Camera now = with_skew(plain, 7);
  Calibration calibration = camera.to_calibration();
  for (Parameter& p : calibration.parameters) p.sigma = 1e-6;
  const auto views = views_of(now, random, 20, 0.05);
  const double truth = true_change(camera, now, views);
  Recheck recheck(camera, calibration);
  double moved = 0;
  for (const View& view : views) moved = recheck.add(view)->displacement;
  EXPECT_NEAR(moved, truth, 0.15 * truth);
}

// A calibration of the same camera at another size, by the conventions of docs/conventions.md: what
// is along the rows grows with them.
Calibration scaled_by_hand(Calibration c, ImageSize size, double sx, double sy) {
  c.image_size = size;
  std::vector<double> factors;  // of what is estimated
  for (Parameter& p : c.parameters) {
    double factor = 1;
    if (p.name == "fx" || p.name == "cx" || p.name == "skew") factor = sx;
    if (p.name == "fy" || p.name == "cy") factor = sy;
    const double centre = p.name == "cx" || p.name == "cy" ? 0.5 : 0;
    p.value = factor * (p.value + centre) - centre;
    if (!p.sigma) continue;
    *p.sigma *= factor;
    factors.push_back(factor);
  }
  for (std::size_t i = 0; i < factors.size(); ++i) {
    for (std::size_t k = 0; k < factors.size(); ++k) {
      c.covariance[i * factors.size() + k] *= factors[i] * factors[k];
    }
  }
  return c;
}

// What the calibration does not know of the camera is told in pixels of the frames that are looked
// at, whatever the size that it was made at. From few views it knows little.
TEST(Recheck, AtAnotherSizeTheCovarianceIsTheSame) {
  Random random(23);
  const Camera camera = with_skew(scenes::random_camera("brown4", random), 1);
  SolveOptions options;
  options.model = "brown4";
  options.skew = true;
  const Calibration calibration =
      solve(views_of(camera, random, 5, 1), kSize, options)->calibration;
  std::vector<double> p = camera.parameters();
  p[0] *= 1.03;
  p[1] *= 1.02;
  p[2] += 25;
  p[3] -= 30;
  const Camera now = Camera::make("brown4", kSize, p, 8).value();
  const auto views = views_of(now, random, 12, 0.05);
  for (const ImageSize size : {kSize, ImageSize{640, 480}, ImageSize{1280, 480}, {320, 480}}) {
    const double sx = 1.0 * size.width / kSize.width;
    const double sy = 1.0 * size.height / kSize.height;
    const Calibration own = scaled_by_hand(calibration, size, sx, sy);
    const Camera of_frames = Camera::make(own).value();
    Recheck scaled(of_frames, calibration);
    Recheck made_so(of_frames, own);
    Calibration sure = own;
    sure.covariance.clear();
    Recheck certain(of_frames, sure);
    RecheckReport found;
    RecheckReport expected;
    RecheckReport surest;
    for (View view : views) {
      view.observation.image_size = size;
      for (Pixel& at : view.observation.uv) {
        at = {sx * (at.u + 0.5) - 0.5, sy * (at.v + 0.5) - 0.5};
      }
      found = scaled.add(view).value();
      expected = made_so.add(view).value();
      surest = certain.add(view).value();
    }
    const auto message = fmt::format("{}x{}", size.width, size.height);
    EXPECT_NEAR(found.displacement_sigma / expected.displacement_sigma, 1, 1e-9) << message;
    EXPECT_GT(found.displacement_sigma, 2 * surest.displacement_sigma) << message;
    EXPECT_NEAR(found.displacement, expected.displacement, 1e-9) << message;
    EXPECT_GT(surest.displacement, 0) << message;
  }
}

TEST_P(EveryModel, TheReportedPoseIsThatOfTheBoard) {
  Random random(3);
  const Camera camera = scenes::random_camera(GetParam(), random);
  const SE3 pose = scenes::random_pose(camera, kBoard, random, 0.5);
  Recheck recheck(camera, camera.to_calibration());
  const auto report = recheck.add(scenes::observe(camera, kBoard, pose, 0, random));
  ASSERT_TRUE(report);
  const Pose truth = to_pose(pose);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(report->camera_from_board.rotation[i], truth.rotation[i], 1e-6);
    EXPECT_NEAR(report->camera_from_board.translation[i], truth.translation[i], 1e-6);
  }
  EXPECT_LT(report->rms, 1e-6);
  EXPECT_LT(report->displacement, 1e-3);
}

// The errors of a still board are the same in every frame: they must not add up to a proof.
TEST(Recheck, AStillBoardIsOneView) {
  Random random(7);
  const Camera camera = scenes::random_camera("brown5", random);
  const SE3 pose = scenes::random_pose(camera, kBoard, random, 0.5);
  const View view = scenes::observe(camera, kBoard, pose, 0.1, random);
  Recheck recheck(camera, camera.to_calibration());
  const double once = recheck.add(view)->displacement;
  for (int i = 0; i < 100; ++i) EXPECT_NEAR(recheck.add(view)->displacement, once, 1e-9);
}

// What was seen longest ago gives way: a lens that was turned since is judged by what it shows now.
TEST(Recheck, TheLatestViewsCount) {
  Random random(8);
  const Camera camera = scenes::random_camera("brown4", random);
  std::vector<double> p = camera.parameters();
  p[0] *= 1.02;
  p[1] *= 1.02;
  p[3] += 8;
  const Camera now = Camera::make("brown4", kSize, p).value();
  Recheck recheck(camera, camera.to_calibration());
  double moved = 0;
  for (const View& view : views_of(camera, random, 30, 0.05))
    moved = recheck.add(view)->displacement;
  EXPECT_EQ(moved, 0);
  const auto views = views_of(now, random, 60, 0.05);
  const double truth = true_change(camera, now, views);
  for (const View& view : views) moved = recheck.add(view)->displacement;
  EXPECT_NEAR(moved, truth, 0.1 * truth);
}

// A calibration that no ray leads to the picture of is valid in form: nothing can be told of it.
TEST(Recheck, OfACameraThatSeesNothingTellsNothing) {
  Random random(5);
  const Camera blind = Camera::make("eucm", kSize, {1, 320, 0.001, 1e12, 0.1, 1}).value();
  Recheck recheck(blind, blind.to_calibration());
  const Camera camera = scenes::random_camera("pinhole", random);
  for (const View& view : views_of(camera, random, 300, 0.05)) {
    const auto report = recheck.add(view);
    EXPECT_EQ(report ? report->displacement : 0, 0);
  }
}

// How the board of the calibration was bent says nothing of another one.
TEST(Recheck, AnotherBoardIsFlat) {
  const Board other = Checkerboard{7, 6, 0.03};
  Random random(9);
  const Camera camera = scenes::random_camera("brown4", random);
  Calibration calibration = camera.to_calibration();
  calibration.board = kBoard.text();
  calibration.warp = BoardWarp{2e-3, -1e-3, {}, {}};
  Recheck recheck(camera, calibration);
  for (const SE3& pose : scenes::random_poses(camera, other, random, 10)) {
    const auto report = recheck.add(scenes::observe(camera, other, pose, 0, random));
    ASSERT_TRUE(report);
    EXPECT_LT(report->rms, 1e-6);
    EXPECT_LT(report->displacement, 1e-3);
  }
  // And that of the calibration is not.
  const SE3 pose = scenes::random_pose(camera, kBoard, random, 0.5);
  EXPECT_GT(recheck.add(scenes::observe(camera, kBoard, pose, 0, random))->rms, 0.1);
}

TEST(Recheck, AFrameOfAnotherSizeIsRefused) {
  Random random(1);
  const Camera camera = scenes::random_camera("brown5", random);
  Recheck recheck(camera, camera.to_calibration());
  View view =
      scenes::observe(camera, kBoard, scenes::random_pose(camera, kBoard, random, 0.3), 0, random);
  view.observation.image_size = {640, 480};
  const auto report = recheck.add(view);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace calvin
