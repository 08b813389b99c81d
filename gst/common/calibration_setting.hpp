// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The property `calibration`: read once, and again whenever its file is replaced.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "calvin/io/settings.hpp"

namespace calvin::gst {

// One thread at a time.
class CalibrationSetting {
 public:
  using Clock = std::chrono::steady_clock;

  // See parse_camera_setting(). The next poll() reads it, changed or not.
  void set(const std::string& text);
  [[nodiscard]] bool empty() const { return text_.empty(); }

  // What is new: the calibration, or why it cannot be read (kNotFound: the file is not there, or
  // not any more). Absent where nothing has changed. Looks at the file at most twice a second. A
  // file that changes and cannot be read, or is gone, has another look before that is said: it may
  // be half written, or about to be replaced.
  [[nodiscard]] std::optional<Result<CameraSetting>> poll(Clock::time_point now);
  // Whether poll() would take a look now, and whether that may wait for a disk or a network.
  [[nodiscard]] bool is_due(Clock::time_point now) const;
  [[nodiscard]] bool may_wait() const;

 private:
  // What tells one file from the next under the same name. Programs that copy a file set its time
  // of modification to that of the other; its time of change they cannot set.
  struct Stamp {
    std::uint64_t device = 0;
    std::uint64_t inode = 0;
    std::int64_t size = 0;
    std::int64_t modified = 0;  // ns
    std::int64_t changed = 0;   // ns
    friend bool operator==(const Stamp&, const Stamp&) = default;
  };
  [[nodiscard]] std::optional<Stamp> look() const;
  [[nodiscard]] std::optional<Result<CameraSetting>> read_if_replaced();

  std::string text_;
  bool changed_ = false;
  bool is_path_ = false;
  std::optional<Stamp> stamp_;
  std::optional<Error> doubt_;  // why the file of `stamp_` cannot be read, not said yet
  Clock::time_point next_look_;
};

}  // namespace calvin::gst
