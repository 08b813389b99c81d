// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a calibration session of one camera makes of a light that is seen.
#include <vector>

#include "session_fixture.hpp"

namespace calvin {
namespace {

// One point tells nothing of one camera, however often it is seen.
TEST_F(CalibrationSessions, SayWhatALightIsFor) {
  begin();
  Observation light = seen(0);
  light.board = "dot";
  light.ids = {0};
  light.uv.resize(1);
  light.sigma.resize(1);
  const Offered first = session_.offer(light, times(0));
  ASSERT_TRUE(first.complaint.has_value());
  EXPECT_NE(first.complaint->message.find("several cameras together"), std::string::npos);
  EXPECT_FALSE(session_.offer(light, times(1)).complaint.has_value()) << "once is enough";
  EXPECT_EQ(session_.verdict().status.error().message, first.complaint->message);
  const View view = {light, parse_board("dot").value()};
  const auto solved = calvin::solve(std::vector<View>(9, view), scenes::kSize, SolveOptions());
  ASSERT_FALSE(solved.has_value());
  EXPECT_EQ(solved.error().message, first.complaint->message);
  EXPECT_TRUE(show(3).report);
  EXPECT_TRUE(session_.take_solve().has_value()) << "a board beside it is";
}

// With a journal they are recorded for the solve of several cameras: each frame once.
TEST_F(CalibrationSessions, WriteDownWhereALightWasSeen) {
  begin();
  session_.begin_journal({});
  Observation light = seen(0);
  light.board = "dot";
  light.ids = {0};
  light.uv.resize(1);
  light.sigma.resize(1);
  for (int n = 0; n < 3; ++n) {
    light.timestamp = times(n).timestamp;
    EXPECT_FALSE(session_.offer(light, times(n)).complaint.has_value());
    EXPECT_FALSE(session_.offer(light, times(n)).complaint.has_value());
  }
  const auto entries = session_.take_journal();
  ASSERT_EQ(entries.size(), 3U);
  for (int n = 0; n < 3; ++n) {
    const JournalEntry& entry = entries[static_cast<std::size_t>(n)];
    ASSERT_EQ(entry.views.size(), 1U);
    EXPECT_FALSE(entry.reset);
    EXPECT_EQ(entry.views[0]->observation.timestamp, times(n).timestamp);
    EXPECT_EQ(entry.views[0]->observation.uv[0].u, light.uv[0].u);
  }
  const std::string why = session_.verdict().status.error().message;
  EXPECT_NE(why.find("is in the journal"), std::string::npos) << why;
}

}  // namespace
}  // namespace calvin
