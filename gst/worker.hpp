// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// One thread beside the streaming thread, with room for one job that waits.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <stop_token>
#include <thread>

namespace calvin::gst {

// All functions may be called from any thread; start() and stop() not against each other.
class Worker {
 public:
  using Job = std::function<void(std::stop_token)>;

  Worker() = default;
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;
  ~Worker() { stop(); }

  void start();

  // Runs the job after the one that runs now. A job that still waits is replaced: newest only.
  // False while cancelled or stopped.
  bool offer(Job job);

  // Waits until there is nothing left to do; false when cancel() came first.
  bool drain();

  // Asks the running job to stop, forgets the waiting one, wakes drain() and refuses new jobs
  // until resume(). Returns at once.
  void cancel();
  void resume();

  // cancel(), then joins the thread.
  void stop();

 private:
  void run();

  std::mutex lock_;
  std::condition_variable changed_;
  std::thread thread_;
  Job waiting_;
  std::stop_source running_;
  bool busy_ = false;
  bool cancelled_ = true;
  bool quit_ = false;
};

}  // namespace calvin::gst
