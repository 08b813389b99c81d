// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Whether a guided session is needed at all: the calibration that is there already is judged by the
// first views.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "calvin/core/calibration.hpp"
#include "calvin/session/session_jobs.hpp"
#include "calvin/session/session_settings.hpp"
#include "calvin/solve/recheck.hpp"

namespace calvin {

// What the file of settings.location holds, or else `initial`; null where there is neither, or the
// file cannot be read. Waits for the disk.
[[nodiscard]] std::shared_ptr<const EarlierCalibration> find_earlier(
    const SessionSettings& settings, const std::optional<Calibration>& initial);

struct EarlierVerdict {
  RecheckReport report;  // of all views together
  bool holds = true;     // a change of less than 4 sigma is none: it is looked for in many places
  std::string words;     // a sentence or two for the user
};

// Takes as long as a few poses do. Absent where the job has none, where that is of another camera
// or another size than the views, and where the views do not tell enough yet.
[[nodiscard]] std::optional<EarlierVerdict> judge_earlier(const SolveJob& job);

// Whether the views of that job prove that its camera is not as `before` has it.
[[nodiscard]] bool contradict(const WriteJob& job, const Calibration& before);

}  // namespace calvin
