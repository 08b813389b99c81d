// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The property `calibration`: read once, and again whenever its file is replaced.

#include "calibration_setting.hpp"

#include <sys/stat.h>

#include "calvin/io/settings.hpp"

namespace calvin::gst {

void CalibrationSetting::set(const std::string& text) {
  text_ = text;
  changed_ = true;
  stamp_.reset();
}

std::optional<Result<Calibration>> CalibrationSetting::poll(Clock::time_point now) {
  if (text_.empty()) return std::nullopt;
  if (changed_) {
    changed_ = false;
    is_path_ = is_calibration_path(text_);
  } else if (!is_path_ || now < next_look_) {
    return std::nullopt;
  } else {
    const auto stamp = look();
    if (!stamp || stamp == stamp_) {
      next_look_ = now + std::chrono::milliseconds(500);
      return std::nullopt;
    }
  }
  next_look_ = now + std::chrono::milliseconds(500);
  // Before reading: a file that changes meanwhile is read once more.
  if (is_path_) stamp_ = look();
  return parse_calibration_setting(text_);
}

std::optional<CalibrationSetting::Stamp> CalibrationSetting::look() const {
  struct stat s = {};
  if (stat(text_.c_str(), &s) != 0) return std::nullopt;
  return Stamp{s.st_ino, s.st_size, s.st_mtim.tv_sec, s.st_mtim.tv_nsec};
}

}  // namespace calvin::gst
