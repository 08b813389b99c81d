// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Streams of boards that move, rest and jump before a camera that a calibration holds of, or not:
// how often a change is told that is none, and how soon one that is.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "calvin/session/watch/calibration_watch.hpp"
#include "calvin/solve/solve.hpp"
#include "film.hpp"
#include "recheck_truth.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

using scenes::Film;
using scenes::frame;
using scenes::kBoard;
using scenes::kSize;
using scenes::Random;

// A camera and what was calibrated of it.
struct Calibrated {
  Camera camera;
  Calibration calibration;
};
Calibrated calibrated(int seed) {
  Random random(seed);
  const Camera camera = scenes::random_camera("brown5", random);
  const auto solution = solve(scenes::views_of(camera, random, 25, 0.05), kSize, {});
  return {camera, solution.value().calibration};
}

struct Told {
  int checks = 0;
  int changes = 0;   // checks that tell one
  int advice = 0;    // that ask for a calibration
  int first = -1;    // the first that tells one
  double sigma = 0;  // px, the last
};

// `longer`: times the focal length of the calibration.
Told watch(const Film& film, int seed, double longer = 1, bool knows_readout = false) {
  auto [camera, calibration] = calibrated(seed);
  for (Parameter& p : calibration.parameters) {
    if (p.name == "fx" || p.name == "fy") p.value *= longer;
  }
  if (knows_readout) {
    calibration.readout = film.readout;
    calibration.readout_sigma = 1e-5;
  }
  Random random(1000 + seed);
  const Motion motion(film.motion, camera, kBoard, static_cast<unsigned>(seed));
  CalibrationWatch watch(Camera::make(calibration).value(), calibration);
  Told told;
  for (int i = 0; i < film.seconds * film.rate; ++i) {
    // Of random poses one stands for each second.
    const bool is_random = film.motion == MotionKind::kRandom;
    Observation seen = frame(film, camera, motion, is_random ? i : i / film.rate, random);
    if (!seen.found()) continue;
    seen.timestamp = static_cast<std::uint64_t>(1e9 * i / film.rate);
    const auto report = watch.add({seen, kBoard}, 0);
    if (!report) continue;
    ++told.checks;
    told.changes += report->displacement > 0 ? 1 : 0;
    told.advice += advice(*report).empty() ? 0 : 1;
    if (told.first < 0 && report->displacement > 0) told.first = told.checks;
    told.sigma = report->displacement_sigma;
  }
  return told;
}

constexpr double kReadouts[] = {0, 0.015};  // s
constexpr MotionKind kMotions[] = {MotionKind::kHand, MotionKind::kOrbit, MotionKind::kStatic,
                                   MotionKind::kRandom};

TEST(CalibrationWatch, TellsOfNoChangeThatIsNone) {
  const int seeds = scenes::full_count() ? 12 : 1;
  Told all;
  for (const MotionKind motion : kMotions) {
    for (const double readout : kReadouts) {
      const bool rests = motion == MotionKind::kRandom || motion == MotionKind::kStatic;
      if (rests && readout > 0) continue;
      for (int seed = 0; seed < seeds; ++seed) {
        for (const bool knows_readout : {false, true}) {
          const Told told = watch({motion, readout, 4, 0.1}, seed, 1, knows_readout);
          all.checks += told.checks;
          all.changes += told.changes;
          all.advice += told.advice;
          EXPECT_GT(told.sigma, 0);
        }
      }
    }
  }
  EXPECT_GE(all.checks, 1000);
  EXPECT_LE(all.changes, all.checks / 150);
  EXPECT_LE(all.advice, all.checks / 10000);
}

// Half a percent of the focal length is noticed while the board is shown by hand, at once where it
// is shown in another place each time.
TEST(CalibrationWatch, ASmallChangeIsSoonNoticed) {
  for (int seed = 0; seed < 6; ++seed) {
    for (const double readout : kReadouts) {
      const Told shown = watch({MotionKind::kHand, readout, 5, 0.05}, seed, 1.005);
      EXPECT_GT(shown.changes, 5) << seed;
    }
    const Told placed = watch({MotionKind::kRandom, 0, 1, 0.05}, seed, 1.005);
    EXPECT_GE(placed.first, 0) << seed;
    EXPECT_LE(placed.first, 12) << seed;
  }
}

// A board that moves on leaves its views behind: what is known becomes more.
TEST(CalibrationWatch, ABoardThatMovesTellsMoreAndMore) {
  const double early = watch({MotionKind::kHand, 0, 0.5, 0.05}, 3).sigma;
  const double late = watch({MotionKind::kHand, 0, 10, 0.05}, 3).sigma;
  EXPECT_LT(late, early / 4);
}

// Frames without timestamps are stills.
TEST(CalibrationWatch, WithoutTimesEachFrameIsAView) {
  const auto [camera, calibration] = calibrated(1);
  Random random(5);
  CalibrationWatch watch(Camera::make(calibration).value(), calibration);
  double sigma = HUGE_VAL;
  for (View view : scenes::views_of(camera, random, 12, 0.05)) {
    view.observation.timestamp = kNoTimestamp;
    const auto report = watch.add(view, 0);
    ASSERT_TRUE(report);
    EXPECT_EQ(report->displacement, 0);
    sigma = std::min(sigma, report->displacement_sigma);
  }
  EXPECT_LT(sigma, 0.5);
}

}  // namespace
}  // namespace calvin
