// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What an emulated camera counts while it streams, for benchmarks and tests.
#pragma once

#include <cstdint>

#include "settings.hpp"

namespace calvin::v4l2 {

struct Counters {
  std::uint64_t filled = 0;           // frames
  std::uint64_t lost = 0;             // for which no buffer waited
  std::uint64_t lost_on_request = 0;  // by CALVIN_V4L2_LOSE
  double cpu = 0;                     // s, of the thread that fills the buffers

  // At the end of that thread, by itself.
  void stop();
};

// Appends a line to the file of CALVIN_V4L2_COUNTERS, if there is one:
//   {"device":"/dev/video0","filled":600,"lost":0,"lost_on_request":0,"cpu":0.21}
void report(const Counters& counters, const Settings& settings);

}  // namespace calvin::v4l2
