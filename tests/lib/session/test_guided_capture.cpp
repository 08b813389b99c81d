// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// When a guided session takes a view: who brings the board to where it is asked for is waited for,
// who does not is not.
#include <gtest/gtest.h>

#include "calvin/session/guidance/guided_capture.hpp"

namespace calvin {
namespace {

constexpr double kSecond = 1e9;  // ns

std::uint64_t at(double seconds) { return static_cast<std::uint64_t>(100e9 + seconds * kSecond); }

TEST(GuidedCapture, TakesAnythingFirst) {
  GuidedCapture capture;
  const ViewWorth first = capture.worth(std::nullopt, at(0));
  EXPECT_TRUE(first.still);
  EXPECT_FALSE(first.moving);
  EXPECT_FALSE(first.restless) << "views of one movement are alike";
  EXPECT_TRUE(capture.worth(std::nullopt, at(0.6)).restless);
}

TEST(GuidedCapture, DoesNotWaitWithoutTimes) {
  GuidedCapture capture;
  const ViewWorth worth = capture.worth(NearView{0, 100}, kNoTimestamp);
  EXPECT_TRUE(worth.still && worth.moving && worth.restless);
}

// A board that comes nearer all the time, and tells the more the nearer it is.
TEST(GuidedCapture, WaitsForWhoFollows) {
  GuidedCapture capture;
  capture.restart(at(0));
  for (double t = 0.1; t < 3.5; t += 0.1) {
    const ViewWorth worth = capture.worth(NearView{0.1 * t, 500 - 100 * t}, at(t));
    EXPECT_FALSE(worth.moving || worth.restless) << t;
    // After so long less will do for a board that is held still.
    EXPECT_EQ(worth.still, 0.1 * t >= 0.8 * (1 - t / 8)) << t;
  }
  EXPECT_FALSE(capture.worth(NearView{0.9, 90}, at(3.6)).moving) << "it still comes nearer";
  EXPECT_TRUE(capture.worth(NearView{0.6, 110}, at(3.7)).moving) << "it has passed by";
}

TEST(GuidedCapture, DoesNotWaitForWhoDoesNotFollow) {
  GuidedCapture capture;
  capture.restart(at(0));
  for (double t = 0.1; t < 1.5; t += 0.1) {
    EXPECT_FALSE(capture.worth(NearView{0.1, 300}, at(t)).restless) << t;
  }
  EXPECT_TRUE(capture.worth(NearView{0.1, 300}, at(1.7)).restless);
  // Nobody becomes a follower by a view that was taken.
  capture.restart(at(1.7));
  EXPECT_FALSE(capture.worth(NearView{0.1, 300}, at(2.1)).restless) << "of one movement";
  EXPECT_TRUE(capture.worth(NearView{0.1, 310}, at(2.3)).restless);
  // Who comes much nearer is one.
  EXPECT_FALSE(capture.worth(NearView{0.3, 200}, at(2.4)).restless);
}

// A hand that never rests gives a view in the end; one that tells less is still waited for.
TEST(GuidedCapture, DoesNotInsistOnARest) {
  GuidedCapture capture;
  capture.restart(at(0));
  for (double t = 0.1; t < 4; t += 0.1) {
    EXPECT_FALSE(capture.worth(NearView{0.8, 500 - 50 * t}, at(t)).moving) << t;
  }
  EXPECT_TRUE(capture.worth(NearView{0.8, 295}, at(4.1)).moving);
  EXPECT_FALSE(capture.worth(NearView{0.4, 290}, at(4.2)).moving);
  EXPECT_TRUE(capture.worth(NearView{0.1, 280}, at(8.1)).moving) << "anything new is welcome now";
}

// What was waited for one view counts for another one that is asked for instead.
TEST(GuidedCapture, GoesOnWaitingForAnotherView) {
  GuidedCapture capture;
  capture.restart(at(0));
  EXPECT_FALSE(capture.worth(NearView{0.15, 300}, at(5)).still);
  capture.change_target(at(5));
  EXPECT_TRUE(capture.worth(NearView{0.15, 300}, at(7)).still);
  capture.restart(at(7));
  EXPECT_FALSE(capture.worth(NearView{0.15, 300}, at(8)).still);
}

// A stream that begins anew.
TEST(GuidedCapture, BeginsAnewWhereTimeGoesBack) {
  GuidedCapture capture;
  capture.restart(at(50));
  EXPECT_FALSE(capture.worth(NearView{0.3, 200}, at(0)).still);
  EXPECT_TRUE(capture.worth(NearView{0.3, 200}, at(7)).still);
}

}  // namespace
}  // namespace calvin
