// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where a thread is held until the test lets it go on.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>

namespace calvin::check {

class Gate {
 public:
  void close() {
    const std::lock_guard guard(lock_);
    closed_ = true;
    arrived_ = 0;
  }
  void open() {
    const std::lock_guard guard(lock_);
    closed_ = false;
    changed_.notify_all();
  }
  // Returns when it is open. A test that nobody opens it for ends, and has failed.
  void pass() {
    std::unique_lock guard(lock_);
    ++arrived_;
    changed_.notify_all();
    if (!changed_.wait_for(guard, kPatience, [this] { return !closed_; })) forced_ = true;
  }
  // Whether so many have come since it was closed, waiting for them.
  [[nodiscard]] bool reached(int count = 1) {
    std::unique_lock guard(lock_);
    return changed_.wait_for(guard, kPatience, [&] { return arrived_ >= count; });
  }
  [[nodiscard]] bool forced() {
    const std::lock_guard guard(lock_);
    return forced_;
  }

 private:
  static constexpr std::chrono::seconds kPatience{20};
  std::mutex lock_;
  std::condition_variable changed_;
  bool closed_ = false;
  bool forced_ = false;
  int arrived_ = 0;
};

}  // namespace calvin::check
