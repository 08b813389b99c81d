// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a user sets a calibration session to, and what that means once it is read.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calvin/session/files/calibration_files.hpp"
#include "calvin/session/points/known_points.hpp"
#include "calvin/session/session.hpp"
#include "calvin/solve/solve.hpp"

namespace calvin {

// What a user chose: kDefault is kAll where the source is not live, kAuto where it is.
enum class CaptureChoice { kDefault, kAll, kAuto, kManual };

// What is estimated of the board: kWarp its two curvatures, kPoints every control point; kAuto
// takes the measured shape of a board that has one, and estimates the curvatures of another.
enum class BoardShapeChoice { kNone, kWarp, kPoints, kAuto };

// As set: texts are not read yet.
struct SessionSettings {
  std::string location;
  std::string exports;
  std::string journal;
  std::string device;  // V4L2 node of the camera; empty: its lens is not read
  std::string camera;  // empty: the name that the observations carry
  std::string model = "brown5";
  std::string method;  // SolveOptions::method
  std::string fix;
  std::string initial;
  std::string board;   // as the detector has it: a file of names may have its measured shape
  std::string points;  // of which clicks choose the pixels: a file of points or a board; or empty
  BoardShapeChoice board_shape = BoardShapeChoice::kAuto;
  bool warp = true;  // false: as kNone
  bool skew = false;
  CaptureChoice capture_mode = CaptureChoice::kDefault;
  int min_views = 3;
  int max_views = 0;               // 0: no limit
  double target_error = 0;         // px of expected error; 0: none
  int runs = 1;                    // of a final solve
  bool overwrite = false;          // what files hold of other sessions, though it is better
  std::uint64_t readout_time = 0;  // ns, from the first row of a frame to the last; 0: not known

  friend bool operator==(const SessionSettings&, const SessionSettings&) = default;
};

// What settings that work together mean.
struct SessionPlan {
  SessionSettings settings;
  SolveOptions options;  // without the names and sizes that only the frames tell
  std::optional<Calibration> initial;
  std::vector<CalibrationFile> files;
  std::optional<KnownPoints> points;  // that a user chooses in the picture

  [[nodiscard]] SessionOptions session_options(bool live) const;
};

// An error for settings that cannot work. Reads the files of `initial`, `board` and `points`.
[[nodiscard]] Result<SessionPlan> make_plan(const SessionSettings& settings);

// Settings that change while frames flow, from those `seen` last. What changed and cannot work goes
// on as it was in `before`, with an error for it, and so does what was refused when it was seen and
// still cannot work.
struct PlanChange {
  SessionPlan plan;
  std::vector<Error> refused;
};
[[nodiscard]] PlanChange change_plan(const SessionPlan& before, const SessionSettings& seen,
                                     const SessionSettings& now);

// Settings that were set, and those whose place they are to take.
struct SettingsUpdate {
  SessionSettings now;
  SessionSettings seen;
  SessionPlan plan;
  std::uint64_t serial = 0;  // of seen and plan
};
struct SettingsRead {
  PlanChange change;
  Status writable;  // of other files than before
};
// Looks at the disk for what may_wait() says.
[[nodiscard]] SettingsRead read_settings(const SettingsUpdate& update);

// Whether read_settings() may have to wait for the disk that a new `initial`, `board`, `points`,
// `location` or `export` is on.
[[nodiscard]] bool may_wait(const SessionSettings& seen, const SessionSettings& now);

// Whether the views are to be solved again, or the result is to be written again, when one set of
// settings takes the place of another.
[[nodiscard]] bool solves_differently(const SessionSettings& a, const SessionSettings& b);
[[nodiscard]] bool writes_elsewhere(const SessionSettings& a, const SessionSettings& b);
// Whether the files are others: only then is a disk asked whether they can be written.
[[nodiscard]] bool names_other_files(const SessionSettings& a, const SessionSettings& b);

// `initial` for frames of that size, with a word for the user where it had to be scaled or cannot
// be used.
struct FittedInitial {
  std::optional<Calibration> calibration;
  std::optional<Error> warning;
};
[[nodiscard]] FittedInitial fit_initial(const SessionPlan& plan, ImageSize frames);

}  // namespace calvin
