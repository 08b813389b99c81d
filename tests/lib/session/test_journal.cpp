// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The journal of a session: whatever ends a run, the next one goes on with every view.
#include "calvin/session/journal.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "calvin/core/file.hpp"
#include "calvin/io/observations.hpp"
#include "file_size_limit.hpp"
#include "session_fixture.hpp"
#include "temporary_folder.hpp"

namespace calvin {
namespace {

class Journals : public CalibrationSessions {
 protected:
  Journals() { settings_.journal = folder_.path("views.jsonl"); }

  // A run with the journal, for frames of scenes::kSize; what it takes up goes into the session.
  void run() {
    open();
    begin_with_journal();
  }
  void open() {
    journal_.reset();
    auto opened = Journal::open(settings_);
    ASSERT_TRUE(opened) << opened.error().message;
    journal_ = *std::move(opened);
  }
  void begin_with_journal() {
    settings_.capture_mode = CaptureChoice::kAll;
    session_.start(make_plan(settings_).value(), true);
    session_.begin_journal(journal_->take_content().views);
    set_size(scenes::kSize);
    session_.set_live(false);
  }
  void set_size(ImageSize size) {
    std::optional<Error> warning;
    EXPECT_TRUE(session_.set_size(size, warning));
    EXPECT_FALSE(warning.has_value());
  }
  // As calibsolve does after each call.
  void write_down() {
    for (JournalEntry& entry : session_.take_journal()) journal_->add(std::move(entry));
    const Status written = journal_->write();
    EXPECT_TRUE(written) << written.error().message;
  }
  void show_and_write(int count) {
    for (int i = 0; i < count; ++i) {
      show(1);
      write_down();
    }
  }
  // The timestamps of the views.
  static std::vector<std::uint64_t> times_of(const Session::Views& views) {
    std::vector<std::uint64_t> times;
    for (const auto& view : views) times.push_back(view->observation.timestamp);
    return times;
  }
  [[nodiscard]] std::vector<std::uint64_t> kept() const {
    return times_of(session_.views().views());
  }
  // What the next run would take up.
  [[nodiscard]] std::vector<std::uint64_t> held() const {
    std::vector<std::uint64_t> times;
    const auto file = read_observations(settings_.journal);
    if (!file) return times;
    for (const Observation& seen : file->observations) times.push_back(seen.timestamp);
    return times;
  }

  TemporaryFolder folder_;
  std::unique_ptr<Journal> journal_;
};

TEST_F(Journals, HoldEachViewAsItWasTaken) {
  run();
  show_and_write(4);
  const Session::Views before = session_.views().views();
  run();
  const Session::Views after = session_.views().views();
  ASSERT_EQ(after.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    const Observation& a = before[i]->observation;
    const Observation& b = after[i]->observation;
    EXPECT_EQ(before[i]->board, after[i]->board);
    EXPECT_EQ(a.camera, b.camera);
    EXPECT_EQ(a.board, b.board);
    EXPECT_EQ(a.timestamp, b.timestamp);
    EXPECT_EQ(a.image_size, b.image_size);
    EXPECT_EQ(a.ids, b.ids);
    EXPECT_EQ(a.sigma, b.sigma);
    for (std::size_t k = 0; k < a.uv.size(); ++k) {
      EXPECT_EQ(a.uv[k].u, b.uv[k].u);
      EXPECT_EQ(a.uv[k].v, b.uv[k].v);
    }
  }
}

TEST_F(Journals, LetTheNextRunSolveAtOnce) {
  run();
  show_and_write(4);
  run();
  EXPECT_EQ(session_.progress().views, 4);
  const auto job = session_.take_solve();
  ASSERT_TRUE(job.has_value());
  EXPECT_EQ(job->views.size(), 4u);
  EXPECT_EQ(job->options.camera, "left");
  ASSERT_TRUE(session_.has_notice());
  const auto notice = session_.take_notice();
  EXPECT_EQ(notice->kind, Notice::Kind::kInfo);
  EXPECT_NE(notice->error.message.find("4 views"), std::string::npos) << notice->error.message;
  write_down();
  EXPECT_EQ(held().size(), 4u) << "what was taken up is not written again";
}

// What a rolling shutter does to a board that moves can be mended once the time of a frame is
// known.
TEST_F(Journals, SolveAgainWithTheTimesOfFrames) {
  run();
  show_and_write(4);
  open();
  settings_.max_views = 4;
  begin_with_journal();
  const auto first = session_.take_solve();
  ASSERT_TRUE(first.has_value());
  EXPECT_FALSE(first->options.readout.has_value());
  show(2);
  EXPECT_FALSE(session_.take_solve().has_value()) << "two frames tell one time, behind the second";
  show(1);
  const auto second = session_.take_solve();
  ASSERT_TRUE(second.has_value());
  EXPECT_TRUE(second->options.readout.has_value());
  EXPECT_EQ(second->views.size(), 4u);
  show(3);
  EXPECT_FALSE(session_.take_solve().has_value());
}

// A recording that was cut short and is played again, from its beginning.
TEST_F(Journals, CountAFrameThatComesAgainOnce) {
  run();
  show_and_write(4);
  run();
  frame_ = 0;
  EXPECT_EQ(show(1).reason, Reason::kTooSimilar);
  show_and_write(6);
  EXPECT_EQ(kept().size(), 7u);
  EXPECT_EQ(held(), kept());
}

TEST_F(Journals, KnowWhatWasRemovedAndForgotten) {
  run();
  show_and_write(4);
  EXPECT_TRUE(session_.remove_view(1));
  write_down();
  show_and_write(1);
  const auto left = kept();
  EXPECT_EQ(left.size(), 4u);
  EXPECT_EQ(held(), left);
  run();
  EXPECT_EQ(kept(), left);
  session_.reset();
  write_down();
  EXPECT_TRUE(held().empty());
  show_and_write(2);
  EXPECT_EQ(held(), kept());
  run();
  EXPECT_EQ(kept().size(), 2u);
}

// A kill or a loss of power leaves any part of what was written.
TEST_F(Journals, MayEndAnywhere) {
  run();
  std::vector<std::pair<std::size_t, std::vector<std::uint64_t>>> states = {{0, {}}};
  const auto note = [&] { states.emplace_back(read_file(settings_.journal)->size(), kept()); };
  for (int i = 0; i < 2; ++i) {
    show_and_write(1);
    note();
  }
  EXPECT_TRUE(session_.remove_view(0));
  write_down();
  note();
  session_.reset();
  write_down();
  note();
  show_and_write(1);
  note();
  const std::string whole = *read_file(settings_.journal);
  journal_.reset();
  std::size_t state = 0;
  for (std::size_t length = 0; length <= whole.size(); length += length % 97 == 0 ? 1 : 7) {
    ASSERT_TRUE(write_file(settings_.journal, whole.substr(0, length)));
    while (state + 1 < states.size() && states[state + 1].first <= length) ++state;
    open();
    ASSERT_TRUE(journal_) << length;
    const Journal::Content content = journal_->take_content();
    EXPECT_EQ(times_of(content.views), states[state].second) << length;
    EXPECT_EQ(content.unusable, 0u);
    // It goes on behind what is whole.
    frame_ = 100;
    begin_with_journal();
    show_and_write(1);
    ASSERT_FALSE(held().empty()) << length;
    EXPECT_EQ(held().back(), times(100).timestamp) << length;
  }
}

TEST_F(Journals, WriteWhatADiskDidNotTakeOnceItDoes) {
  run();
  show_and_write(2);
  show(2);
  for (JournalEntry& entry : session_.take_journal()) journal_->add(std::move(entry));
  {
    const FileSizeLimit limit(read_file(settings_.journal)->size() + 10);
    const Status first = journal_->write();
    ASSERT_FALSE(first);
    EXPECT_EQ(first.error().code, ErrorCode::kIo);
    EXPECT_TRUE(journal_->write()) << "it is said once";
  }
  EXPECT_TRUE(journal_->is_waiting());
  EXPECT_EQ(held().size(), 2u);
  show_and_write(1);
  EXPECT_EQ(held(), kept());
  EXPECT_FALSE(journal_->is_waiting());
}

TEST_F(Journals, KeepTheViewsOfFramesOfOtherSizes) {
  run();
  show_and_write(4);
  set_size({320, 240});
  EXPECT_TRUE(kept().empty());
  const auto notice = session_.take_notice();
  ASSERT_TRUE(notice.has_value());
  EXPECT_NE(notice->error.message.find("4 views"), std::string::npos) << notice->error.message;
  write_down();
  EXPECT_EQ(held().size(), 4u);
  set_size(scenes::kSize);
  EXPECT_EQ(kept().size(), 4u);
  // Whoever removes one keeps those that wait.
  set_size({320, 240});
  EXPECT_FALSE(session_.remove_view(0));
  set_size(scenes::kSize);
  EXPECT_TRUE(session_.remove_view(0));
  write_down();
  EXPECT_EQ(held().size(), 3u);
  set_size({320, 240});
  session_.reset();
  write_down();
  EXPECT_TRUE(held().empty());
  set_size(scenes::kSize);
  EXPECT_TRUE(kept().empty());
}

TEST_F(Journals, OfAnotherBoardOrCameraAreRefused) {
  run();
  show_and_write(2);
  journal_.reset();
  const auto refused = [&](const SessionSettings& settings, const char* word) {
    const auto opened = Journal::open(settings);
    if (opened) return false;
    return opened.error().message.find(word) != std::string::npos;
  };
  SessionSettings other = settings_;
  other.board = "checkerboard:8x5:30mm";
  EXPECT_TRUE(refused(other, "checkerboard:8x5:30mm"));
  other.board = scenes::kBoard.text() + ";checkerboard:8x5:30mm";
  EXPECT_TRUE(Journal::open(other)) << "one of the boards is the one";
  other.board = "whatever the detector will refuse";
  EXPECT_TRUE(Journal::open(other));
  other = settings_;
  other.camera = "right";
  EXPECT_TRUE(refused(other, "'"));
  EXPECT_TRUE(refused(other, "right"));
  other.camera = "left";
  EXPECT_TRUE(Journal::open(other));
}

// Nobody names the cameras, but what they see does.
TEST_F(Journals, OfOneCameraTakeNoViewOfAnother) {
  run();
  show_and_write(2);
  Observation other = this->seen(50);
  other.camera = "right";
  const auto view = std::make_shared<const View>(View{other, scenes::kBoard});
  journal_->add({false, {view}, ""});
  const Status written = journal_->write();
  ASSERT_FALSE(written);
  EXPECT_NE(written.error().message.find("right"), std::string::npos) << written.error().message;
  run();
  journal_->add({false, {view}, "left"});
  EXPECT_TRUE(journal_->write()) << "the user says that it is the same";
  EXPECT_EQ(held().size(), 3u);
}

// Each view that is taken out leaves a copy of the others behind.
TEST_F(Journals, AreWrittenAnewWhereMostOfThemIsForgotten) {
  run();
  show_and_write(40);
  for (int i = 0; i < 20; ++i) {
    EXPECT_TRUE(session_.remove_view(0));
    write_down();
  }
  const auto left = kept();
  const std::size_t before = read_file(settings_.journal)->size();
  ASSERT_GT(before, std::size_t{1} << 20);
  run();
  EXPECT_EQ(kept(), left);
  EXPECT_EQ(held(), left);
  EXPECT_LT(read_file(settings_.journal)->size(), before / 4);
  EXPECT_FALSE(Journal::open(settings_)) << "the new one is ours too";
  show_and_write(1);
  EXPECT_EQ(held().size(), left.size() + 1);
  // As a file that a container has mounted: it is written in its place.
  for (int i = 0; i < 20; ++i) show_and_write(1);
  for (int i = 0; i < 20; ++i) {
    EXPECT_TRUE(session_.remove_view(0));
    write_down();
  }
  const auto few = kept();
  const int inside = ::open(settings_.journal.c_str(), O_RDONLY);
  settings_.journal = "/proc/self/fd/" + std::to_string(inside);
  run();
  EXPECT_EQ(kept(), few);
  show_and_write(1);
  EXPECT_EQ(held().size(), few.size() + 1);
  ::close(inside);
}

TEST_F(Journals, OfOneBoardTakeNoViewOfAnother) {
  run();
  show_and_write(2);
  run();
  Observation seen = this->seen(50);
  seen.board = "checkerboard:40x40:30mm";
  const auto board = parse_board(seen.board);
  journal_->add({false, {std::make_shared<const View>(View{seen, *board})}, ""});
  const Status written = journal_->write();
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(held().size(), 2u);
  show(1);
  for (JournalEntry& entry : session_.take_journal()) journal_->add(std::move(entry));
  EXPECT_TRUE(journal_->write());
  EXPECT_EQ(held().size(), 2u) << "nothing more is written";
}

TEST_F(Journals, NameTheCameraAsItIsSet) {
  settings_.camera = "door";
  run();
  show_and_write(1);
  const auto file = read_observations(settings_.journal);
  ASSERT_TRUE(file);
  EXPECT_EQ(file->observations.at(0).camera, "door");
}

TEST_F(Journals, LeaveOutWhatCannotBeAView) {
  Observation good = seen(0);
  Observation beyond = seen(1);
  beyond.uv[0].u = 1e6;
  Observation unknown = seen(2);
  unknown.board = "hexagons:9";
  Observation none = seen(3);
  none.ids.clear();
  none.uv.clear();
  const auto text = print_observations({good.board, {good, beyond, unknown, none}, 0});
  ASSERT_TRUE(text.has_value());
  ASSERT_TRUE(write_file(settings_.journal, *text));
  open();
  const Journal::Content content = journal_->take_content();
  EXPECT_EQ(content.views.size(), 1u);
  EXPECT_EQ(content.unusable, 3u);
}

TEST_F(Journals, AreNoOtherFiles) {
  for (const char* content : {"a letter", "{\"format\":\"calvin-calibration\",\"version\":1}\n",
                              "{\"format\":\"calvin-obs", "\n", "{}\n", "\xff\xd8\xff"}) {
    ASSERT_TRUE(write_file(settings_.journal, content));
    const auto opened = Journal::open(settings_);
    const bool torn_header = std::string_view(content) == "{\"format\":\"calvin-obs";
    EXPECT_EQ(opened.has_value(), torn_header) << content;
    if (!torn_header) {
      EXPECT_EQ(*read_file(settings_.journal), content) << "it stays as it is";
    }
  }
  SessionSettings both = settings_;
  both.location = folder_.path("./views.jsonl");
  EXPECT_FALSE(make_plan(both)) << "the calibration would take its place";
}

}  // namespace
}  // namespace calvin
