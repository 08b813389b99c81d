// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a calibration session writes to its files, and when.
#include <filesystem>

#include "files_fixture.hpp"

namespace calvin {
namespace {

TEST_F(FilesOfSessions, GetTheFirstResultAndThoseThatAreBetter) {
  begin_with();
  show(3);
  EXPECT_TRUE(solve(0.5)->writing);
  EXPECT_TRUE(write().status.has_value());
  EXPECT_EQ(views_of(path_), 3);
  solve_again(0.6);
  EXPECT_FALSE(session_.take_write().has_value()) << "it is no better";
  solve_again(0.4);
  write();
  EXPECT_EQ(views_of(path_), 5);
  EXPECT_TRUE(notices().empty());
}

TEST_F(FilesOfSessions, AreNotAskedForWhereThereAreNone) {
  begin();
  show(3);
  EXPECT_FALSE(solve(0.5)->writing);
  EXPECT_FALSE(session_.take_write().has_value());
  EXPECT_EQ(session_.end_of_stream(), LastWork::kSolve);
  EXPECT_FALSE(solve(0.4)->writing);
  EXPECT_EQ(session_.end_of_stream(), LastWork::kNone);
}

TEST_F(FilesOfSessions, GetNothingOfWhatIsForgotten) {
  for (const bool reset : {true, false}) {
    SCOPED_TRACE(reset);
    begin_with();
    show(4);
    solve(0.1);
    const auto waiting = session_.take_write();
    ASSERT_TRUE(waiting.has_value());
    if (reset) session_.reset();
    if (!reset) {
      ASSERT_TRUE(session_.remove_view(0));
    }
    EXPECT_FALSE(session_.begin_write(*waiting));
    EXPECT_EQ(session_.end_of_stream(), reset ? LastWork::kNone : LastWork::kSolve);
    EXPECT_FALSE(session_.take_write().has_value());
  }
}

// A write that ends late tells nothing of the session that has begun meanwhile.
TEST_F(FilesOfSessions, CountForTheSessionThatWroteThemAlone) {
  begin_with();
  show(3);
  solve(0.1);
  const auto late = session_.take_write();
  ASSERT_TRUE(session_.begin_write(*late));
  session_.reset();
  show(3);
  solve(0.5);
  const auto own = session_.take_write();
  ASSERT_TRUE(own.has_value());
  session_.end_write(*late, {make_error(ErrorCode::kIo, "The disk is full."), path_, {}, {}});
  EXPECT_TRUE(session_.verdict().status.has_value());
  EXPECT_TRUE(notices().empty());
  session_.end_write(*late, {});
  session_.resume();
  EXPECT_TRUE(session_.take_write().has_value()) << "the own result is not written yet";
}

// A disk that hangs at the first file must not get the others once they are nobody's any more.
TEST_F(FilesOfSessions, ThatFollowStayWhereTheirSessionHasEnded) {
  begin_with("ros:" + folder_.path("cam.yaml") + ",opencv-json:" + folder_.path("cv.json"));
  show(3);
  solve(0.5);
  const auto job = session_.take_write();
  ASSERT_TRUE(session_.begin_write(*job));
  int files = 0;
  const auto outcome = write(*job, [&] {
    if (++files == 2) session_.reset();
    return session_.is_current(job->origin);
  });
  EXPECT_TRUE(outcome.status.has_value());
  EXPECT_EQ(folder_.entries(), 1u);
  EXPECT_EQ(views_of(path_), 3);
}

TEST_F(FilesOfSessions, SayWhatTheyHeldThoughAViewIsRemovedMeanwhile) {
  leave(0.01);
  begin_with();
  show(4);
  ASSERT_TRUE(session_.solve_now(settings_).has_value());
  solve(0.5);
  const auto job = session_.take_write();
  ASSERT_TRUE(session_.begin_write(*job));
  are_contradicted_ = true;
  const auto outcome = write(*job, [] { return true; });
  ASSERT_TRUE(session_.remove_view(0));
  session_.end_write(*job, outcome);
  const auto said = notices();
  ASSERT_EQ(said.size(), 1u);
  EXPECT_NE(said[0].find("It is kept as '" + path_ + "~'"), std::string::npos) << said[0];
}

// ---- What goes wrong ----------------------------------------------------------------------------

TEST_F(FilesOfSessions, ThatCannotBeWrittenAreSaidOnceAndTriedAtTheEnd) {
  begin_with();
  show(3);
  solve(0.5);
  fail_to_write();
  EXPECT_EQ(notices(), std::vector<std::string>{"The disk is full."});
  solve_again(0.4);
  fail_to_write();
  EXPECT_TRUE(notices().empty());
  ASSERT_TRUE(session_.solve_now(settings_).has_value());
  solve(0.3);
  fail_to_write();
  EXPECT_EQ(session_.verdict().status.error().message, "The disk is full.");
  EXPECT_TRUE(session_.verdict().files_wanted);
  EXPECT_EQ(session_.end_of_stream(), LastWork::kWrite);
  write();
  EXPECT_TRUE(session_.verdict().status.has_value());
  EXPECT_EQ(views_of(path_), 4);
  EXPECT_EQ(session_.end_of_stream(), LastWork::kNone);
}

TEST_F(FilesOfSessions, ThatCouldNotBeWrittenAtTheStartWereSaidThen) {
  SessionSettings settings;
  settings.location = path_;
  session_.start(make_plan(settings).value(), false);
  std::optional<Error> warning;
  ASSERT_TRUE(session_.set_size(scenes::kSize, warning));
  session_.set_live(false);
  settings_ = settings;
  show(3);
  solve(0.5);
  fail_to_write();
  EXPECT_TRUE(notices().empty());
  // Of other files nothing was said.
  settings.location = folder_.path("other.json");
  EXPECT_TRUE(set(settings).empty());
  solve(0.5);
  fail_to_write();
  EXPECT_EQ(notices().size(), 1u);
}

// Nobody may speak while a flush lasts: what a write had to say then is said after it.
TEST_F(FilesOfSessions, LoseNoNoticeThatNobodyTook) {
  leave(0.01);
  begin_with();
  show(3);
  solve(0.5);
  write();
  session_.resume();
  EXPECT_TRUE(session_.has_notice());
  solve_again(0.4);
  fail_to_write();
  EXPECT_EQ(notices().size(), 2u);
  session_.say_later({Notice::Kind::kWarning, {ErrorCode::kIo, "Nobody could say this."}});
  EXPECT_EQ(session_.take_notice()->error.message, "Nobody could say this.");
  EXPECT_FALSE(session_.has_notice());
  session_.say_later({Notice::Kind::kWarning, {ErrorCode::kIo, "Nor this."}});
  session_.reset();
  EXPECT_FALSE(session_.has_notice());
}

TEST_F(FilesOfSessions, OfAFinalResultAreFinalUntilTheyAreWritten) {
  leave(0.01);
  begin_with();
  show(3);
  ASSERT_TRUE(session_.solve_now(settings_).has_value());
  solve(0.5);
  // A result on the way takes the place of the final one, which waits for the disk.
  solve_again(0.4);
  EXPECT_TRUE(session_.take_write()->final);
  session_.resume();
  fail_to_write();
  session_.resume();
  const auto again = session_.take_write();
  ASSERT_TRUE(again.has_value());
  EXPECT_TRUE(again->final) << "it is tried again";
  // With a view the result is gone that was final.
  ASSERT_TRUE(session_.remove_view(0));
  solve(0.3);
  EXPECT_FALSE(session_.take_write()->final);
}

TEST_F(FilesOfSessions, ThatAreLateAreNamedOnce) {
  using namespace std::chrono_literals;
  begin_with("ros:" + folder_.path("cam.yaml"));
  show(3);
  solve(0.5);
  const auto job = session_.take_write();
  ASSERT_TRUE(session_.begin_write(*job));
  const auto notice = session_.files_are_late(1s);
  ASSERT_TRUE(notice.has_value());
  EXPECT_EQ(notice->error.message.find("The write of '" + path_ + "', '" +
                                       folder_.path("cam.yaml") + "' has not ended after 1 s"),
            0u);
  EXPECT_FALSE(session_.files_are_late(1s).has_value());
}

TEST_F(FilesOfSessions, AreWrittenAnewWhereOthersAreNamed) {
  begin_with();
  show(3);
  solve(0.1);
  write();
  SessionSettings other = settings_;
  other.location = folder_.path("other.json");
  EXPECT_TRUE(set(other).empty());
  const auto published = solve(0.2);
  EXPECT_TRUE(published->better) << "for a file that has nothing";
  write();
  EXPECT_EQ(views_of(other.location), 3);
}

// What another session left would be kept in a file that this one writes.
TEST_F(FilesOfSessions, AreNoCopiesOfEachOther) {
  for (const auto& [location, exports] :
       {std::pair(path_, "ros:" + path_ + "~"),
        {path_ + "~", "ros:" + path_},
        {std::string(), "ros:" + path_ + ",opencv-yaml:" + folder_.path("./cam.json~")}}) {
    SessionSettings settings;
    settings.location = location;
    settings.exports = exports;
    const auto plan = make_plan(settings);
    ASSERT_FALSE(plan.has_value()) << exports;
    EXPECT_NE(plan.error().message.find("cam.json~' is to hold the calibration, and what"),
              std::string::npos)
        << plan.error().message;
  }
}

}  // namespace
}  // namespace calvin
