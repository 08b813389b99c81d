// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a session makes of its camera: a lens that moves, and frames that do not come.

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "session_fixture.hpp"

namespace calvin {

namespace {

LensState lens_at(std::optional<int> focus, std::optional<int> zoom, bool autofocus = false) {
  return {{"/dev/video0", "A camera", "usb-1", autofocus}, focus, zoom};
}

// Each notice as "INFO ..." or "WARNING ...".
std::vector<std::string> told(CalibrationSession& session) {
  std::vector<std::string> words;
  while (const auto notice = session.take_notice()) {
    words.push_back((notice->kind == Notice::Kind::kInfo ? "INFO " : "WARNING ") +
                    notice->error.message);
  }
  return words;
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

class Watch : public CalibrationSessions {
 protected:
  void begin_with_device() {
    SessionSettings settings;
    settings.device = "/dev/video0";
    begin(settings);
    ASSERT_EQ(session_.lens_node(), "/dev/video0");
  }
  // What was told of one more reading.
  std::vector<std::string> see(const Result<LensState>& read) {
    session_.see_lens(read);
    return told(session_);
  }
  // The one thing that was told.
  std::string only(const std::vector<std::string>& words) {
    EXPECT_EQ(words.size(), 1U);
    return words.empty() ? "" : words.front();
  }
  // Of all views.
  LensState kept() {
    EXPECT_TRUE(session_.solve_now(settings_).has_value());
    return of(session_.take_solve());
  }
  static LensState of(const std::optional<SolveJob>& job) {
    EXPECT_TRUE(job && job->lens);
    return job && job->lens ? *job->lens : LensState{};
  }
  std::vector<std::string> seconds(int count, bool expected = true) {
    for (int i = 0; i < count; ++i) session_.second_passed(expected);
    return told(session_);
  }
};

// ---- The lens -----------------------------------------------------------------------------------

TEST_F(Watch, ALensThatStandsStillIsKeptWithTheCalibration) {
  begin_with_device();
  EXPECT_TRUE(see(lens_at(30, 120)).empty());
  show(4);
  EXPECT_TRUE(see(lens_at(30, 120)).empty());
  show(1);
  const LensState lens = kept();
  EXPECT_EQ(lens.focus, 30);
  EXPECT_EQ(lens.zoom, 120);
  EXPECT_EQ(lens.device.name, "A camera");
}

// The first view may come before the first reading has ended.
TEST_F(Watch, TheFirstReadingCountsForTheViewsBefore) {
  begin_with_device();
  show(4);
  const auto job = session_.take_solve();
  ASSERT_TRUE(job);
  EXPECT_FALSE(job->lens);
  EXPECT_TRUE(see(lens_at(30, {})).empty());
  show(1);
  EXPECT_EQ(kept().focus, 30);
  EXPECT_TRUE(has(only(see(lens_at(31, {}))), "focus from 30 to 31"));
}

TEST_F(Watch, BeforeTheFirstViewALensMayMove) {
  begin_with_device();
  EXPECT_TRUE(see(lens_at(30, 120)).empty());
  EXPECT_TRUE(see(lens_at(80, 100)).empty());
  show(4);
  EXPECT_EQ(kept().focus, 80);
}

TEST_F(Watch, AMoveIsToldOnceWithBothPlacesAndTheWayBack) {
  begin_with_device();
  EXPECT_TRUE(see(lens_at(30, 120)).empty());
  show(4);
  EXPECT_TRUE(see(lens_at(30, 120)).empty());
  const std::string words = only(see(lens_at(80, 100)));
  EXPECT_TRUE(has(words, "WARNING The lens of the camera '/dev/video0' (A camera) was moved"));
  EXPECT_TRUE(has(words, "focus from 30 to 80, zoom from 120 to 100")) << words;
  EXPECT_TRUE(has(words, "v4l2-ctl -d /dev/video0 -c focus_absolute=30,zoom_absolute=120"));
  EXPECT_TRUE(has(words, "signal reset"));
  EXPECT_TRUE(see(lens_at(80, 100)).empty());
  EXPECT_TRUE(see(lens_at(90, 100)).empty());
  const std::string back = only(see(lens_at(30, 120)));
  EXPECT_TRUE(has(back, "INFO ") && has(back, "is where it was at the first view")) << back;
  EXPECT_FALSE(has(back, "reset")) << back;
  EXPECT_TRUE(has(only(see(lens_at(31, 120))), "focus from 30 to 31"));
}

// No view was taken while it was elsewhere: all views are of one focus.
TEST_F(Watch, AMoveWithoutAViewLosesNothing) {
  begin_with_device();
  (void)see(lens_at(30, 120));
  show(4);
  (void)see(lens_at(30, 120));
  (void)see(lens_at(80, 120));
  EXPECT_EQ(kept().focus, 30);
  (void)see(lens_at(30, 120));
  show(1);
  EXPECT_EQ(kept().focus, 30);
}

TEST_F(Watch, ViewsOfTwoPlacesKeepNone) {
  begin_with_device();
  (void)see(lens_at(30, 120));
  show(4);
  (void)see(lens_at(30, 120));
  (void)see(lens_at(80, 120));
  show(1);
  LensState lens = kept();
  EXPECT_FALSE(lens.focus);
  EXPECT_EQ(lens.zoom, 120);
  EXPECT_TRUE(has(only(see(lens_at(30, 120))), "Views were taken meanwhile"));
  show(1);
  EXPECT_FALSE(kept().focus);
  // A new session begins with the lens where it is.
  session_.reset();
  (void)see(lens_at(80, 120));
  show(4);
  EXPECT_EQ(kept().focus, 80);
}

// Whether such a view was taken before the move nobody knows.
TEST_F(Watch, AViewBetweenTwoReadingsThatDifferIsOfNeither) {
  begin_with_device();
  (void)see(lens_at(30, 120));
  show(4);
  (void)see(lens_at(80, 120));
  show(1);
  EXPECT_FALSE(kept().focus);
}

TEST_F(Watch, AutofocusIsToldOnceAndKeepsNoFocus) {
  begin_with_device();
  const std::string words = only(see(lens_at(30, 120, true)));
  EXPECT_TRUE(has(words, "WARNING Autofocus is on"));
  EXPECT_TRUE(has(words, "v4l2-ctl -d /dev/video0 -c focus_automatic_continuous=0"));
  EXPECT_TRUE(has(words, "extra-controls=\"c,focus_automatic_continuous=0\""));
  EXPECT_TRUE(see(lens_at(30, 120, true)).empty());
  show(4);
  LensState lens = kept();
  EXPECT_FALSE(lens.focus);
  EXPECT_EQ(lens.zoom, 120);
  EXPECT_EQ(lens.device.autofocus, true);
  const std::string off = only(see(lens_at(30, 120, false)));
  EXPECT_TRUE(has(off, "INFO Autofocus") && has(off, "signal reset")) << off;
  EXPECT_TRUE(has(only(see(lens_at(30, 120, true))), "WARNING Autofocus is on"));
}

TEST_F(Watch, AutofocusThatWasOffForAllViewsKeepsTheFocus) {
  begin_with_device();
  (void)see(lens_at(30, {}, true));
  EXPECT_FALSE(has(only(see(lens_at(42, {}, false))), "reset"));
  show(4);
  (void)see(lens_at(42, {}, false));
  show(1);
  EXPECT_EQ(kept().focus, 42);
  EXPECT_FALSE(kept().zoom);
}

TEST_F(Watch, ALensThatCannotBeReadIsToldOnceAndReadAgain) {
  begin_with_device();
  const Result<LensState> gone = make_error(ErrorCode::kIo, "It is gone.");
  EXPECT_EQ(only(see(gone)), "WARNING It is gone. The session goes on without it.");
  EXPECT_TRUE(see(gone).empty());
  show(4);
  EXPECT_TRUE(
      has(only(see(lens_at(30, 120))), "INFO The lens of the camera '/dev/video0' is read"));
  show(1);
  EXPECT_FALSE(kept().focus) << "the lens was not read when the first views were taken";
  session_.reset();
  show(4);
  EXPECT_EQ(kept().focus, 30);
}

TEST_F(Watch, ADriverThatDoesNotAnswerIsToldOnce) {
  begin_with_device();
  for (int i = 0; i < 4; ++i) session_.wait_for_lens();
  EXPECT_TRUE(told(session_).empty());
  for (int i = 0; i < 20; ++i) session_.wait_for_lens();
  EXPECT_TRUE(has(only(told(session_)), "'/dev/video0' has not told its focus for 5 s"));
  EXPECT_TRUE(has(only(see(lens_at(30, 120))), "is read again"));
}

// Nobody knows how the lens stood for them.
TEST_F(Watch, ViewsOfBeforeKeepNoPlace) {
  begin_with_device();
  (void)see(lens_at(30, 120));
  show(4);
  std::optional<Error> warning;
  ASSERT_TRUE(session_.set_size({320, 240}, warning));
  ASSERT_TRUE(session_.set_size(scenes::kSize, warning));
  session_.set_live(false);
  (void)told(session_);
  show(1);
  const LensState lens = kept();
  EXPECT_FALSE(lens.focus || lens.zoom);
  EXPECT_EQ(lens.device.node, "/dev/video0");
}

// ---- The stream ---------------------------------------------------------------------------------

TEST_F(Watch, SilenceIsToldOnceAndSoIsItsEnd) {
  begin();
  show(4);
  session_.frame_came();
  EXPECT_TRUE(seconds(5).empty());
  const std::string words = only(seconds(20));
  EXPECT_TRUE(has(words, "WARNING No frame has come for 5 s")) << words;
  EXPECT_TRUE(has(words, "4 views wait")) << words;
  session_.frame_came();
  EXPECT_EQ(only(seconds(1)), "INFO Frames come again, and the session goes on with 4 views.");
  EXPECT_TRUE(seconds(4).empty());
  EXPECT_TRUE(has(only(seconds(1)), "No frame has come"));
}

TEST_F(Watch, FramesNowAndThenAreNoSilence) {
  begin();
  for (int i = 0; i < 20; ++i) {
    session_.frame_came();
    EXPECT_TRUE(seconds(5).empty());
  }
}

// Paused, ended, flushed, or held up downstream.
TEST_F(Watch, WhereNoFrameIsExpectedThereIsNoSilence) {
  begin();
  EXPECT_TRUE(seconds(4).empty());
  EXPECT_TRUE(seconds(60, false).empty());
  EXPECT_TRUE(seconds(4).empty());
}

TEST_F(Watch, ACameraOfFewFramesIsGivenTimeForThree) {
  begin();
  session_.set_frame_duration(10'000'000'000);
  EXPECT_TRUE(seconds(29).empty());
  const std::string words = only(seconds(1));
  EXPECT_TRUE(has(words, "No frame has come for 30 s")) << words;
  EXPECT_FALSE(has(words, "view")) << words;
}

}  // namespace

}  // namespace calvin
