// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where the lens of a V4L2 camera stands, read beside the streaming thread.
#pragma once

#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "calvin/core/result.hpp"
#include "calvin/device/lens.hpp"
#include "common/worker.hpp"

namespace calvin::gst {

// Streaming thread, or before it starts. A driver that does not answer holds nobody up but whoever
// frees this, for the thread that waits for it has to be joined.
class LensFollower {
 public:
  using Clock = std::chrono::steady_clock;

  LensFollower() : desk_(std::make_shared<Desk>()) {}

  // Of the camera with this V4L2 node, which is asked at once; empty: nothing is read.
  [[nodiscard]] Status start(const std::string& node, Clock::time_point now);
  // Returns at once.
  void stop() { worker_.stop(); }

  // Takes in what was read and has the lens read again, ten times a second, without waiting. What
  // the user should hear of it is added to `errors`.
  void follow(Clock::time_point now, std::vector<Error>& errors);

  // As it was read last; absent: not yet.
  [[nodiscard]] const std::optional<LensState>& lens() const { return lens_; }
  // Whether nothing was read yet, and nobody knows either that nothing can be.
  [[nodiscard]] bool awaited() const { return !node_.empty() && !lens_ && !unreadable_; }

 private:
  // Where the worker leaves what it reads. One that hangs leaves it on the desk of its run.
  struct Desk {
    std::mutex lock;
    std::optional<Result<LensState>> read;
  };
  void take(Result<LensState> read, std::vector<Error>& errors);
  void ask(Clock::time_point now);

  std::string node_;
  std::shared_ptr<Desk> desk_;
  Clock::time_point asked_;
  bool asking_ = false;
  std::optional<LensState> lens_;
  bool unreadable_ = false;  // and that was told
  Worker worker_;
};

}  // namespace calvin::gst
