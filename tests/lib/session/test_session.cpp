// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which views a session keeps, and what it asks for next.
#include <gtest/gtest.h>

#include "calvin/session/session.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

using scenes::kBoard;
using scenes::Random;

class Sessions : public ::testing::Test {
 protected:
  // The board's centre at (x, y) m, z m ahead, tilted by two angles.
  View see(double x, double y, double z, double about_x = 0, double about_y = 0) {
    const SE3 pose = {exp_so3({about_x, about_y, 0}), {0, 0, 0}};
    const Eigen::Vector3d center(0.1, 0.0625, 0);
    const SE3 placed = {pose.rotation, Eigen::Vector3d(x, y, z) - pose.rotation * center};
    return scenes::observe(camera_, kBoard, placed, 0.02, random_);
  }
  // Twice, so that it is seen to be still.
  static Reason hold(Session& session, const View& view) {
    session.offer(view);
    return session.offer(view);
  }

  Random random_{1};
  Camera camera_ = Camera::make("pinhole", scenes::kSize, {1100, 1100, 639.5, 479.5}).value();
};

TEST_F(Sessions, AllKeepsWhateverIsUsable) {
  Session session({CaptureMode::kAll, 3, 0});
  const View view = see(0, 0, 0.5);
  EXPECT_EQ(session.offer(view), Reason::kAccepted);
  EXPECT_EQ(session.offer(see(0, 0, 0.5)), Reason::kAccepted) << "with another noise";
  EXPECT_FALSE(session.complete());

  View none = view;
  none.observation.ids.clear();
  none.observation.uv.clear();
  EXPECT_EQ(session.offer(none), Reason::kNotFound);
  View few = view;
  few.observation.ids.resize(5);
  few.observation.uv.resize(5);
  EXPECT_EQ(session.offer(few), Reason::kTooFewPoints);
  View other = view;
  other.board = Checkerboard{3, 6, scenes::kSquares.size};
  EXPECT_EQ(session.offer(other), Reason::kWrongBoard);
  View large = view;
  large.observation.image_size = {1920, 1080};
  EXPECT_EQ(session.offer(large), Reason::kOffSize);
  EXPECT_EQ(session.views().size(), 2u);

  EXPECT_EQ(session.offer(see(0, 0, 0.5)), Reason::kAccepted);
  EXPECT_TRUE(session.complete());
  session.reset();
  EXPECT_EQ(session.offer(large), Reason::kAccepted);
}

TEST_F(Sessions, AutoWantsAStillLargeAndNewView) {
  Session session({CaptureMode::kAuto, 3, 0});
  const View first = see(0, 0, 0.5);
  EXPECT_EQ(session.offer(first), Reason::kMoving) << "nothing to compare with yet";
  EXPECT_EQ(session.offer(first), Reason::kAccepted);
  EXPECT_EQ(session.offer(first), Reason::kTooSimilar);
  EXPECT_EQ(session.offer(see(0.004, 0, 0.5)), Reason::kMoving);
  EXPECT_EQ(hold(session, see(0.02, 0.01, 0.5)), Reason::kTooSimilar);
  EXPECT_EQ(hold(session, see(0, 0, 4)), Reason::kTooSmall);
  EXPECT_EQ(hold(session, see(0.08, 0, 0.5)), Reason::kAccepted) << "elsewhere";
  EXPECT_EQ(hold(session, see(0, 0, 0.42)), Reason::kAccepted) << "nearer";
  EXPECT_EQ(hold(session, see(0, 0, 0.5, 0.5, 0)), Reason::kAccepted) << "tilted";
  EXPECT_EQ(hold(session, see(0, 0, 0.5, -0.5, 0)), Reason::kAccepted) << "tilted back";
  EXPECT_EQ(hold(session, see(0, 0, 0.5, 0, 0.5)), Reason::kAccepted) << "tilted sideways";
  EXPECT_EQ(session.views().size(), 6u);
}

TEST_F(Sessions, LosingTheBoardForgetsWhereItWas) {
  Session session({CaptureMode::kAuto, 3, 0});
  const View view = see(0, 0, 0.5);
  session.offer(view);
  View none = view;
  none.observation.ids.clear();
  none.observation.uv.clear();
  session.offer(none);
  EXPECT_EQ(session.offer(view), Reason::kMoving);
  EXPECT_EQ(session.offer(view), Reason::kAccepted);
}

TEST_F(Sessions, TwoBoardsInTurnAreComparedEachWithItself) {
  Session session({CaptureMode::kAuto, 3, 0});
  View one = see(-0.12, 0, 0.6);
  View two = see(0.12, 0, 0.6);
  two.board = Checkerboard{9, 6, 0.05};
  two.observation.board = two.board.text();
  session.offer(one);
  session.offer(two);
  EXPECT_EQ(session.offer(one), Reason::kAccepted);
  EXPECT_EQ(session.offer(two), Reason::kAccepted);
}

// One text, two sheets: whichever is offered first, each is held against where it was itself.
TEST_F(Sessions, EqualSheetsOfAFrameAreComparedEachWithItself) {
  for (const bool timed : {true, false}) {
    Session session({CaptureMode::kAuto, 3, 0});
    View one = see(-0.12, 0, 0.6);
    View two = see(0.12, 0, 0.6);
    std::uint64_t now = 0;
    const auto offer = [&](View view) {
      if (timed) view.observation.timestamp = now;
      return session.offer(view);
    };
    EXPECT_EQ(offer(one), Reason::kMoving);
    EXPECT_EQ(offer(two), Reason::kMoving) << "the sheet beside it says nothing of it";
    now += 33'000'000;
    EXPECT_EQ(offer(two), Reason::kAccepted);
    EXPECT_EQ(offer(one), Reason::kAccepted);
    now += 33'000'000;
    EXPECT_EQ(offer(one), Reason::kTooSimilar);
    EXPECT_EQ(offer(see(0.124, 0, 0.6)), Reason::kMoving) << "one of them moves";
  }
}

TEST_F(Sessions, ASheetThatComesBackIsNotHeldAgainstWhereItWasBefore) {
  Session session({CaptureMode::kAuto, 3, 0});
  View one = see(-0.12, 0, 0.6);
  View two = see(0.12, 0, 0.6);
  std::uint64_t now = 0;
  for (const bool both : {true, false, true, true}) {
    now += 33'000'000;
    one.observation.timestamp = two.observation.timestamp = now;
    session.offer(one);
    if (both) {
      EXPECT_EQ(session.offer(two), now == 132'000'000 ? Reason::kAccepted : Reason::kMoving);
    }
  }
}

TEST_F(Sessions, ManualKeepsWhatIsAskedFor) {
  Session session({CaptureMode::kManual, 2, 2});
  const View view = see(0, 0, 0.5);
  EXPECT_EQ(session.offer(view), Reason::kTooSimilar);
  session.capture_next();
  View none = view;
  none.observation.ids.clear();
  none.observation.uv.clear();
  EXPECT_EQ(session.offer(none), Reason::kNotFound) << "the request waits for a usable view";
  EXPECT_EQ(session.offer(view), Reason::kAccepted);
  EXPECT_EQ(session.offer(view), Reason::kTooSimilar);
  session.capture_next();
  EXPECT_EQ(session.offer(see(0, 0, 0.5)), Reason::kAccepted);
  EXPECT_TRUE(session.complete());
  session.capture_next();
  EXPECT_EQ(session.offer(see(0, 0, 0.5)), Reason::kTooSimilar) << "max-views";
}

TEST_F(Sessions, RemovingAViewTakesItsCoverageBack) {
  Session session({CaptureMode::kAll, 2, 0});
  session.offer(see(0, 0, 0.5));
  const Progress one = session.progress();
  session.offer(see(0.1, 0.05, 0.4));
  EXPECT_GT(session.progress().coverage, one.coverage);
  EXPECT_GT(session.progress().x, 0);
  EXPECT_FALSE(session.remove_view(2));
  EXPECT_TRUE(session.remove_view(1));
  const Progress back = session.progress();
  EXPECT_EQ(back.views, 1);
  EXPECT_EQ(back.coverage, one.coverage);
  EXPECT_EQ(back.x, one.x);
}

TEST_F(Sessions, CoverageIsThePartOfTheImageInsideOfTheBoards) {
  Session session({CaptureMode::kAll, 2, 0});
  EXPECT_EQ(session.progress().coverage, 0);
  session.offer(see(0, 0, 0.5));
  // 0.2 x 0.125 m at 0.5 m: 440 x 275 px of 1280 x 960, in cells of 80 x 80 px.
  EXPECT_NEAR(session.progress().coverage, 440 * 275 / (1280 * 960.0), 0.04);
}

TEST_F(Sessions, FollowingTheHintsCompletesTheSession) {
  Session session({CaptureMode::kAuto, 5, 0});
  struct Answer {
    const char* word;
    double x, y, z, about_x, about_y;
  };
  const Answer kAnswers[] = {
      {"whole board", 0, 0, 0.6, 0, 0},
      {"closer", 0, 0, 0.3, 0, 0},
      {"left edge", 0, 0, 0.4, 0, -0.6},
      {"right edge", 0, 0, 0.4, 0, 0.6},
      {"top edge", 0, 0, 0.4, 0.6, 0},
      {"bottom edge", 0, 0, 0.4, -0.6, 0},
      {"left side", -0.19, 0, 0.55, 0, 0},
      {"right side", 0.19, 0, 0.55, 0, 0},
      {"top of", 0, -0.16, 0.55, 0, 0},
      {"bottom of", 0, 0.16, 0.55, 0, 0},
      {"Tilt the board more", 0, 0, 0.45, 0.6, 0.6},
  };
  for (int step = 0; step < 20 && !session.complete(); ++step) {
    const std::string hint = session.progress().hint;
    const Answer* answer = nullptr;
    for (const Answer& a : kAnswers) {
      if (hint.find(a.word) != std::string::npos) answer = &a;
    }
    ASSERT_NE(answer, nullptr) << hint;
    const View view = see(answer->x, answer->y, answer->z, answer->about_x, answer->about_y);
    ASSERT_EQ(hold(session, view), Reason::kAccepted) << hint;
  }
  EXPECT_TRUE(session.complete()) << session.progress().hint;
  EXPECT_EQ(session.progress().size, 1);
}

// A camera that repeats its frames, a recording that is shown again, copies of a picture in a
// folder: whatever their times, they are one view.
TEST_F(Sessions, CopiesOfAPictureCountOnce) {
  Session session({CaptureMode::kAll, 3, 0});
  std::vector<View> pictures;
  for (int i = 0; i < 3; ++i) pictures.push_back(see(0, 0, 0.5));
  for (int n = 0; n < 9; ++n) {
    View copy = pictures[static_cast<std::size_t>(n % 3)];
    copy.observation.timestamp = static_cast<std::uint64_t>(n) * 33'000'000;
    // A detector that begins elsewhere ends elsewhere, by far less than the noise.
    for (Pixel& p : copy.observation.uv) p.u += 1e-3 * (n % 2);
    EXPECT_EQ(session.offer(copy), n < 3 ? Reason::kAccepted : Reason::kTooSimilar) << n;
  }
  EXPECT_EQ(session.views().size(), 3U);
  // Without sigmas nobody knows what is less than the noise.
  Session unknown({CaptureMode::kAll, 3, 0});
  View view = pictures.front();
  view.observation.sigma.clear();
  EXPECT_EQ(unknown.offer(view), Reason::kAccepted);
  EXPECT_EQ(unknown.offer(view), Reason::kTooSimilar);
  view.observation.uv.front().u += 1e-3;
  EXPECT_EQ(unknown.offer(view), Reason::kAccepted);
}

}  // namespace
}  // namespace calvin
