// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The property `calibration`: read once, and again whenever its file is replaced.

#include "common/calibration_setting.hpp"

#include <sys/stat.h>

#include <utility>

namespace calvin::gst {

constexpr auto kPause = std::chrono::milliseconds(500);

static std::int64_t nanoseconds(const timespec& time) {
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

void CalibrationSetting::set(const std::string& text) {
  text_ = text;
  changed_ = true;
  stamp_.reset();
  doubt_.reset();
}

bool CalibrationSetting::is_due(Clock::time_point now) const {
  return !text_.empty() && (changed_ || (is_path_ && now >= next_look_));
}

bool CalibrationSetting::may_wait() const {
  return changed_ ? may_be_calibration_path(text_) : is_path_;
}

std::optional<Result<CameraSetting>> CalibrationSetting::poll(Clock::time_point now) {
  if (!is_due(now)) return std::nullopt;
  next_look_ = now + kPause;
  if (!std::exchange(changed_, false)) return read_if_replaced();
  is_path_ = is_calibration_path(text_);
  // Before reading: a file that changes meanwhile is read once more.
  if (is_path_) stamp_ = look();
  return parse_camera_setting(text_);
}

std::optional<Result<CameraSetting>> CalibrationSetting::read_if_replaced() {
  const auto stamp = look();
  if (stamp == stamp_) {
    if (!doubt_) return std::nullopt;
    return tl::unexpected(*std::exchange(doubt_, std::nullopt));
  }
  stamp_ = stamp;
  doubt_.reset();
  auto read = parse_camera_setting(text_);
  if (read) return read;
  doubt_ = read.error();
  return std::nullopt;
}

std::optional<CalibrationSetting::Stamp> CalibrationSetting::look() const {
  struct stat s = {};
  if (stat(text_.c_str(), &s) != 0) return std::nullopt;
  return Stamp{s.st_dev, s.st_ino, s.st_size, nanoseconds(s.st_mtim), nanoseconds(s.st_ctim)};
}

}  // namespace calvin::gst
