// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What the journal of one camera holds of a light, for the solve of several.
#include <memory>
#include <utility>

#include <gtest/gtest.h>

#include "calvin/io/observations.hpp"
#include "calvin/session/journal.hpp"
#include "session_fixture.hpp"
#include "temporary_folder.hpp"

namespace calvin {
namespace {

class JournalsOfALight : public CalibrationSessions {
 protected:
  JournalsOfALight() {
    settings_.board = "dot";
    settings_.journal = folder_.path("light.jsonl");
    settings_.capture_mode = CaptureChoice::kAll;
  }

  void run() {
    journal_.reset();
    auto opened = Journal::open(settings_);
    ASSERT_TRUE(opened) << opened.error().message;
    journal_ = *std::move(opened);
    Journal::Content content = journal_->take_content();
    EXPECT_TRUE(content.views.empty());
    EXPECT_EQ(content.unusable, 0U);
    session_.start(make_plan(settings_).value(), true);
    session_.begin_journal(std::move(content.views), content.newest_light);
    std::optional<Error> warning;
    EXPECT_TRUE(session_.set_size(scenes::kSize, warning));
  }

  TemporaryFolder folder_;
  std::unique_ptr<Journal> journal_;
};

// A light in it is none of the session's views, and stays in it; one of an earlier time, as of
// another run, begins it anew.
TEST_F(JournalsOfALight, AreOfOneRun) {
  Observation light = seen(0);
  light.board = "dot";
  light.ids = {0};
  light.uv.resize(1);
  light.sigma.resize(1);
  const auto show_light = [&](int n) {
    light.timestamp = times(n).timestamp;
    (void)session_.offer(light, times(n));
    for (JournalEntry& entry : session_.take_journal()) journal_->add(std::move(entry));
    ASSERT_TRUE(journal_->write());
  };
  const auto held = [&] { return read_observations(settings_.journal).value().observations; };
  run();
  for (int n = 0; n < 5; ++n) show_light(n);
  EXPECT_EQ(held().size(), 5U);
  run();
  EXPECT_TRUE(session_.views().views().empty());
  for (int n = 5; n < 8; ++n) show_light(n);
  EXPECT_EQ(held().size(), 8U);
  run();
  for (int n = 2; n < 4; ++n) show_light(n);
  ASSERT_EQ(held().size(), 2U);
  EXPECT_EQ(held()[0].timestamp, times(2).timestamp);
}

}  // namespace
}  // namespace calvin
