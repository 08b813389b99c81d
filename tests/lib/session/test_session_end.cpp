// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a calibration session still does at the end of the stream, and what it says came of it.
#include "session_fixture.hpp"

namespace calvin {
namespace {

TEST_F(CalibrationSessions, EndWithAnErrorOnlyWhereFilesAreWanted) {
  SessionSettings settings;
  for (const bool files : {false, true}) {
    settings.location = files ? "/nowhere/cam.json" : "";
    begin(settings);
    show(2);
    EXPECT_EQ(session_.end_of_stream(), LastWork::kNone);
    const Verdict verdict = session_.verdict();
    EXPECT_EQ(verdict.files_wanted, files);
    ASSERT_FALSE(verdict.status.has_value());
    EXPECT_NE(verdict.status.error().message.find("only 2 views"), std::string::npos);
  }
}

TEST_F(CalibrationSessions, EndWithAFinalResultOfAllViews) {
  begin();
  show(5);
  solve(0.1);
  EXPECT_EQ(session_.end_of_stream(), LastWork::kSolve);
  const auto job = session_.take_solve();
  EXPECT_TRUE(job->final);
  EXPECT_EQ(job->views.size(), 5u);
  ASSERT_TRUE(session_.solved(*job, found(*job, 0.1)).has_value());
  session_.reported(*job);
  EXPECT_TRUE(session_.verdict().status.has_value());
  // Nothing is to be added to it, until there is another view.
  EXPECT_EQ(session_.end_of_stream(), LastWork::kNone);
  show(1);
  EXPECT_EQ(session_.end_of_stream(), LastWork::kSolve);
}

// The view came while the final result was being solved: there is no final result of it.
TEST_F(CalibrationSessions, EndWithAnotherSolveWhereAViewCameMeanwhile) {
  begin();
  show(3);
  ASSERT_TRUE(session_.solve_now(settings_).has_value());
  const auto job = session_.take_solve();
  show(1);
  ASSERT_TRUE(session_.solved(*job, found(*job, 0.1)).has_value()) << "a view more is no reset";
  session_.reported(*job);
  EXPECT_EQ(session_.end_of_stream(), LastWork::kSolve);
  EXPECT_EQ(session_.take_solve()->views.size(), 4u);
}

TEST_F(CalibrationSessions, EndWithTheResultBeforeAFailure) {
  begin();
  show(3);
  solve(0.1);
  EXPECT_EQ(session_.end_of_stream(), LastWork::kSolve);
  const auto last = session_.take_solve();
  // The end itself tells it.
  EXPECT_FALSE(session_.failed(*last, {ErrorCode::kDegenerate, "All views are alike."}));
  const Status status = session_.verdict().status;
  ASSERT_FALSE(status.has_value());
  EXPECT_EQ(status.error().message,
            "The final solve failed and the one before it stays: All views are alike.");
  EXPECT_TRUE(session_.calibration().has_value());
}

// Whoever has asked for a solve hears why there is none, once; nobody hears of one that was tried
// meanwhile.
TEST_F(CalibrationSessions, SayWhyASolveThatWasAskedForFails) {
  const Error why = {ErrorCode::kDegenerate, "All views are alike."};
  begin();
  show(3);
  EXPECT_FALSE(session_.failed(*session_.take_solve(), why));
  ASSERT_TRUE(session_.solve_now(settings_).has_value());
  const auto told = session_.failed(*session_.take_solve(), why);
  ASSERT_TRUE(told.has_value());
  EXPECT_EQ(told->message, "No calibration: All views are alike.");
  EXPECT_EQ(session_.progress().hint, "All views are alike.");
  show(1);
  EXPECT_FALSE(session_.failed(*session_.take_solve(), why));
}

// Views that cannot be solved are not enough, however many were asked for.
TEST_F(CalibrationSessions, GoOnWhereTheViewsOfALimitCannotBeSolved) {
  SessionSettings settings;
  settings.max_views = 4;
  begin(settings);
  show(4);
  EXPECT_FALSE(session_.progress().done);
  EXPECT_NE(show(1).reason, Reason::kAccepted);
  const auto job = session_.take_solve();
  ASSERT_TRUE(job.has_value());
  EXPECT_TRUE(session_.failed(*job, {ErrorCode::kDegenerate, "All views are alike."}));
  EXPECT_NE(session_.progress().hint.substr(0, 4), "Done");
  EXPECT_EQ(show(3).reached, "");
  EXPECT_EQ(show(1).reached, "max-views") << "twice as many";
  ASSERT_TRUE(solve(0.1).has_value());
  EXPECT_TRUE(session_.progress().done);
  session_.reset();
  show(3);
  EXPECT_EQ(show(1).reached, "max-views") << "a new session has its own";
}

// Nothing more is captured: whoever asks for a view is told so.
TEST_F(CalibrationSessions, AnswerACaptureAfterTheirLimit) {
  SessionSettings settings;
  settings.max_views = 3;
  begin(settings);
  show(3);
  ASSERT_TRUE(solve(0.1).has_value());
  EXPECT_FALSE(show(1).report);
  session_.capture_view();
  EXPECT_TRUE(show(1).report);
  EXPECT_FALSE(show(1).report);
}

// What calibsolve's worker does, once.
TEST_F(CalibrationSessions, AreSolvedByTheirJobs) {
  begin();
  show(12);
  ASSERT_TRUE(session_.solve_now(settings_).has_value());
  const auto job = session_.take_solve();
  const auto solution = solve_job(*job, {});
  ASSERT_TRUE(solution.has_value()) << solution.error().message;
  EXPECT_NEAR(solution->calibration.find("fx")->value, 1100, 5);
  EXPECT_TRUE(session_.solved(*job, *solution)->better);
}

}  // namespace
}  // namespace calvin
