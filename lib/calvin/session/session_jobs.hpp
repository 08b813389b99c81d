// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a CalibrationSession asks others to do for it: to solve views, to write a result.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "calvin/core/calibration.hpp"
#include "calvin/device/lens.hpp"
#include "calvin/session/files/calibration_files.hpp"
#include "calvin/session/frame_times.hpp"
#include "calvin/session/guidance/view_guide.hpp"
#include "calvin/session/session.hpp"
#include "calvin/solve/solve.hpp"

namespace calvin {

// The state of a session that a job was made of. The session that has gone on since then knows by
// it what still counts.
struct JobOrigin {
  std::uint64_t session = 0;     // a reset begins a new one
  std::uint64_t generation = 0;  // so do a view that is removed, other options and other files
  std::uint64_t revision = 0;    // so does a new view
};

// A calibration that was there before the session, and what a user calls it at the beginning of a
// sentence.
struct EarlierCalibration {
  Calibration calibration;
  std::string name;
};

struct SolveJob {
  Session::Views views;
  ImageSize size;
  SolveOptions options;
  int runs = 1;
  bool final = false;
  std::optional<Board> next_board;  // to be guided to a view of; absent where nobody is guided
  ViewGuide::Views missed;          // views that were asked for and that nobody got to
  std::string location;             // what the result tells of itself: its native file, or empty
  FrameTimes times;                 // likewise, of the newest frame with a board
  std::optional<LensState> lens;    // likewise, what stood still of it for all views
  JobOrigin origin;
  std::shared_ptr<const EarlierCalibration> earlier;  // to be judged first, if any
};

struct WriteJob {
  Calibration calibration;
  std::vector<CalibrationFile> files;
  bool final = false;
  bool overwrite = false;  // SessionSettings::overwrite
  JobOrigin origin;
  std::uint64_t number = 0;  // of the writes of all sessions
  // By which a better calibration that a file holds is judged before a final result replaces it.
  Session::Views views;
  std::optional<ReadoutTime> readout;
};

// What a journal is to hold next: that the views before are forgotten, if so, and then these.
struct JournalEntry {
  bool reset = false;
  Session::Views views;
  std::string camera;  // as the user names it; empty: as each view does
};

// On any thread: takes as long as the solve does.
[[nodiscard]] Result<Solution> solve_job(const SolveJob& job, const std::stop_token& stop);

// Likewise: which view to ask for after that solution. Null where nobody is guided.
[[nodiscard]] std::shared_ptr<ViewGuide> guide_job(const SolveJob& job, const Solution& solution);

}  // namespace calvin
