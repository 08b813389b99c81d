// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A board that never rests before a camera that reads row after row: what a session keeps, and what
// a solve makes of it, against the true camera and the true readout.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "calvin/session/session.hpp"
#include "calvin/solve/solve.hpp"
#include "film.hpp"
#include "scenes.hpp"
#include "true_error.hpp"

namespace calvin {
namespace {

using scenes::Film;
using scenes::frame;
using scenes::kFrames;

struct Outcome {
  std::size_t views = 0;
  Calibration calibration;
  double error = 0;  // px, the true one where corners were seen
};

// What comes of the film; without a result where the solve fails.
Outcome calibrate(const Film& film, unsigned seed, double readout_known = 0) {
  scenes::Random random(seed);
  const Camera camera = scenes::random_camera("brown5", random);
  const Motion motion(film.motion, camera, scenes::kBoard, seed);
  Session session({film.mode, 3, 0, readout_known});
  for (int i = 0; i < film.seconds * film.rate; ++i) {
    const Observation seen = frame(film, camera, motion, i / film.rate, random);
    if (seen.found()) session.offer({seen, scenes::kBoard});
  }
  Outcome outcome = {session.views().size(), {}, HUGE_VAL};
  std::vector<View> views;
  for (const auto& view : session.views()) views.push_back(*view);
  SolveOptions options;
  options.readout = session.readout();
  const auto solution = solve(views, camera.image_size(), options);
  if (!solution) {
    ADD_FAILURE() << solution.error().message;
    return outcome;
  }
  outcome.calibration = solution->calibration;
  outcome.error = scenes::worst_error(outcome.calibration, camera, outcome.calibration.covered);
  return outcome;
}

// Of many films: how many promises are kept (2 x, where corners were seen) and how many readouts
// lie within 3 of their sigmas.
struct Count {
  int films = 0;
  int kept = 0;
  int readout = 0;
  double widest = 0;          // s, the largest sigma of a readout
  std::size_t fewest = 1000;  // views
};

Count count(const Film& film, int films) {
  Count count;
  for (int seed = 0; seed < films; ++seed) {
    const Outcome outcome = calibrate(film, static_cast<unsigned>(seed));
    const Calibration& found = outcome.calibration;
    const double sigma = found.readout_sigma.value_or(0);
    ++count.films;
    count.kept += outcome.error <= 2 * found.expected_error.value_or(0) ? 1 : 0;
    count.readout += std::abs(found.readout.value_or(HUGE_VAL) - film.readout) <= 3 * sigma ? 1 : 0;
    count.widest = std::max(count.widest, sigma);
    count.fewest = std::min(count.fewest, outcome.views);
    EXPECT_EQ(found.misfit, "none") << seed;
  }
  return count;
}

class MovingBoards : public testing::TestWithParam<Film> {};

TEST_P(MovingBoards, AreCalibratedFromWithinTheirPromise) {
  const Count all = count(GetParam(), scenes::full_count() ? 100 : 12);
  EXPECT_GE(all.fewest, 10U);
  EXPECT_GE(all.kept, 0.88 * all.films);
  EXPECT_GE(all.readout, 0.95 * all.films - 1);
  if (GetParam().motion == MotionKind::kHand) {
    EXPECT_LT(all.widest, 0.5e-3);
  } else {
    EXPECT_GT(all.widest, 0.5e-3) << "an orbit hardly tells the readout, which the sigma says";
  }
}

INSTANTIATE_TEST_SUITE_P(Films, MovingBoards,
                         testing::Values(Film{MotionKind::kHand, 0.02}, Film{MotionKind::kHand, 0},
                                         Film{MotionKind::kOrbit, 0.02},
                                         Film{MotionKind::kOrbit, 0}));

// All frames of a recording, none refused: 900 of 30 s.
TEST(Recordings, OfAMovingBoardAreCalibratedFrom) {
  const Film film = {MotionKind::kHand, 0.02, scenes::full_count() ? 30.0 : 10.0, 0.05,
                     CaptureMode::kAll};
  const Count all = count(film, scenes::full_count() ? 20 : 3);
  EXPECT_EQ(all.fewest, static_cast<std::size_t>(film.seconds * kFrames));
  EXPECT_GE(all.kept, 0.88 * all.films - 1);
  EXPECT_GE(all.readout, 0.95 * all.films - 1);
}

// From stills, and from a few frames a second, nobody knows how a board moved while one was read:
// their corners are as exact as they are said to be, and none contradicts the others.
TEST(Recordings, OfFewFramesASecondAreTakenAsTheyAre) {
  for (const double rate : {0.5, 4.0, 5.0, 6.0, 8.0}) {
    for (unsigned seed = 1; seed < 4; ++seed) {
      Film film;
      film.seconds = 40 / rate;
      film.mode = CaptureMode::kAll;
      film.rate = rate;
      const Outcome outcome = calibrate(film, seed);
      const Calibration& found = outcome.calibration;
      EXPECT_EQ(outcome.views, 40U);
      EXPECT_EQ(found.views.size(), outcome.views) << rate << " " << seed;
      EXPECT_FALSE(found.readout.has_value()) << rate;
      EXPECT_NEAR(found.chi.value_or(0), 1, 0.1) << rate << " " << seed;
      EXPECT_LT(outcome.error, 1.5 * found.expected_error.value_or(0)) << rate << " " << seed;
    }
  }
}

// A corner of which nobody knows how exact it is stays such a corner where the board moves.
TEST(UnknownSigmas, StayUnknown) {
  const Film film = {MotionKind::kHand, 0.02, 2, 0.05, CaptureMode::kAll};
  scenes::Random random(1);
  const Camera camera = scenes::random_camera("brown5", random);
  const Motion motion(film.motion, camera, scenes::kBoard, 1);
  Session session({film.mode});
  bool moves = false;
  for (int i = 0; i < film.seconds * kFrames; ++i) {
    Observation seen = frame(film, camera, motion, i / kFrames, random);
    if (!seen.found()) continue;
    seen.sigma.assign(seen.uv.size(), 0);
    session.offer({seen, scenes::kBoard});
  }
  for (const auto& view : session.views()) {
    moves |= !view->observation.velocity.empty();
    for (const double sigma : view->observation.sigma) ASSERT_EQ(sigma, 0);
  }
  EXPECT_TRUE(moves);
}

// What a user knows is not estimated.
TEST(KnownReadouts, AreTaken) {
  const Outcome outcome = calibrate({MotionKind::kHand, 0.02}, 3, 0.02);
  EXPECT_EQ(outcome.calibration.readout, 0.02);
  EXPECT_FALSE(outcome.calibration.readout_sigma);
  EXPECT_LT(outcome.error, 2 * outcome.calibration.expected_error.value());
}

// Such as one in another unit.
TEST(KnownReadouts, AreNoLongerThanAFrame) {
  for (const double readout : {0.0, 0.033, 0.2}) {
    scenes::Random random(1);
    const Camera camera = scenes::random_camera("brown5", random);
    const Motion motion(MotionKind::kHand, camera, scenes::kBoard, 1);
    Session session({CaptureMode::kAll, 3, 0, readout});
    for (int i = 0; i < 20; ++i) {
      session.offer({frame({}, camera, motion, i / kFrames, random), scenes::kBoard});
    }
    EXPECT_EQ(session.readout_doubt().has_value(), readout > 0.1) << readout;
  }
}

TEST(KnownReadouts, ThatAreWrongAreNoticed) {
  const Outcome outcome = calibrate({MotionKind::kHand, 0.02}, 3, 0.01);
  EXPECT_GT(outcome.calibration.chi.value(), 1.15);
}

}  // namespace
}  // namespace calvin
