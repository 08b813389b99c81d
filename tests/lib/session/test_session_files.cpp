// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a calibration session writes to its files, when, and what it leaves there of others.
#include <filesystem>

#include "calvin/core/file.hpp"
#include "calvin/io/calibration_io.hpp"
#include "session_fixture.hpp"
#include "temporary_folder.hpp"

namespace calvin {
namespace {

class FilesOfSessions : public CalibrationSessions {
 protected:
  void begin_with(const std::string& exports = {}) {
    SessionSettings settings;
    settings.location = path_;
    settings.exports = exports;
    begin(settings);
  }
  // What another session left at the place.
  void leave(std::optional<double> error, const char* camera = "left") {
    Calibration left = camera_.to_calibration();
    left.camera = camera;
    left.expected_error = error;
    left.created = "another session";
    ASSERT_TRUE(write_calibration(path_, left).has_value());
  }
  [[nodiscard]] bool is_left(const std::string& path) const {
    const auto found = read_calibration(path);
    return found && found->created == "another session";
  }
  [[nodiscard]] int views_of(const std::string& path) const {
    const auto found = read_calibration(path);
    return found ? static_cast<int>(found->views.size()) : -1;
  }
  // The write that waits; its outcome as the disk gives it.
  SessionFiles::Outcome write() {
    const auto job = session_.take_write();
    EXPECT_TRUE(job.has_value()) << "no write is asked for";
    if (!job || !session_.begin_write(*job)) return {};
    auto outcome = files_.write(job->files, job->calibration, job->final, job->origin.session,
                                [&] { return session_.is_current(job->origin); });
    session_.end_write(*job, outcome);
    return outcome;
  }
  // Or what a disk would say that is full.
  void fail_to_write() {
    const auto job = session_.take_write();
    ASSERT_TRUE(job.has_value());
    ASSERT_TRUE(session_.begin_write(*job));
    session_.end_write(*job, {make_error(ErrorCode::kIo, "The disk is full."), {}, {}});
  }
  std::vector<std::string> notices() {
    std::vector<std::string> said;
    while (const auto notice = session_.take_notice()) said.push_back(notice->error.message);
    return said;
  }
  // A view more, so that there is another solve, with that result.
  void solve_again(std::optional<double> error) {
    session_.resume();
    show(1);
    solve(error);
  }

  TemporaryFolder folder_;
  std::string path_ = folder_.path("cam.json");
  SessionFiles files_;
};

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

TEST_F(FilesOfSessions, KeepWhatAnotherSessionLeftUntilAResultIsFinal) {
  leave(0.01);
  begin_with();
  show(3);
  solve(0.5);
  EXPECT_EQ(write().kept, path_);
  EXPECT_TRUE(is_left(path_));
  solve_again(0.4);
  write();
  const auto said = notices();
  ASSERT_EQ(said.size(), 1u) << "once, however many results there are";
  EXPECT_EQ(said[0].find("'" + path_ + "' holds the calibration of another session"), 0u);
  ASSERT_TRUE(session_.solve_now(settings_).has_value());
  solve(0.3);
  write();
  EXPECT_EQ(views_of(path_), 4);
  EXPECT_TRUE(is_left(path_ + "~"));
  EXPECT_EQ(notices().size(), 1u) << "it was better by its own figures";
  // From here on the file is this session's.
  solve_again(0.2);
  write();
  EXPECT_EQ(views_of(path_), 5);
  EXPECT_TRUE(is_left(path_ + "~"));
}

TEST_F(FilesOfSessions, AreReplacedAtOnceBySomethingAsGoodOfTheSameCamera) {
  const struct {
    std::optional<double> error;
    const char* camera;
    bool stays;
  } kLeft[] = {{0.5, "left", false},
               {0.49, "left", true},
               {0.5, "right", true},
               {std::nullopt, "left", true}};
  for (const auto& [error, camera, stays] : kLeft) {
    leave(error, camera);
    begin_with();
    show(3);
    solve(0.5);
    write();
    EXPECT_EQ(is_left(path_), stays) << camera << " " << error.value_or(-1);
    if (!stays) {
      EXPECT_TRUE(is_left(path_ + "~"));
    }
  }
}

// Of two sessions in a row that were worse, the second one takes the place of the first.
TEST_F(FilesOfSessions, KeepTheBestOfSeveralSessions) {
  leave(0.01);
  for (const double error : {0.3, 0.4, 0.35}) {
    begin_with();
    show(3);
    solve(error);
    write();
    ASSERT_TRUE(session_.solve_now(settings_).has_value());
    solve(error);
    write();
    EXPECT_FALSE(is_left(path_));
    EXPECT_TRUE(is_left(path_ + "~")) << error;
    const auto said = notices();
    const std::string last = said.empty() ? "" : said.back();
    EXPECT_EQ(last.find("better") != std::string::npos, error != 0.35) << last;
    EXPECT_EQ(last.find("better still, and stays") != std::string::npos, error == 0.4) << last;
  }
}

// A file of boards, views that another session wrote down, a letter.
TEST_F(FilesOfSessions, KeepWhatIsNoCalibration) {
  for (const char* copy : {"~", "~2~", "~3~"}) {
    ASSERT_TRUE(write_file(path_, std::string("a letter ") + copy).has_value());
    begin_with();
    show(3);
    solve(0.3);
    write();
    EXPECT_EQ(views_of(path_), 3);
    EXPECT_EQ(read_file(path_ + copy).value_or(""), std::string("a letter ") + copy);
    const auto said = notices();
    ASSERT_EQ(said.size(), 1U);
    EXPECT_NE(said[0].find("is kept as '" + path_ + copy + "'"), std::string::npos) << said[0];
    solve_again(0.2);
    write();
    EXPECT_TRUE(notices().empty()) << "it is this session's";
  }
}

// An error of so many pixels is less in a larger picture.
TEST_F(FilesOfSessions, CompareErrorsInPartsOfThePicture) {
  Calibration left = camera_.to_calibration();
  left.camera = "left";
  left.image_size = {left.image_size.width / 2, left.image_size.height / 2};
  left.expected_error = 0.2;
  ASSERT_TRUE(write_calibration(path_, left).has_value());
  begin_with();
  show(3);
  solve(0.3);
  ASSERT_TRUE(session_.solve_now(settings_).has_value());
  solve(0.3);
  write();
  EXPECT_EQ(views_of(path_), 3);
  for (const std::string& said : notices()) EXPECT_EQ(said.find("better"), std::string::npos);
}

TEST_F(FilesOfSessions, AreAnothersAgainForTheNextSession) {
  begin_with();
  show(4);
  solve(0.1);
  write();
  session_.reset();
  show(3);
  solve(0.5);
  EXPECT_EQ(write().kept, path_);
  EXPECT_EQ(views_of(path_), 4);
  EXPECT_EQ(notices().size(), 1u);
}

// What someone has put there since is not overwritten by a result on the way.
TEST_F(FilesOfSessions, AreAnothersWhereSomeoneElseHasWrittenThem) {
  begin_with();
  show(3);
  solve(0.5);
  write();
  leave(0.01);
  solve_again(0.4);
  write();
  EXPECT_TRUE(is_left(path_));
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
  session_.end_write(*late, {make_error(ErrorCode::kIo, "The disk is full."), path_, {}});
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
  const auto outcome =
      files_.write(job->files, job->calibration, job->final, job->origin.session, [&] {
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
  const auto outcome = files_.write(job->files, job->calibration, job->final, job->origin.session,
                                    [] { return true; });
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
