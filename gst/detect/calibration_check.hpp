// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The property `recheck`: each board found is held against an existing calibration.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include <gst/gst.h>

#include "calvin/core/calibration.hpp"
#include "calvin/session/watch/calibration_watch.hpp"
#include "common/messages.hpp"

namespace calvin::gst {

// One thread at a time.
class CalibrationCheck {
 public:
  explicit CalibrationCheck(Calibration calibration) : calibration_(std::move(calibration)) {}

  // The message `calib-check` for a board that was found at that place of the frame's boards,
  // nullptr where it says nothing. What the user should hear beside it is added to `warnings`.
  [[nodiscard]] GstStructure* check(const View& view, int place, const FrameTimes& times,
                                    std::vector<Error>& warnings);

 private:
  // Makes the check for frames of that size; says once why there is none.
  void fit(ImageSize size, std::vector<Error>& warnings);

  Calibration calibration_;
  ImageSize size_;
  std::optional<CalibrationWatch> watch_;
};

}  // namespace calvin::gst
