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
  session_.failed(*session_.take_solve(), {ErrorCode::kDegenerate, "All views are alike."});
  const Status status = session_.verdict().status;
  ASSERT_FALSE(status.has_value());
  EXPECT_EQ(status.error().message,
            "The final solve failed and the one before it stays: All views are alike.");
  EXPECT_TRUE(session_.calibration().has_value());
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
