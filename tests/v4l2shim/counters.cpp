// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Tells what an emulated camera counted.

#include "counters.hpp"

#include <ctime>
#include <fstream>

#include "calvin/core/text.hpp"

namespace calvin::v4l2 {

void Counters::stop() {
  timespec spent{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &spent);
  cpu = static_cast<double>(spent.tv_sec) + static_cast<double>(spent.tv_nsec) * 1e-9;
}

void report(const Counters& counters, const Settings& settings) {
  if (settings.counters.empty()) return;
  std::ofstream(settings.counters, std::ios::app)
      << R"({"device":")" + settings.path + R"(","filled":)" + std::to_string(counters.filled) +
             R"(,"lost":)" + std::to_string(counters.lost) + R"(,"lost_on_request":)" +
             std::to_string(counters.lost_on_request) + R"(,"cpu":)" + format_double(counters.cpu) +
             "}\n";
}

}  // namespace calvin::v4l2
