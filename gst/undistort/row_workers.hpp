// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Threads that share one frame's work.
#pragma once

#include <functional>
#include <memory>

#include <sys/types.h>

namespace calvin::gst {

// One thread calls it at a time. A child that the process forks has none of the threads: there it
// is as if it had never been resized.
class RowWorkers {
 public:
  RowWorkers();
  ~RowWorkers();
  RowWorkers(const RowWorkers&) = delete;
  RowWorkers& operator=(const RowWorkers&) = delete;

  // The caller's thread is one of them. Threads that the system refuses are done without.
  void resize(int threads);

  // Calls work(part, parts) for each part, and returns when all are done.
  void run(const std::function<void(int, int)>& work);

 private:
  class Threads;
  // In a forked child new ones, and the parent's are left: they cannot be joined there.
  Threads& threads();

  std::unique_ptr<Threads> threads_;
  pid_t process_;  // that has them
};

}  // namespace calvin::gst
