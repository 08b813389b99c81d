// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// When a calibration session solves, and which results it takes: as calibsolve's threads would tell
// it, but one after the other.
#include <functional>

#include "session_fixture.hpp"

namespace calvin {
namespace {

// What makes a solve that is under way one of the past.
struct End {
  const char* name;
  std::function<void(CalibrationSession&)> act;
  bool all;  // views are forgotten
};

std::vector<End> ends() {
  return {
      {"reset", [](CalibrationSession& s) { s.reset(); }, true},
      {"another size",
       [](CalibrationSession& s) {
         std::optional<Error> warning;
         EXPECT_TRUE(s.set_size({320, 240}, warning));
       },
       true},
      {"another run",
       [](CalibrationSession& s) { s.start(make_plan(s.plan().settings).value(), true); }, true},
      {"a view is removed", [](CalibrationSession& s) { EXPECT_TRUE(s.remove_view(1)); }, false},
      {"another model",
       [](CalibrationSession& s) {
         SessionSettings other = s.plan().settings;
         other.model = "brown4";
         const auto update = s.begin_update(other);
         EXPECT_TRUE(s.end_update(*update, read_settings(*update), other).has_value());
       },
       false},
  };
}

TEST_F(CalibrationSessions, AskForASolveOnceThereAreEnoughViews) {
  begin();
  EXPECT_TRUE(show(2).report);
  EXPECT_FALSE(session_.take_solve().has_value());
  EXPECT_EQ(show(1).progress.views, 3);
  const auto job = session_.take_solve();
  ASSERT_TRUE(job.has_value());
  EXPECT_FALSE(job->final);
  EXPECT_EQ(job->views.size(), 3u);
  EXPECT_EQ(job->options.camera, "left");
  EXPECT_EQ(job->times.timestamp, times(2).timestamp);
  EXPECT_FALSE(session_.take_solve().has_value()) << "each job is taken once";
}

// A picture without a board is told like one whose board is not taken: when that is new.
TEST_F(CalibrationSessions, SayThatThereIsNoBoardAndWhy) {
  begin();
  Observation none = seen(0);
  none.ids.clear();
  none.uv.clear();
  none.sigma.clear();
  const auto offer_none = [&] { return session_.offer(none, times(0)); };
  Offered offered = offer_none();
  EXPECT_TRUE(offered.report);
  EXPECT_EQ(offered.reason, Reason::kNotFound);
  EXPECT_EQ(offered.camera, "left");
  EXPECT_FALSE(offered.progress.hint.empty());
  EXPECT_FALSE(offer_none().report);
  session_.hear_detector("It is dark");
  offered = offer_none();
  EXPECT_TRUE(offered.report);
  EXPECT_EQ(offered.progress.hint, "It is dark");
  EXPECT_FALSE(offer_none().report);
  EXPECT_NE(session_.verdict().status.error().message.find("It is dark."), std::string::npos);
  session_.hear_detector("This is a 9x6 board", true);
  EXPECT_EQ(offer_none().reason, Reason::kWrongBoard);
  EXPECT_FALSE(offer_none().report);
  session_.hear_detector("");
  EXPECT_EQ(offer_none().reason, Reason::kNotFound);
  EXPECT_FALSE(offer_none().report);
  EXPECT_TRUE(show(1).report);
  EXPECT_EQ(session_.verdict().status.error().message.find("It is dark"), std::string::npos)
      << "a board was found since";
  EXPECT_TRUE(offer_none().report);
}

// Two equal boards in one picture: both are views, and it is said once that hints are for one.
TEST_F(CalibrationSessions, SayOnceThatTwoBoardsAreInView) {
  begin();
  const auto offer_two = [&](int n) {
    Observation other = seen(n + 100);
    other.timestamp = times(n).timestamp;
    const Offered first = session_.offer(seen(n), times(n), 0);
    EXPECT_EQ(first.progress.hint.find("two boards"), std::string::npos) << n;
    return session_.offer(other, times(n), 1);
  };
  EXPECT_EQ(show(1).progress.hint.find("two boards"), std::string::npos);
  const Offered both = offer_two(frame_);
  EXPECT_EQ(both.reason, Reason::kAccepted);
  EXPECT_EQ(both.progress.views, 3);
  EXPECT_NE(both.progress.hint.find("two boards"), std::string::npos) << both.progress.hint;
  EXPECT_EQ(offer_two(frame_ + 200).progress.hint.find("two boards"), std::string::npos);
}

// Where every frame is a view, solves would never end: each waits for a quarter more views.
TEST_F(CalibrationSessions, AskForFewerSolvesTheMoreViewsThereAre) {
  begin();
  std::vector<std::size_t> solved;
  for (int n = 1; n <= 20; ++n) {
    show(1);
    if (const auto job = session_.take_solve()) solved.push_back(job->views.size());
  }
  EXPECT_EQ(solved, (std::vector<std::size_t>{3, 4, 6, 8, 11, 14, 18}));
}

TEST_F(CalibrationSessions, ThrowAwayWhatWasSolvedForAnotherState) {
  for (const End& end : ends()) {
    SCOPED_TRACE(end.name);
    begin();
    show(4);
    const auto job = session_.take_solve();
    ASSERT_TRUE(job.has_value());
    end.act(session_);
    EXPECT_FALSE(session_.is_current(job->origin));
    EXPECT_FALSE(session_.solved(*job, found(*job, 0.1)).has_value());
    EXPECT_FALSE(session_.calibration().has_value());
    EXPECT_FALSE(session_.take_announcement().has_value());
    Solution outlier = found(*job, 0.1);
    outlier.rejected = {{3, Reason::kOutlier}};
    EXPECT_TRUE(session_.newly_rejected(*job, outlier).empty());
    EXPECT_FALSE(session_.failed(*job, {ErrorCode::kDegenerate, "The views are too few."}));
    EXPECT_EQ(session_.verdict().status.error().message.find("too few."), std::string::npos);
    // Where views are left they are solved anew.
    EXPECT_EQ(session_.take_solve().has_value(), !end.all);
  }
}

TEST_F(CalibrationSessions, GoOnWithoutAViewThatWasRemoved) {
  begin();
  show(4);
  ASSERT_TRUE(solve(0.1)->better);
  EXPECT_FALSE(session_.remove_view(4));
  ASSERT_TRUE(session_.remove_view(0));
  const auto job = session_.take_solve();
  ASSERT_TRUE(job.has_value());
  ASSERT_EQ(job->views.size(), 3u);
  EXPECT_EQ(job->views[0]->observation.timestamp, times(1).timestamp);
  // It counts though it is worse: the one before has the view in it.
  EXPECT_TRUE(session_.solved(*job, found(*job, 0.9))->better);
  ASSERT_TRUE(session_.remove_view(0));
  EXPECT_FALSE(session_.take_solve().has_value());
  EXPECT_FALSE(session_.calibration().has_value()) << "2 views make none";
}

TEST_F(CalibrationSessions, TakeAResultOnTheWayOnlyWhereItIsBetter) {
  begin();
  show(3);
  EXPECT_TRUE(solve(std::nullopt)->better) << "the first one, whatever it is";
  EXPECT_TRUE(session_.take_announcement().has_value());
  EXPECT_FALSE(session_.take_announcement().has_value());
  const struct {
    std::optional<double> error;
    bool better;
  } kResults[] = {{std::nullopt, false}, {0.5, true}, {0.6, false}, {0.5, false}, {0.4, true}};
  for (const auto& [error, better] : kResults) {
    session_.resume();
    show(1);
    EXPECT_EQ(solve(error)->better, better) << error.value_or(-1);
    const auto announced = session_.take_announcement();
    EXPECT_EQ(announced.has_value(), better) << error.value_or(-1);
    if (announced) {
      EXPECT_EQ(announced->expected_error, error);
    }
    EXPECT_EQ(session_.progress().expected_error, error) << "what is known now";
  }
  ASSERT_TRUE(session_.solve_now(settings_).has_value());
  EXPECT_TRUE(solve(0.9)->better) << "a final one is of all views";
}

TEST_F(CalibrationSessions, AreCompleteWithTheLastViewThatIsWanted) {
  SessionSettings settings;
  settings.max_views = 4;
  begin(settings);
  EXPECT_EQ(show(3).reached, "");
  EXPECT_FALSE(session_.take_solve()->final);
  EXPECT_EQ(show(1).reached, "max-views");
  EXPECT_TRUE(session_.take_solve()->final);
  EXPECT_FALSE(show(1).report) << "nothing more is captured";
  EXPECT_EQ(session_.views().views().size(), 4u);
  // With one view less there is room for another one.
  ASSERT_TRUE(session_.remove_view(0));
  EXPECT_EQ(show(1).reached, "max-views");
}

TEST_F(CalibrationSessions, AreCompleteWithTheErrorThatIsWanted) {
  SessionSettings settings;
  settings.target_error = 0.2;
  begin(settings);
  show(3);
  solve(0.21);
  EXPECT_EQ(show(1).reached, "");
  const auto job = session_.take_solve();
  EXPECT_FALSE(job->final);
  const auto published = session_.solved(*job, found(*job, 0.2));
  ASSERT_TRUE(published.has_value());
  EXPECT_EQ(published->reached, "target-error");
  EXPECT_FALSE(show(1).report) << "nothing more is captured";
  const auto last = session_.take_solve();
  ASSERT_TRUE(last.has_value());
  EXPECT_TRUE(last->final);
  EXPECT_EQ(session_.solved(*last, found(*last, 0.2))->reached, "") << "once";
  EXPECT_FALSE(session_.take_solve().has_value());
}

// A newer job takes the place of one that waits, or that a flush cut short: nothing final is lost.
TEST_F(CalibrationSessions, OweAFinalResultUntilItIsReported) {
  begin();
  show(3);
  ASSERT_TRUE(session_.solve_now(settings_).has_value());
  EXPECT_TRUE(session_.take_solve()->final);
  show(1);
  const auto newer = session_.take_solve();
  EXPECT_TRUE(newer->final);
  session_.resume();
  const auto again = session_.take_solve();
  ASSERT_TRUE(again.has_value());
  EXPECT_TRUE(again->final);
  ASSERT_TRUE(session_.solved(*again, found(*again, 0.1)).has_value());
  session_.resume();
  EXPECT_TRUE(session_.take_solve()->final) << "published, but nobody heard of it";
  session_.reported(*again);
  session_.resume();
  EXPECT_FALSE(session_.take_solve().has_value());
  show(1);
  EXPECT_FALSE(session_.take_solve()->final);
}

TEST_F(CalibrationSessions, OweNothingOfTheSessionBefore) {
  for (const End& end : ends()) {
    SCOPED_TRACE(end.name);
    begin();
    show(4);
    ASSERT_TRUE(session_.solve_now(settings_).has_value());
    EXPECT_TRUE(session_.take_solve()->final);
    end.act(session_);
    session_.resume();
    const auto job = session_.take_solve();
    EXPECT_EQ(job.has_value() && job->final, !end.all);
  }
}

TEST_F(CalibrationSessions, TellOnceWhichViewsAreOutliers) {
  begin();
  show(4);
  const auto job = session_.take_solve();
  Solution solution = found(*job, 0.1);
  EXPECT_TRUE(session_.newly_rejected(*job, solution).empty());
  solution.rejected = {{2, Reason::kOutlier}};
  const auto first = session_.newly_rejected(*job, solution);
  ASSERT_EQ(first.size(), 1u);
  EXPECT_EQ(first[0].times.running_time, times(2).running_time);
  EXPECT_EQ(first[0].reason, Reason::kOutlier);
  EXPECT_TRUE(session_.newly_rejected(*job, solution).empty());
  solution.rejected = {{2, Reason::kOutlier}, {0, Reason::kOutlier}};
  EXPECT_EQ(session_.newly_rejected(*job, solution).size(), 1u);
  solution.rejected.clear();
  EXPECT_TRUE(session_.newly_rejected(*job, solution).empty());
  solution.rejected = {{2, Reason::kOutlier}};
  EXPECT_EQ(session_.newly_rejected(*job, solution).size(), 1u) << "it was in again meanwhile";
  // Nothing of it is said of the next session's views.
  session_.reset();
  show(4);
  const auto next = session_.take_solve();
  EXPECT_EQ(session_.newly_rejected(*next, solution).size(), 1u);
}

TEST_F(CalibrationSessions, ReportARejectionWhenItsReasonIsNew) {
  begin();
  show(1);
  Observation few = seen(1);
  few.ids.resize(4);
  few.uv.resize(4);
  EXPECT_TRUE(session_.offer(few, times(1)).report);
  EXPECT_FALSE(session_.offer(few, times(2)).report);
  EXPECT_TRUE(session_.offer(seen(3), times(3)).report);
  EXPECT_TRUE(session_.offer(few, times(4)).report);
  few.ids.clear();
  EXPECT_TRUE(session_.offer(few, times(5)).report) << "nor is there a board now";
  EXPECT_FALSE(session_.offer(few, times(6)).report);
}

TEST_F(CalibrationSessions, ComplainOnceOfWhatIsNoObservation) {
  begin();
  Observation broken = seen(0);
  broken.board = "checkerboard:no";
  const auto first = session_.offer(broken, times(0));
  ASSERT_TRUE(first.complaint.has_value());
  EXPECT_FALSE(first.report);
  EXPECT_FALSE(session_.offer(broken, times(1)).complaint.has_value());
  broken = seen(0);
  broken.uv[0] = {-1e4, 0};
  const auto outside = session_.offer(broken, times(2));
  EXPECT_EQ(outside.reason, Reason::kWrongBoard);
  EXPECT_FALSE(outside.complaint.has_value());
  session_.reset();
  EXPECT_TRUE(session_.offer(broken, times(3)).complaint.has_value()) << "a new session";
  EXPECT_FALSE(session_.first_complaint());
}

TEST_F(CalibrationSessions, TakeNoViewOfAnotherSize) {
  begin();
  Observation large = seen(0);
  large.image_size = {1920, 1080};
  EXPECT_FALSE(session_.offer(large, times(0)).report);
  EXPECT_TRUE(session_.views().views().empty());
}

// ---- Settings -----------------------------------------------------------------------------------

TEST_F(CalibrationSessions, RefuseASettingAndGoOnWithTheOneBefore) {
  begin();
  show(3);
  solve(0.1);
  SessionSettings wrong = settings_;
  wrong.max_views = 1;
  const auto warnings = set(wrong);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].message.find("max-views=1 is less than min-views=3"), 0u);
  EXPECT_TRUE(warnings[0].message.ends_with("What was set before goes on."));
  EXPECT_EQ(session_.plan().settings.max_views, 0);
  EXPECT_FALSE(session_.begin_update(wrong).has_value()) << "said once";
  EXPECT_FALSE(session_.take_solve().has_value()) << "nothing else has changed";
}

TEST_F(CalibrationSessions, ReadSettingsAnewThatChangedMeanwhile) {
  begin();
  SessionSettings one = settings_;
  one.model = "brown4";
  SessionSettings two = settings_;
  two.model = "pinhole";
  const auto slow = session_.begin_update(one);
  const auto quick = session_.begin_update(two);
  EXPECT_TRUE(session_.end_update(*quick, read_settings(*quick), two).has_value());
  EXPECT_FALSE(session_.end_update(*slow, read_settings(*slow), two).has_value());
  EXPECT_EQ(session_.plan().settings.model, "pinhole");
}

// Who asks for a result asks for one of what was set before.
TEST_F(CalibrationSessions, SolveOnRequestWithTheSettingsThatAreBeingRead) {
  begin();
  show(3);
  solve(0.1);
  SessionSettings other = settings_;
  other.model = "brown4";
  const auto update = session_.begin_update(other);
  ASSERT_TRUE(session_.solve_now(other).has_value());
  EXPECT_FALSE(session_.take_solve().has_value());
  EXPECT_TRUE(session_.end_update(*update, read_settings(*update), other).has_value());
  const auto job = session_.take_solve();
  ASSERT_TRUE(job.has_value());
  EXPECT_TRUE(job->final);
  EXPECT_EQ(job->options.model, "brown4");
}

TEST_F(CalibrationSessions, SayWhatIsMissingForARequest) {
  session_.start(make_plan(settings_).value(), true);
  EXPECT_NE(session_.solve_now(settings_).error().message.find("before its first frame"),
            std::string::npos);
  begin();
  const Status none = session_.solve_now(settings_);
  ASSERT_FALSE(none.has_value());
  EXPECT_NE(none.error().message.find("no detector has said anything"), std::string::npos);
  session_.hear_detector("", false);
  EXPECT_NE(session_.solve_now(settings_).error().message.find("was taken, at least 3 are needed"),
            std::string::npos);
  show(2);
  EXPECT_NE(session_.solve_now(settings_).error().message.find("only 2 views"), std::string::npos);
  EXPECT_FALSE(session_.take_solve().has_value());
  show(1);
  EXPECT_FALSE(session_.take_solve()->final) << "the request was refused";
}

}  // namespace
}  // namespace calvin
