// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a session leaves of what it finds where its files are to be, and of what it replaces.
#include <filesystem>
#include <string>

#include <fmt/format.h>

#include "files_fixture.hpp"

namespace calvin {
namespace {

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
  are_contradicted_ = true;
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

// What a final result does to the calibration of another session, and what is said of it.
TEST_F(FilesOfSessions, KeepWhatIsBetterAndNotContradicted) {
  struct Case {
    double before;
    const char* camera;
    bool contradicted;
    bool overwrite;
    bool stays;
    const char* said;  // "" for nothing
  };
  const Case kCases[] = {
      {0.2, "left", false, false, true, "overwrite=true"},
      {0.2, "left", true, false, false, "took its place"},
      {0.2, "left", false, true, false, "took its place"},
      {0.2, "right", false, false, false, "took its place"},
      {0.3, "left", false, false, false, ""},
      {0.29, "left", false, false, false, ""},  // which is as good
      {0.3, "right", false, false, false, "a file of its own"},
  };
  for (const Case& c : kCases) {
    SCOPED_TRACE(fmt::format("{} {} {} {}", c.before, c.camera, c.contradicted, c.overwrite));
    std::filesystem::remove(path_ + "~");
    leave(c.before, c.camera);
    begin_with({}, c.overwrite);
    are_contradicted_ = c.contradicted;
    show(3);
    ASSERT_TRUE(session_.solve_now(settings_).has_value());
    solve(0.3);
    write();
    EXPECT_EQ(is_left(path_), c.stays);
    EXPECT_EQ(is_left(path_ + "~"), !c.stays);
    const auto said = notices();
    ASSERT_EQ(said.size(), *c.said == '\0' ? 0U : 1U);
    EXPECT_TRUE(said.empty() || said[0].find(c.said) != std::string::npos) << said[0];
  }
}

// An export says no error of its own: it goes on saying the same as the file beside it.
TEST_F(FilesOfSessions, KeepExportsBesideWhatIsBetter) {
  const std::string cv = folder_.path("cv.json");
  leave(0.2);
  ASSERT_TRUE(write_calibration(cv, *read_calibration(path_), "opencv-json").has_value());
  const auto before = read_file(cv);
  begin_with("opencv-json:" + cv);
  show(3);
  ASSERT_TRUE(session_.solve_now(settings_).has_value());
  solve(0.3);
  write();
  EXPECT_TRUE(is_left(path_));
  EXPECT_EQ(read_file(cv).value_or(""), before.value_or("?"));
}

TEST_F(FilesOfSessions, AreReplacedAtOnceWhereThatIsSet) {
  leave(0.01);
  begin_with({}, true);
  show(3);
  solve(0.5);
  write();
  EXPECT_EQ(views_of(path_), 3);
  EXPECT_TRUE(is_left(path_ + "~"));
}

// Whether that was a loss is said of the final result: the first one of a few views is always
// worse.
TEST_F(FilesOfSessions, AreSaidToBeLostByTheFinalResult) {
  for (const double last : {0.1, 0.3}) {
    std::filesystem::remove(path_ + "~");
    leave(0.2);
    begin_with({}, true);
    show(3);
    solve(0.5);
    write();
    EXPECT_EQ(notices().size(), 0U);
    ASSERT_TRUE(session_.solve_now(settings_).has_value());
    solve(last);
    write();
    const auto said = notices();
    ASSERT_EQ(said.size(), last > 0.2 ? 1U : 0U);
    EXPECT_TRUE(said.empty() || said[0].find("with an expected error of 0.2") != std::string::npos)
        << said[0];
    EXPECT_TRUE(is_left(path_ + "~"));
  }
}

// Of two sessions in a row that were worse, the second one takes the place of the first.
TEST_F(FilesOfSessions, KeepTheBestOfSeveralSessions) {
  leave(0.01);
  are_contradicted_ = true;
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

// A film, which is longer than what is read of a calibration.
TEST_F(FilesOfSessions, KeepWhatIsLargerThanAnyCalibration) {
  ASSERT_TRUE(write_file(path_, "film").has_value());
  std::filesystem::resize_file(path_, kMaxFileBytes + 1);
  begin_with();
  show(3);
  solve(0.3);
  write();
  EXPECT_EQ(views_of(path_), 3);
  EXPECT_EQ(std::filesystem::file_size(path_ + "~"), kMaxFileBytes + 1);
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

}  // namespace
}  // namespace calvin
