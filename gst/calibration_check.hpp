// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The property `recheck`: each board found is held against an existing calibration.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gst/gst.h>

#include "calibration_setting.hpp"
#include "calvin/solve/recheck.hpp"
#include "messages.hpp"

namespace calvin::gst {

// One thread at a time.
class CalibrationCheck {
 public:
  // `text` as in parse_calibration_setting(); a file is read again when it is replaced.
  static Result<std::shared_ptr<CalibrationCheck>> make(const std::string& text);

  // The message `calib-check` for a board that was found, nullptr where it says nothing. What the
  // user should hear beside it is added to `news`.
  [[nodiscard]] GstStructure* check(const View& view, const FrameTimes& times,
                                    std::vector<Error>& news);

 private:
  void poll(std::vector<Error>& news);
  // Makes the check for frames of that size; says once why there is none.
  void fit(ImageSize size, std::vector<Error>& news);

  CalibrationSetting setting_;
  Calibration calibration_;
  ImageSize size_;
  std::optional<Recheck> recheck_;
};

}  // namespace calvin::gst
