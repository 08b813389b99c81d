// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a session makes of the order of frames: those without a board, copies of one, several boards
// in turn, those of another size.

#include "session_fixture.hpp"

namespace calvin {
namespace {

class SessionFrames : public CalibrationSessions {
 protected:
  void begin_auto() {
    begin();
    SessionSettings settings = settings_;
    settings.capture_mode = CaptureChoice::kAuto;
    set(settings);
  }
  // The board of scene 0 on the frame n, `right` px to the right.
  Observation at(int n, double right = 0) {
    Observation o = seen(0);
    for (Pixel& p : o.uv) p.u += right;
    o.timestamp = times(n).timestamp;
    return o;
  }
  Reason offer(const Observation& o, int n) { return session_.offer(o, times(n)).reason; }
  void lose(int n) {
    Observation none = at(n);
    none.ids.clear();
    none.uv.clear();
    none.sigma.clear();
    EXPECT_EQ(session_.offer(none, times(n)).reason, Reason::kNotFound);
  }
};

// In a second the board may move a lot and be still: while it was away nobody knows what it did.
TEST_F(SessionFrames, KnowThatTheBoardWasAway) {
  begin_auto();
  for (int n = 0; n < 3; ++n) {
    EXPECT_EQ(offer(at(n, 2 * n * n - 4), n), Reason::kMoving) << n << ": ever faster";
  }
  for (int n = 3; n < 30; ++n) lose(n);
  EXPECT_EQ(offer(at(30, 2), 30), Reason::kMoving);
  EXPECT_EQ(offer(at(31, 2), 31), Reason::kAccepted);
}

// Whoever moves it evenly does not show what was seen before: nothing was taken.
TEST_F(SessionFrames, AskABoardThatMovesEvenlyToBeStill) {
  begin_auto();
  for (int n = 0; n < 20; ++n) {
    EXPECT_EQ(offer(at(n, 1.0 * n), n), Reason::kMoving) << n;
    EXPECT_EQ(session_.progress().hint, to_text(Hint{HintKind::kHoldStill})) << n;
  }
}

TEST_F(SessionFrames, SayThatViewsHaveToBeAskedFor) {
  begin();
  SessionSettings settings = settings_;
  settings.capture_mode = CaptureChoice::kManual;
  set(settings);
  EXPECT_EQ(offer(at(0), 0), Reason::kTooSimilar);
  EXPECT_NE(session_.progress().hint.find("capture-view"), std::string::npos);
  session_.capture_view();
  EXPECT_EQ(offer(at(1, 0.1), 1), Reason::kAccepted);
  EXPECT_EQ(session_.progress().hint.find("capture-view"), std::string::npos);
}

// "Show the whole board" would be no answer to who does.
TEST_F(SessionFrames, AskABoardThatMovesToBeStill) {
  const auto hint = [this] { return session_.progress().hint; };
  begin_auto();
  lose(0);
  EXPECT_EQ(hint(), to_text(Hint{HintKind::kShowBoard}));
  EXPECT_EQ(offer(at(1), 1), Reason::kMoving);
  EXPECT_EQ(hint(), to_text(Hint{HintKind::kHoldStill}));
  lose(2);
  EXPECT_EQ(hint(), to_text(Hint{HintKind::kShowBoard}));
  offer(at(3), 3);
  EXPECT_EQ(offer(at(4), 4), Reason::kAccepted);
  EXPECT_NE(hint(), to_text(Hint{HintKind::kHoldStill}));
  EXPECT_EQ(offer(at(60, 200), 60), Reason::kMoving);
  EXPECT_NE(hint(), to_text(Hint{HintKind::kHoldStill})) << "from then on the guide leads";
}

// What passes while nothing is captured is as good as away.
TEST_F(SessionFrames, CompareWithNothingOfBeforeAPause) {
  begin_auto();
  SessionSettings settings = settings_;
  settings.min_views = settings.max_views = 2;
  set(settings);
  for (const int n : {0, 1}) offer(at(n), n);
  for (const int n : {2, 3}) offer(at(n, 150), n);
  ASSERT_EQ(session_.views().views().size(), 2u);
  EXPECT_FALSE(session_.offer(at(4, 150), times(4)).report) << "nothing is captured";
  settings.max_views = 0;
  set(settings);
  EXPECT_EQ(offer(at(100, 300), 100), Reason::kMoving);
}

// Elements that make a frame into several, as videorate does, copy what was found on it.
TEST_F(SessionFrames, TakeNoCopyOfAFrameForAnother) {
  begin_auto();
  for (int copy = 0; copy < 4; ++copy) EXPECT_NE(offer(at(0), copy), Reason::kAccepted) << copy;
  EXPECT_EQ(offer(at(4), 4), Reason::kAccepted) << "that is another frame, on which it is still";
  begin();
  EXPECT_EQ(offer(at(0), 0), Reason::kAccepted);
  EXPECT_EQ(offer(at(0), 1), Reason::kTooSimilar);
  EXPECT_EQ(session_.views().views().size(), 1u);
  // A camera that stamps all of its frames with one time has noise in them.
  EXPECT_EQ(offer(at(0, 0.1), 2), Reason::kAccepted);
}

TEST_F(SessionFrames, TakeACopyThatIsAskedForOnce) {
  begin_auto();
  EXPECT_EQ(offer(at(0), 0), Reason::kMoving);
  for (const Reason reason : {Reason::kAccepted, Reason::kTooSimilar}) {
    session_.capture_view();
    EXPECT_EQ(offer(at(0), 1), reason);
  }
}

// ---- Several boards -----------------------------------------------------------------------------

TEST_F(SessionFrames, WantOneOfTheBoardsThatAreSeenInTurn) {
  begin_auto();
  Observation other = at(0);
  other.board = Checkerboard{9, 6, 0.1}.text();
  offer(at(0), 0);
  const auto first = session_.hint().target;
  ASSERT_TRUE(first.has_value());
  for (int n = 1; n < 40; ++n) {
    Observation now = n % 2 == 1 ? other : at(n);
    now.timestamp = times(n).timestamp;
    offer(now, n);
    ASSERT_TRUE(session_.hint().target.has_value());
    if (session_.views().views().empty()) {
      EXPECT_EQ(session_.hint().target->translation, first->translation) << n;
    }
  }
  session_.reset();
  EXPECT_EQ(session_.hint().target->translation, first->translation);
  // It is gone for good.
  for (int n = 40; n < 80; ++n) {
    Observation now = other;
    for (Pixel& p : now.uv) p.u += n;  // never still
    now.timestamp = times(n).timestamp;
    offer(now, n);
  }
  EXPECT_GT(session_.hint().target->translation[2], 2 * first->translation[2])
      << "the other board is four times as large";
}

TEST_F(SessionFrames, ThatGaveNoViewAreToldWithWhy) {
  begin_auto();
  for (int n = 0; n < 12; ++n) offer(at(n, n % 2 == 0 ? 9 : 0), n);
  const std::string moved = session_.verdict().status.error().message;
  EXPECT_NE(moved.find("no view of the board was taken"), std::string::npos) << moved;
  EXPECT_NE(moved.find("A board was seen 12 times and not taken, since it moved"),
            std::string::npos)
      << moved;
  session_.reset();
  const std::string none = session_.verdict().status.error().message;
  EXPECT_EQ(none.find("A board was seen"), std::string::npos) << none;
}

// Frames of another size and back: downstream goes on with what was solved of that size, and need
// not stretch the other one until the views are solved anew.
TEST_F(SessionFrames, OfAnEarlierSizeHaveWhatWasSolvedOfThem) {
  begin();
  constexpr ImageSize size = scenes::kSize;
  show(4);
  const auto job = session_.take_solve();
  ASSERT_TRUE(job.has_value());
  Solution solution = found(*job, 0.1);
  solution.calibration.image_size = size;
  ASSERT_TRUE(session_.solved(*job, solution).has_value());
  EXPECT_TRUE(session_.take_announcement().has_value());
  std::optional<Error> warning;
  EXPECT_TRUE(session_.set_size({320, 240}, warning));
  EXPECT_FALSE(session_.take_announcement().has_value());
  EXPECT_TRUE(session_.set_size(size, warning));
  const auto again = session_.take_announcement();
  ASSERT_TRUE(again.has_value());
  EXPECT_EQ(again->image_size, size);
  session_.reset();
  EXPECT_TRUE(session_.set_size({320, 240}, warning));
  EXPECT_TRUE(session_.set_size(size, warning));
  EXPECT_FALSE(session_.take_announcement().has_value());
}

// A glimpse of frames of another size before the end loses nothing of what was seen before.
TEST_F(SessionFrames, OfAnEarlierSizeCountAtTheEndWhereTheLastAreTooFew) {
  begin();
  show(4);
  std::optional<Error> warning;
  EXPECT_TRUE(session_.set_size({320, 240}, warning));
  EXPECT_EQ(session_.end_of_stream(), LastWork::kSolve);
  const auto job = session_.take_solve();
  ASSERT_TRUE(job.has_value());
  EXPECT_TRUE(job->final);
  EXPECT_EQ(job->size, scenes::kSize);
  EXPECT_EQ(job->views.size(), 4u);
}

// A stream that has had its final result is over.
TEST_F(SessionFrames, OfAnEarlierSizeThatHadTheirResultAreNotSolvedAgain) {
  begin();
  show(4);
  EXPECT_EQ(session_.end_of_stream(), LastWork::kSolve);
  const auto job = session_.take_solve();
  ASSERT_TRUE(session_.solved(*job, found(*job, 0.1)).has_value());
  session_.reported(*job);
  std::optional<Error> warning;
  EXPECT_TRUE(session_.set_size({320, 240}, warning));
  EXPECT_EQ(session_.end_of_stream(), LastWork::kNone);
}

// As few as the last ones are no reason to go back.
TEST_F(SessionFrames, OfAnEarlierSizeThatAreTooFewWait) {
  begin();
  show(2);
  std::optional<Error> warning;
  EXPECT_TRUE(session_.set_size({320, 240}, warning));
  EXPECT_EQ(session_.end_of_stream(), LastWork::kNone);
  EXPECT_FALSE(session_.verdict().status.has_value());
}

}  // namespace
}  // namespace calvin
