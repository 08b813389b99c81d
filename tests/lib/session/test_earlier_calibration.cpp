// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Whether the calibration that is there already still holds, as a guided session says first.
#include "calvin/session/earlier_calibration.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "calvin/io/calibration_io.hpp"
#include "film.hpp"
#include "session_fixture.hpp"
#include "temporary_folder.hpp"

namespace calvin {
namespace {

class EarlierCalibrations : public CalibrationSessions {
 protected:
  // A job of a session that sees so many views by `now`, while a calibration made from 25 views by
  // `then` is there.
  static SolveJob job(const Camera& then, const Camera& now, int count, double noise = 0.03,
                      unsigned seed = 7) {
    scenes::Random random(seed);
    SolveOptions options;
    options.model = then.model();
    std::vector<View> before;
    for (const SE3& pose : scenes::random_poses(then, scenes::kBoard, random, 25)) {
      before.push_back(scenes::observe(then, scenes::kBoard, pose, noise, random));
    }
    SolveJob job;
    job.size = scenes::kSize;
    job.earlier = std::make_shared<const EarlierCalibration>(
        EarlierCalibration{calvin::solve(before, scenes::kSize, options)->calibration,
                           "The calibration in 'cam.json'"});
    for (const SE3& pose : scenes::random_poses(now, scenes::kBoard, random, count)) {
      job.views.push_back(
          std::make_shared<const View>(scenes::observe(now, scenes::kBoard, pose, noise, random)));
    }
    return job;
  }
  // Likewise, from what a session keeps of ten seconds of a board that a hand moves.
  static SolveJob film_job(const Camera& then, const Camera& now, double readout, unsigned seed) {
    SolveJob job = EarlierCalibrations::job(then, now, 0, 0.03, seed);
    scenes::Random random(seed + 1000);
    scenes::Film film;
    film.readout = readout;
    const Motion motion(film.motion, now, scenes::kBoard, seed);
    Session session({film.mode});
    for (int i = 0; i < film.seconds * film.rate; ++i) {
      const Observation seen = scenes::frame(film, now, motion, i / film.rate, random);
      if (seen.found()) session.offer({seen, scenes::kBoard});
    }
    job.views = session.views();
    job.options.readout = session.readout();
    return job;
  }
  static Camera with_focal_length(double f) {
    return Camera::make("pinhole", scenes::kSize, {f, f, 639.5, 479.5}).value();
  }
};

// Nobody is told to do again what is good.
TEST_F(EarlierCalibrations, ThatHoldAreGood) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    const auto verdict = judge_earlier(job(camera_, camera_, 12, 0.03, seed));
    ASSERT_TRUE(verdict.has_value());
    EXPECT_TRUE(verdict->holds) << seed << ": " << verdict->words;
    EXPECT_NE(verdict->words.find("'cam.json' still holds"), std::string::npos) << verdict->words;
    EXPECT_GT(verdict->report.displacement_sigma, 0);
  }
}

// A lens that was turned: a percent of the focal length is 6 px at the border of the picture.
TEST_F(EarlierCalibrations, ThatDoNotHoldAreNot) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    const auto verdict = judge_earlier(job(camera_, with_focal_length(1111), 8, 0.03, seed));
    ASSERT_TRUE(verdict.has_value());
    EXPECT_FALSE(verdict->holds) << seed << ": " << verdict->words;
    EXPECT_GT(verdict->report.displacement, 1);
    EXPECT_NE(verdict->words.find("does not hold any more"), std::string::npos) << verdict->words;
  }
}

// A board in a hand never rests, and nobody knows in what time the camera reads a frame. The
// verdict is that of the first views by which there is one.
TEST_F(EarlierCalibrations, AreJudgedByABoardThatMoves) {
  const unsigned films = scenes::full_count() ? 100 : 10;
  const auto moves = [](const auto& view) { return !view->observation.velocity.empty(); };
  for (const double readout : {0.0, 0.03}) {
    for (const double f : {1100.0, 1111.0}) {
      unsigned told = 0;
      unsigned right = 0;
      for (unsigned seed = 0; seed < films; ++seed) {
        SolveJob job = film_job(camera_, with_focal_length(f), readout, seed);
        const Session::Views views = std::exchange(job.views, {});
        EXPECT_GT(std::ranges::count_if(views, moves), 8) << seed;
        std::optional<EarlierVerdict> verdict;
        for (std::size_t i = 0; i < views.size() && !verdict; ++i) {
          job.views.push_back(views[i]);
          verdict = judge_earlier(job);
        }
        if (!verdict) continue;
        ++told;
        right += verdict->holds == (f == 1100) ? 1 : 0;
      }
      // One that holds is told once a fifth of the picture was seen, which takes such a hand long.
      EXPECT_GE(told, (f == 1100 ? 0.6 : 0.95) * films) << readout << " " << f;
      EXPECT_GE(right, 0.97 * told - 0.5) << readout << " " << f;
    }
  }
}

// Nor by views that would not show a change, nor by boards in one corner of the picture: it may be
// off in the others.
TEST_F(EarlierCalibrations, AreNotJudgedBeforeViewsTellEnough) {
  EXPECT_FALSE(judge_earlier(job(camera_, camera_, 4)).has_value());
  EXPECT_FALSE(judge_earlier(job(camera_, camera_, 6, 3)).has_value());
  EXPECT_FALSE(judge_earlier(job(camera_, camera_, 12, 3)).has_value());
  EXPECT_TRUE(judge_earlier(job(camera_, camera_, 20, 0.2)).has_value());
  SolveJob corner = job(camera_, camera_, 0);
  scenes::Random random(3);
  for (int i = 0; i < 12; ++i) {
    const SE3 pose = {exp_so3({0.5 * std::sin(2 * i), 0.5 * std::cos(2 * i), 0.1 * i}),
                      {-0.6 + 0.02 * std::sin(i), -0.4 + 0.02 * std::cos(i), 1.2}};
    corner.views.push_back(
        std::make_shared<const View>(scenes::observe(camera_, scenes::kBoard, pose, 0.03, random)));
  }
  EXPECT_FALSE(judge_earlier(corner).has_value());
}

TEST_F(EarlierCalibrations, OfAnotherCameraOrSizeSayNothing) {
  SolveJob other = job(camera_, camera_, 12);
  other.options.camera = "right";
  EXPECT_TRUE(judge_earlier(other).has_value()) << "the file names no camera";
  EarlierCalibration named = *other.earlier;
  named.calibration.camera = "left";
  other.earlier = std::make_shared<const EarlierCalibration>(named);
  EXPECT_FALSE(judge_earlier(other).has_value());
  other.options.camera = "left";
  EXPECT_TRUE(judge_earlier(other).has_value());
  other.size = {1280, 720};
  EXPECT_FALSE(judge_earlier(other).has_value());
  other.size = {640, 480};
  EXPECT_FALSE(judge_earlier(other).has_value()) << "it may show another part of the sensor";
  other.earlier = nullptr;
  EXPECT_FALSE(judge_earlier(other).has_value());
}

TEST_F(EarlierCalibrations, AreThatOfTheFileOrElseTheOneToStartFrom) {
  const TemporaryFolder folder;
  SessionSettings settings;
  EXPECT_EQ(find_earlier(settings, std::nullopt), nullptr);
  settings.location = folder.path("cam.json");
  EXPECT_EQ(find_earlier(settings, std::nullopt), nullptr);
  const Calibration initial = with_focal_length(900).to_calibration();
  ASSERT_NE(find_earlier(settings, initial), nullptr);
  EXPECT_EQ(find_earlier(settings, initial)->calibration.parameters[0].value, 900);
  ASSERT_TRUE(write_calibration(settings.location, camera_.to_calibration()));
  const auto found = find_earlier(settings, initial);
  ASSERT_NE(found, nullptr);
  EXPECT_EQ(found->calibration.parameters[0].value, 1100);
  EXPECT_NE(found->name.find("cam.json"), std::string::npos);
}

// It is told in the picture for four seconds, and once; a session that chooses its views itself is
// the only one that it is told in.
TEST_F(EarlierCalibrations, AreJudgedOnceInAGuidedSession) {
  for (const auto mode : {CaptureChoice::kAuto, CaptureChoice::kAll}) {
    settings_.capture_mode = mode;
    session_.start(make_plan(settings_).value(), true);
    session_.judge_first(std::make_shared<const EarlierCalibration>(
        EarlierCalibration{camera_.to_calibration(), "It"}));
    std::optional<Error> warning;
    EXPECT_TRUE(session_.set_size(scenes::kSize, warning));
    frame_ = 0;
    for (int i = 0; i < 3; ++i) {
      session_.capture_view();
      show(1);
    }
    const auto job = session_.take_solve();
    ASSERT_TRUE(job.has_value());
    EXPECT_EQ(job->earlier != nullptr, mode == CaptureChoice::kAuto);
    if (mode != CaptureChoice::kAuto) continue;
    EXPECT_TRUE(session_.judged(*job, "It is good."));
    EXPECT_EQ(session_.progress().hint, "It is good.");
    frame_ = 100;
    session_.capture_view();
    show(1);
    EXPECT_EQ(session_.progress().hint, "It is good.");
    EXPECT_EQ(session_.take_solve()->earlier, nullptr);
    frame_ = 140;
    show(1);
    EXPECT_NE(session_.progress().hint, "It is good.");
    session_.reset();
    EXPECT_FALSE(session_.judged(*job, "Too late."));
  }
}

}  // namespace
}  // namespace calvin
