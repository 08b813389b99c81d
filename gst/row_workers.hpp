// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Threads that share one frame's work.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace calvin::gst {

// One thread calls it at a time.
class RowWorkers {
 public:
  RowWorkers() = default;
  ~RowWorkers() { resize(1); }
  RowWorkers(const RowWorkers&) = delete;
  RowWorkers& operator=(const RowWorkers&) = delete;

  // The caller's thread is one of them. Threads that the system refuses are done without.
  void resize(int threads);

  // Calls work(part, parts) for each part, and returns when all are done.
  void run(const std::function<void(int, int)>& work);

 private:
  // Does `part` of every run() after the one that `done` counts.
  void serve(const std::stop_token& stop, int part, int done);

  std::mutex lock_;
  std::condition_variable_any begin_;
  std::condition_variable end_;
  const std::function<void(int, int)>* work_ = nullptr;
  int turn_ = 0;  // counts run()
  int busy_ = 0;
  std::vector<std::jthread> threads_;
};

}  // namespace calvin::gst
