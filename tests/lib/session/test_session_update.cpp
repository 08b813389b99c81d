// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a session makes of settings that change while it solves and writes, and of limits that its
// views have reached by then.

#include <functional>
#include <string>
#include <vector>

#include "session_fixture.hpp"

namespace calvin {
namespace {

// Where a file could be written; none is.
std::string place(const std::string& name) { return ::testing::TempDir() + name; }

// Settings by which the result is to be another one, or is to go elsewhere.
struct Change {
  const char* name;
  std::function<void(SessionSettings&)> make;
};

std::vector<Change> changes() {
  return {{"location", [](SessionSettings& s) { s.location = place("new.json"); }},
          {"export", [](SessionSettings& s) { s.exports = "ros:" + place("new.yaml"); }},
          {"camera", [](SessionSettings& s) { s.camera = "right"; }},
          {"model", [](SessionSettings& s) { s.model = "brown4"; }}};
}

SessionSettings with_location() {
  SessionSettings settings;
  settings.location = place("old.json");
  return settings;
}

SessionFiles::Outcome failure() {
  SessionFiles::Outcome outcome;
  outcome.status = make_error(ErrorCode::kIo, "The old disk is full.");
  return outcome;
}

class SessionUpdates : public CalibrationSessions {
 protected:
  void change(const Change& change) {
    SessionSettings other = settings_;
    change.make(other);
    set(other);
  }
};

TEST_F(SessionUpdates, ThrowAwayASolveThatIsUnderWay) {
  for (const Change& c : changes()) {
    SCOPED_TRACE(c.name);
    begin(with_location());
    show(4);
    const auto job = session_.take_solve();
    change(c);
    EXPECT_FALSE(session_.solved(*job, found(*job, 0.1)).has_value());
    EXPECT_FALSE(session_.take_write().has_value()) << "it would go to the new file";
    EXPECT_FALSE(session_.take_announcement().has_value());
    const auto again = session_.take_solve();
    ASSERT_TRUE(again.has_value()) << "the views are solved again";
    EXPECT_FALSE(again->final);
    EXPECT_TRUE(session_.solved(*again, found(*again, 0.9))->better);
    const auto write = session_.take_write();
    ASSERT_TRUE(write.has_value());
    EXPECT_EQ(write->calibration.camera, std::string(c.name) == "camera" ? "right" : "left");
  }
}

TEST_F(SessionUpdates, StillOweTheFinalResultThatWasThrownAway) {
  for (const Change& c : changes()) {
    SCOPED_TRACE(c.name);
    begin(with_location());
    show(4);
    ASSERT_TRUE(session_.solve_now(settings_).has_value());
    const auto job = session_.take_solve();
    ASSERT_TRUE(job->final);
    change(c);
    EXPECT_FALSE(session_.solved(*job, found(*job, 0.1)).has_value());
    const auto again = session_.take_solve();
    ASSERT_TRUE(again.has_value());
    EXPECT_TRUE(again->final);
  }
}

TEST_F(SessionUpdates, BeginNoWriteToTheFilesBefore) {
  for (const Change& c : changes()) {
    SCOPED_TRACE(c.name);
    begin(with_location());
    show(4);
    solve(0.1);
    const auto write = session_.take_write();
    ASSERT_TRUE(write.has_value());
    change(c);
    EXPECT_FALSE(session_.begin_write(*write));
  }
}

// A write that had begun may end as it likes: the files that are set now do not have it.
TEST_F(SessionUpdates, CountNoWriteToTheFilesBefore) {
  for (const bool well : {true, false}) {
    begin(with_location());
    show(4);
    solve(0.1);
    const auto write = session_.take_write();
    ASSERT_TRUE(session_.begin_write(*write));
    change(changes()[0]);
    session_.end_write(*write, well ? SessionFiles::Outcome() : failure());
    EXPECT_FALSE(session_.has_notice());
    // The new file gets its own result, however good the other one was.
    EXPECT_TRUE(solve(0.9)->writing);
    const auto next = session_.take_write();
    ASSERT_TRUE(next.has_value());
    EXPECT_EQ(next->files.at(0).path, place("new.json"));
    EXPECT_TRUE(session_.begin_write(*next));
    session_.end_write(*next, {});
    EXPECT_TRUE(session_.verdict().status.has_value());
  }
}

// What a held write of the same session replaced is lost all the same, and its user hears of it.
TEST_F(SessionUpdates, TellWhatAWriteToTheFilesBeforeReplaced) {
  begin(with_location());
  show(4);
  solve(0.1);
  const auto write = session_.take_write();
  ASSERT_TRUE(session_.begin_write(*write));
  change(changes()[0]);
  SessionFiles::Outcome outcome;
  outcome.lost = Error{ErrorCode::kInvalidArgument, "It was better."};
  session_.end_write(*write, outcome);
  ASSERT_TRUE(session_.has_notice());
  EXPECT_EQ(session_.take_notice()->error.message, "It was better.");
}

// ---- The verdict is of the files that are set ---------------------------------------------------

TEST_F(SessionUpdates, EndWithoutTheErrorOfTheFilesBefore) {
  begin(with_location());
  show(4);
  solve(0.1);
  const auto write = session_.take_write();
  ASSERT_TRUE(session_.begin_write(*write));
  session_.end_write(*write, failure());
  EXPECT_FALSE(session_.verdict().status.has_value());
  SessionSettings none = settings_;
  none.location.clear();
  set(none);
  solve(0.1);
  EXPECT_TRUE(session_.verdict().status.has_value()) << "no file is set";
}

TEST_F(SessionUpdates, SayAgainThatAnotherFileStays) {
  begin(with_location());
  show(4);
  const auto keeps = [this](const std::string& path) {
    solve(0.1);
    const auto write = session_.take_write();
    EXPECT_TRUE(session_.begin_write(*write));
    SessionFiles::Outcome outcome;
    outcome.kept = path;
    session_.end_write(*write, outcome);
    return session_.take_notice();
  };
  EXPECT_TRUE(keeps(place("old.json")).has_value());
  change(changes()[0]);
  const auto notice = keeps(place("new.json"));
  ASSERT_TRUE(notice.has_value()) << "nobody was told of this one";
  EXPECT_NE(notice->error.message.find(place("new.json")), std::string::npos);
}

// Another camera is written to the same file, of which the user was told that it cannot be.
TEST_F(SessionUpdates, WarnOfTheSameFileOnce) {
  begin(with_location());
  show(4);
  for (const char* camera : {"right", "top"}) {
    solve(0.1);
    const auto write = session_.take_write();
    ASSERT_TRUE(session_.begin_write(*write));
    session_.end_write(*write, failure());
    EXPECT_EQ(session_.take_notice().has_value(), std::string(camera) == "right");
    SessionSettings other = settings_;
    other.camera = camera;
    set(other);
  }
}

// The new file has no result, and there are too few views for one.
TEST_F(SessionUpdates, EndWithAnErrorWhereNothingCanBeSolvedForTheNewFile) {
  begin(with_location());
  show(4);
  solve(0.1);
  const auto write = session_.take_write();
  ASSERT_TRUE(session_.begin_write(*write));
  session_.end_write(*write, {});
  SessionSettings other = settings_;
  other.location = place("new.json");
  other.min_views = 10;
  set(other);
  EXPECT_EQ(session_.end_of_stream(), LastWork::kNone);
  const Verdict verdict = session_.verdict();
  ASSERT_FALSE(verdict.status.has_value());
  EXPECT_NE(verdict.status.error().message.find("only 4 views"), std::string::npos);
}

// ---- What goes downstream -----------------------------------------------------------------------

// A worse result may follow before the next frame takes the better one along.
TEST_F(SessionUpdates, AnnounceTheResultThatWasBetter) {
  begin();
  show(3);
  solve(0.2);
  show(1);
  EXPECT_FALSE(solve(0.9)->better);
  const auto announced = session_.take_announcement();
  ASSERT_TRUE(announced.has_value());
  EXPECT_EQ(announced->expected_error, 0.2);
}

TEST_F(SessionUpdates, AnnounceNoCameraOfAnotherName) {
  begin();
  show(3);
  solve(0.2);
  change(changes()[2]);
  EXPECT_FALSE(session_.take_announcement().has_value());
  solve(0.9);
  EXPECT_EQ(session_.take_announcement()->camera, "right");
}

TEST_F(SessionUpdates, AnnounceNothingOfViewsThatAreGone) {
  begin();
  show(3);
  solve(0.2);
  ASSERT_TRUE(session_.remove_view(0));
  EXPECT_FALSE(session_.take_announcement().has_value());
}

// ---- Limits -------------------------------------------------------------------------------------

TEST_F(SessionUpdates, AreCompleteWhereThereAreAsManyViewsAsAreWanted) {
  for (const int most : {5, 4}) {
    begin();
    show(5);
    solve(0.1);
    SessionSettings full = settings_;
    full.max_views = most;
    set(full);
    const auto job = session_.take_solve();
    ASSERT_TRUE(job.has_value());
    EXPECT_TRUE(job->final);
    EXPECT_EQ(job->views.size(), 5u);
    session_.reported(*job);
    EXPECT_FALSE(show(1).report) << "nothing more is captured";
    // Another file has the final result too, without a view more.
    full.location = place("new.json");
    set(full);
    EXPECT_TRUE(session_.take_solve()->final);
  }
}

TEST_F(SessionUpdates, AreCompleteWhereTheErrorIsAsSmallAsIsWanted) {
  begin();
  show(4);
  solve(0.2);
  SessionSettings good = settings_;
  good.target_error = 0.1;
  set(good);
  EXPECT_FALSE(session_.take_solve().has_value());
  good.target_error = 0.3;
  set(good);
  const auto job = session_.take_solve();
  ASSERT_TRUE(job.has_value());
  EXPECT_TRUE(job->final);
  EXPECT_FALSE(show(1).report);
}

// The error is that of the lens before.
TEST_F(SessionUpdates, AreNotCompleteByTheErrorOfAnotherLens) {
  begin();
  show(4);
  solve(0.2);
  SessionSettings other = settings_;
  other.target_error = 0.3;
  other.model = "brown4";
  set(other);
  EXPECT_FALSE(session_.take_solve()->final);
  EXPECT_EQ(show(1).reached, "") << "it is being solved";
}

TEST_F(SessionUpdates, PostOneFinalResultOfTheSameViews) {
  SessionSettings settings;
  settings.max_views = 4;
  begin(settings);
  show(4);
  solve(0.1);
  SessionSettings other = settings_;
  other.target_error = 0.01;
  set(other);
  EXPECT_FALSE(session_.take_solve().has_value()) << "there is a final result of these views";
  EXPECT_FALSE(show(1).report);
  other.max_views = 5;
  set(other);
  EXPECT_EQ(show(1).reached, "max-views") << "there is room for one more";
}

TEST_F(SessionUpdates, SolveNothingOfTooFewViews) {
  begin();
  show(3);
  ASSERT_TRUE(session_.solve_now(settings_).has_value());
  ASSERT_TRUE(session_.take_solve()->final);
  ASSERT_TRUE(session_.remove_view(0));
  session_.resume();
  EXPECT_FALSE(session_.take_solve().has_value());
  show(1);
  EXPECT_TRUE(session_.take_solve()->final) << "it is owed still";
}

// A run may begin with an observation that comes before its first frame.
TEST_F(SessionUpdates, BeginWithTheOptionsThatAreSet) {
  SessionSettings settings;
  settings.capture_mode = CaptureChoice::kAll;
  settings.max_views = 3;
  session_.start(make_plan(settings).value(), true);
  EXPECT_EQ(session_.views().options().mode, CaptureMode::kAll);
  EXPECT_EQ(session_.views().options().max_views, 3);
  // The board of the run before may not come back.
  begin();
  show(1);
  EXPECT_TRUE(session_.hint().target.has_value());
  begin();
  EXPECT_FALSE(session_.hint().target.has_value());
}

// What was refused once is not refused again with whatever is set next, and does not hinder it.
TEST(PlanChanges, GoOnWithoutWhatWasRefused) {
  SessionSettings settings;
  const SessionPlan before = make_plan(settings).value();
  SessionSettings wrong = settings;
  wrong.initial = "nope";
  EXPECT_EQ(change_plan(before, settings, wrong).refused.size(), 1U);
  SessionSettings next = wrong;
  next.model = "pinhole";
  const PlanChange change = change_plan(before, wrong, next);
  EXPECT_TRUE(change.refused.empty());
  EXPECT_EQ(change.plan.options.model, "pinhole");
  EXPECT_FALSE(change.plan.initial.has_value());
  next.fix = "zzz";
  const PlanChange other = change_plan(before, wrong, next);
  ASSERT_EQ(other.refused.size(), 1U);
  EXPECT_NE(other.refused.front().message.find("zzz"), std::string::npos);
}

TEST(PlanChanges, GoOnWithoutACountThatWasRefused) {
  SessionSettings settings;
  settings.min_views = 10;
  const SessionPlan before = make_plan(settings).value();
  SessionSettings wrong = settings;
  wrong.max_views = 5;
  EXPECT_EQ(change_plan(before, settings, wrong).refused.size(), 1U);
  SessionSettings next = wrong;
  next.min_views = 12;
  const PlanChange change = change_plan(before, wrong, next);
  EXPECT_TRUE(change.refused.empty());
  EXPECT_EQ(change.plan.settings.min_views, 12);
  EXPECT_EQ(change.plan.settings.max_views, before.settings.max_views);
}

// What belongs together may be set in any order.
TEST(PlanChanges, TakeWhatWorksTogether) {
  SessionSettings settings;
  settings.model = "pinhole";
  const SessionPlan before = make_plan(settings).value();
  SessionSettings fixed = settings;
  fixed.fix = "k2";
  EXPECT_EQ(change_plan(before, settings, fixed).refused.size(), 1U) << "a pinhole has no k2";
  SessionSettings both = fixed;
  both.model = "brown5";
  const PlanChange change = change_plan(before, fixed, both);
  EXPECT_TRUE(change.refused.empty());
  EXPECT_EQ(change.plan.options.model, "brown5");
  EXPECT_EQ(change.plan.options.fix, std::vector<std::string>{"k2"});
}

}  // namespace
}  // namespace calvin
