// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a session does with the guide that follows a solve: which views it takes, what it tells.

#include <algorithm>
#include <cmath>
#include <string_view>

#include "calvin/geometry/se3.hpp"
#include "calvin/synth/motion.hpp"
#include "session_fixture.hpp"

namespace calvin {
namespace {

class GuidedSessions : public CalibrationSessions {
 protected:
  // Three views are taken and solved, and the session is guided from there, in capture-mode=auto.
  void begin_guided() {
    begin();
    show(3);
    SessionSettings automatic = settings_;
    automatic.capture_mode = CaptureChoice::kAuto;
    set(automatic);
    finish_solve(session_.take_solve());
    ASSERT_FALSE(session_.progress().ghost.empty());
    target_ = to_se3(*session_.hint().target);
  }
  void finish_solve(const std::optional<SolveJob>& job) {
    ASSERT_TRUE(job.has_value());
    Solution solution = found(*job, 0.5);
    ASSERT_TRUE(session_.solved(*job, solution).has_value());
    session_.guided(*job, guide_job(*job, solution));
    session_.reported(*job);
  }
  // A board that is held there in two frames: what came of the one that was taken, or of the
  // second.
  Offered hold(const SE3& pose, double noise = 0.01) {
    Offered last;
    for (int i = 0; i < 2; ++i, ++frame_) {
      last = session_.offer(at(pose, noise), times(frame_));
      if (last.reason == Reason::kAccepted) break;
    }
    return last;
  }
  Observation at(const SE3& pose, double noise = 0.01) {
    scenes::Random random(static_cast<unsigned>(frame_));
    Observation o = scenes::observe(camera_, scenes::kBoard, pose, noise, random).observation;
    o.timestamp = times(frame_).timestamp;
    return o;
  }
  void wait(int seconds) { frame_ += 30 * seconds; }

  SE3 target_;
};

TEST_F(GuidedSessions, TakeTheViewThatTheyAskFor) {
  begin_guided();
  EXPECT_EQ(hold(target_).reason, Reason::kAccepted);
  EXPECT_GT(session_.progress().ghost_share, 0.9);
}

// A small turn makes a view another one; that it tells nothing is seen by its information alone.
TEST_F(GuidedSessions, LeaveOutAViewThatTellsLittle) {
  begin_guided();
  ASSERT_EQ(hold(target_).reason, Reason::kAccepted);
  finish_solve(session_.take_solve());
  const SE3 turned = {target_.rotation * exp_so3({0, 0, 0.12}), target_.translation};
  EXPECT_EQ(hold(turned).reason, Reason::kTooSimilar);
  EXPECT_LT(session_.progress().ghost_share, 0.5);
  // Whoever does not get to the ghost is not left alone.
  wait(9);
  EXPECT_EQ(hold(turned).reason, Reason::kAccepted);
}

// What no board shows is refused with a word, guided or not.
TEST_F(GuidedSessions, RefuseCornersThatNoBoardHas) {
  begin_guided();
  Observation strange = at(target_);
  strange.ids.front() = 1'000'000;
  const Offered offered = session_.offer(strange, times(frame_++));
  EXPECT_EQ(offered.reason, Reason::kWrongBoard);
  EXPECT_TRUE(offered.complaint.has_value());
  Observation cut = at(target_);
  cut.uv.resize(20);
  EXPECT_EQ(session_.offer(cut, times(frame_++)).reason, Reason::kWrongBoard);
  EXPECT_EQ(hold(target_).reason, Reason::kAccepted);
}

// A guide that comes when nobody is to be guided any more shows no ghost.
TEST_F(GuidedSessions, AreLeftByAGuideThatComesTooLate) {
  begin_guided();
  ASSERT_EQ(hold(target_).reason, Reason::kAccepted);
  const auto job = session_.take_solve();
  ASSERT_TRUE(job.has_value());
  const Solution solution = found(*job, 0.5);
  ASSERT_TRUE(session_.solved(*job, solution).has_value());
  const auto guide = guide_job(*job, solution);
  ASSERT_TRUE(guide != nullptr);
  SessionSettings every = settings_;
  every.capture_mode = CaptureChoice::kAll;
  set(every);
  session_.guided(*job, guide);
  EXPECT_TRUE(session_.progress().ghost.empty());
}

// A board that is lost on the way, again and again.
TEST_F(GuidedSessions, AskForSomethingElseWhereABoardGetsLost) {
  begin_guided();
  ASSERT_EQ(hold(target_).reason, Reason::kAccepted);
  finish_solve(session_.take_solve());
  const auto lose_it = [&](int seconds) {
    wait(seconds);
    Observation nothing;
    nothing.timestamp = times(frame_).timestamp;
    nothing.image_size = scenes::kSize;
    EXPECT_EQ(session_.offer(nothing, times(frame_)).reason, Reason::kNotFound);
    return session_.progress().ghost;
  };
  const auto is_at = [](const std::vector<Pixel>& a, const std::vector<Pixel>& b) {
    return !a.empty() && !b.empty() && a.front().u == b.front().u && a.front().v == b.front().v;
  };
  const auto first = session_.progress().ghost;
  ASSERT_FALSE(first.empty());
  EXPECT_TRUE(is_at(lose_it(3), first)) << "a hand has a few seconds";
  const auto second = lose_it(2);
  EXPECT_FALSE(second.empty() || is_at(second, first));
  const auto third = lose_it(6);
  EXPECT_FALSE(third.empty() || is_at(third, first) || is_at(third, second));
  EXPECT_TRUE(lose_it(6).empty()) << "a camera that is known badly asks for what it cannot see";
}

// Who holds it where it tells little is asked for something else, too, but still sees a ghost.
TEST_F(GuidedSessions, AskForSomethingElseWhereABoardIsHeldInVain) {
  begin_guided();
  ASSERT_EQ(hold(target_).reason, Reason::kAccepted);
  finish_solve(session_.take_solve());
  const auto first = session_.progress().ghost;
  ASSERT_FALSE(first.empty());
  EXPECT_EQ(hold(target_).reason, Reason::kTooSimilar);
  wait(6);
  EXPECT_EQ(hold(target_).reason, Reason::kTooSimilar);
  const auto second = session_.progress().ghost;
  ASSERT_FALSE(second.empty());
  EXPECT_NE(second.front().u, first.front().u);
}

// Who does not get to the view that is asked for gives another one in the end, and is asked for
// something else then.
TEST_F(GuidedSessions, DoNotInsistOnAViewThatNobodyGetsTo) {
  begin_guided();
  const auto outline = session_.progress().ghost;
  const SE3 elsewhere = {target_.rotation, 3.3 * target_.translation};
  hold(elsewhere, 0.1);
  ASSERT_LT(session_.progress().ghost_share, 0.25);
  wait(9);
  ASSERT_EQ(hold(elsewhere, 0.1).reason, Reason::kAccepted);
  finish_solve(session_.take_solve());
  const auto& next = session_.progress().ghost;
  ASSERT_FALSE(next.empty());
  double farthest = 0;
  for (std::size_t i = 0; i < next.size(); ++i) {
    farthest = std::max(farthest, std::hypot(next[i].u - outline[i].u, next[i].v - outline[i].v));
  }
  EXPECT_GT(farthest, 0.06) << "of the picture's width";
}

// A board that is waved about gives a view every second or so, of anything: an outline that jumps
// with each of them could not be followed by whoever begins to.
TEST_F(GuidedSessions, KeepTheirOutlineForWhoDoesNotFollowYet) {
  begin_guided();
  const Motion hand(MotionKind::kHand, camera_, scenes::kBoard, 3);
  constexpr int kSeconds = 24;
  int answered = 0;
  int outlines = 1;
  for (const int first = frame_; frame_ < first + 30 * kSeconds; ++frame_) {
    const Observation seen = at(hand.camera_from_board((frame_ - first) / 30.0), 0.1);
    const auto before = *session_.hint().target;
    const bool taken = session_.offer(seen, times(frame_)).reason == Reason::kAccepted;
    answered += taken && session_.progress().ghost_share >= 0.25 ? 1 : 0;
    if (const auto job = session_.take_solve()) finish_solve(job);
    ASSERT_TRUE(session_.hint().target.has_value());
    outlines += session_.hint().target->translation != before.translation ? 1 : 0;
  }
  const auto views = session_.views().views().size();
  EXPECT_GT(views, kSeconds / 2U);
  EXPECT_LE(outlines, kSeconds / 4 + answered);
}

TEST_F(GuidedSessions, KeepTheirWordsForTwoSeconds) {
  begin_guided();
  const SE3 away = {target_.rotation, 1.6 * target_.translation};
  hold(away);
  const std::string far = session_.progress().hint;
  hold(target_);
  EXPECT_EQ(session_.progress().hint, far);
  wait(2);
  hold(target_);
  EXPECT_EQ(session_.progress().hint, to_text(Hint{HintKind::kHoldStill}));
}

// Words lead from where the board is seen: to nobody who does not show it.
TEST_F(GuidedSessions, LeadFromWhereTheBoardIs) {
  begin_guided();
  const std::string before = session_.progress().hint;
  EXPECT_FALSE(before.starts_with("To the outline: "));
  hold({target_.rotation, 1.6 * target_.translation});
  EXPECT_EQ(session_.progress().hint, before) << "it was changed with the last view, just now";
  wait(2);
  hold({target_.rotation, 1.6 * target_.translation});
  EXPECT_NE(session_.progress().hint.find("come closer"), std::string::npos);
  wait(1);
  Observation nothing;
  nothing.timestamp = times(frame_).timestamp;
  EXPECT_EQ(session_.offer(nothing, times(frame_)).reason, Reason::kNotFound);
  EXPECT_EQ(session_.progress().hint, "Show the board where the outline is.");
  ++frame_;
  hold({target_.rotation, 1.6 * target_.translation});
  EXPECT_NE(session_.progress().hint.find("come closer"), std::string::npos);
}

// A lens that is out of focus: no view is taken, and nothing that one could do with the board
// helps.
TEST_F(GuidedSessions, SayThatThePictureIsBlurred) {
  const auto hold_blurred = [&](const SE3& pose, int frames = 35) {
    for (const int first = frame_; frame_ < first + frames; ++frame_) {
      Observation seen = at(pose);
      seen.blur = 3;
      EXPECT_NE(session_.offer(seen, times(frame_)).reason, Reason::kAccepted);
    }
    return session_.progress().hint.starts_with("The picture is blurred: ");
  };
  begin();
  SessionSettings automatic = settings_;
  automatic.capture_mode = CaptureChoice::kAuto;
  set(automatic);
  scenes::Random random(1);
  const SE3 anywhere = scenes::random_pose(camera_, scenes::kBoard, random, 0.3);
  EXPECT_TRUE(hold_blurred(anywhere, 3)) << "before the first view that is all that is known";
  EXPECT_TRUE(hold_blurred(anywhere));
  session_ = CalibrationSession();
  settings_ = {};
  begin_guided();
  ASSERT_EQ(hold(target_).reason, Reason::kAccepted);
  EXPECT_FALSE(hold_blurred(target_, 2)) << "for a moment";
  EXPECT_TRUE(hold_blurred(target_));
  hold(target_);
  EXPECT_FALSE(session_.progress().hint.starts_with("The picture is blurred: "));
}

TEST_F(GuidedSessions, SayThatTheyAreDone) {
  begin_guided();
  SessionSettings settings = settings_;
  settings.max_views = 4;
  set(settings);
  EXPECT_FALSE(session_.progress().ghost.empty());
  EXPECT_EQ(hold(target_).reached, "max-views");
  EXPECT_EQ(session_.progress().hint, to_text(Hint{HintKind::kDone}));
  EXPECT_TRUE(session_.progress().ghost.empty());
  finish_solve(session_.take_solve());
  EXPECT_EQ(session_.progress().hint, to_text(Hint{HintKind::kDone}));
  // More is wanted after all.
  settings.max_views = 5;
  set(settings);
  EXPECT_NE(session_.progress().hint, to_text(Hint{HintKind::kDone}));
}

// With a target a session that is full goes on with views that tell more than one that it has.
TEST_F(GuidedSessions, ExchangeAWeakViewForABetterOne) {
  begin_guided();
  session_.begin_journal({});
  SessionSettings settings = settings_;
  settings.max_views = 4;
  settings.target_error = 0.01;
  set(settings);
  EXPECT_EQ(hold(target_).reached, "");
  finish_solve(session_.take_solve());
  ASSERT_EQ(session_.views().views().size(), 4U);
  const auto before = session_.views().views();
  (void)session_.take_journal();

  EXPECT_EQ(hold(to_se3(*session_.hint().target)).reason, Reason::kAccepted);
  const auto& after = session_.views().views();
  ASSERT_EQ(after.size(), 4U);
  int stayed = 0;
  for (const auto& view : before) stayed += std::ranges::count(after, view) > 0 ? 1 : 0;
  EXPECT_EQ(stayed, 3);
  // The view that went does not come back with the next run.
  const auto entries = session_.take_journal();
  ASSERT_EQ(entries.size(), 1U);
  EXPECT_TRUE(entries.front().reset);
  EXPECT_EQ(entries.front().views, after);

  // Until the next solve nobody knows which one tells least now.
  wait(9);
  EXPECT_EQ(hold(target_).reason, Reason::kTooSimilar);
}

// Full, with a target that is not reached.
class FullSessions : public GuidedSessions {
 protected:
  void SetUp() override {
    begin_guided();
    SessionSettings settings = settings_;
    settings.max_views = 4;
    settings.target_error = 0.01;
    set(settings);
    ASSERT_EQ(hold(target_).reason, Reason::kAccepted);
    finish_solve(session_.take_solve());
    ASSERT_EQ(session_.views().views().size(), 4U);
    ASSERT_FALSE(session_.progress().ghost.empty()) << "it goes on";
    wait(9);  // by then anything that is new would be kept if there were room
  }
};

TEST_F(FullSessions, LeaveAViewThatTellsLess) {
  const auto before = session_.views().views();
  const SE3 far = {target_.rotation, 4 * target_.translation};
  EXPECT_EQ(hold(far, 1).reason, Reason::kTooSimilar);
  EXPECT_EQ(session_.views().views(), before);
}

// It is like the view that it replaces, and like no other one.
TEST_F(FullSessions, TakeASharperViewOfTheSamePlace) {
  int taken = 0;
  for (unsigned n = 0; n < 3 && taken == 0; ++n) {
    scenes::Random random(n);
    const SE3 pose = scenes::random_pose(camera_, scenes::kBoard, random, 0.5);
    taken += hold(pose, 0.01).reason == Reason::kAccepted ? 1 : 0;
  }
  EXPECT_EQ(taken, 1) << "one of the three tells least";
  EXPECT_EQ(session_.views().views().size(), 4U);
}

// A target that cannot be reached is no reason to go on for ever.
TEST_F(GuidedSessions, EndTheExchangeOfViews) {
  begin_guided();
  SessionSettings settings = settings_;
  settings.max_views = 4;
  settings.target_error = 1e-6;
  set(settings);
  for (int i = 0; i < 40 && session_.hint().kind != HintKind::kDone; ++i) {
    if (session_.hint().target) hold(to_se3(*session_.hint().target));
    if (const auto job = session_.take_solve()) finish_solve(job);
    wait(1);
  }
  EXPECT_EQ(session_.hint().kind, HintKind::kDone);
  EXPECT_EQ(session_.views().views().size(), 4U);
}

TEST_F(GuidedSessions, AreGuidedInCaptureModeAutoAlone) {
  begin_guided();
  SessionSettings all = settings_;
  all.capture_mode = CaptureChoice::kAll;
  set(all);
  EXPECT_TRUE(session_.progress().ghost.empty());
  show(1);
  const auto job = session_.take_solve();
  ASSERT_TRUE(job.has_value());
  EXPECT_EQ(guide_job(*job, found(*job, 0.5)), nullptr);
}

}  // namespace
}  // namespace calvin
