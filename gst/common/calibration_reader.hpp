// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Reads the properties `calibration` and `recheck` beside the streaming thread.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "common/calibration_setting.hpp"
#include "common/worker.hpp"

namespace calvin::gst {

// Streaming thread, or before it starts. A file on a network that does not answer holds nobody up
// but whoever frees this, for the thread that reads it has to be joined.
class CalibrationReader {
 public:
  using Clock = CalibrationSetting::Clock;
  using ReadResult = Result<CameraSetting>;

  CalibrationReader() : desk_(std::make_shared<Desk>()), worker_(std::make_unique<Worker>()) {}

  // See Worker::start().
  [[nodiscard]] Status start() { return worker_->start(); }
  // Returns at once.
  void stop() { worker_->stop(); }

  // See parse_camera_setting(). The next poll() reads it, changed or not.
  void set(const std::string& text);
  // Reads what has just been set, on this thread.
  [[nodiscard]] std::optional<ReadResult> read(Clock::time_point now) {
    return desk_->setting.poll(now);
  }
  // CalibrationSetting::poll(), without waiting: what tells its calibration by itself is read at
  // once, a file by the worker, whose result a later call returns.
  [[nodiscard]] std::optional<ReadResult> poll(Clock::time_point now);

 private:
  // One text, and where the worker leaves what it finds. While `busy` the setting is the worker's.
  struct Desk {
    CalibrationSetting setting;
    std::mutex lock;  // of what follows
    bool busy = false;
    bool begun = false;
    std::optional<ReadResult> read;
  };
  void ask(Clock::time_point now);
  // On the worker.
  static void look(Desk& desk, Clock::time_point now);
  // To the file that it hangs at. An error where there is no thread for another one.
  [[nodiscard]] Status leave_worker();

  std::string text_;
  std::shared_ptr<Desk> desk_;
  Clock::time_point asked_;
  std::unique_ptr<Worker> worker_;
  std::vector<std::unique_ptr<Worker>> hung_;  // at files that were named before
};

}  // namespace calvin::gst
