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
//
// A job that cannot be interrupted at once holds nobody up: the thread then ends by itself after
// it, and is joined by the next start() or by join().
class Worker {
 public:
  using Job = std::function<void(std::stop_token)>;

  Worker() = default;
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;
  ~Worker();

  void start();

  // Whether a job that is offered now begins at once.
  [[nodiscard]] bool idle();

  // Runs the job after the one that runs now. A job that still waits is replaced: newest only.
  // False while cancelled or stopped.
  bool offer(Job job);

  // Waits until there is nothing left to do, and no job is left in memory; false when cancel()
  // came first.
  bool drain();

  // For a job, with its own token: calls `tell`, unless it was cancelled. After cancel() nothing is
  // told any more: those that listen may be gone, such as the bin that the element was in.
  bool deliver(const std::stop_token& stop, const std::function<void()>& tell);

  // Returns when what a job is telling now has been told.
  void settle() { const std::lock_guard guard(delivering_); }

  // Asks the running job to stop, forgets the waiting one, wakes drain() and refuses new jobs
  // until resume(). Returns at once, or when what a job is telling has been told.
  void cancel();
  void resume();

  // cancel(), and the thread ends soon. Returns at once.
  void stop();
  // stop(), and waits for the thread: for whoever owns what the jobs use, before that goes. At the
  // end of a program two threads may do so at once.
  void join();

 private:
  void run();

  std::mutex lock_;
  std::condition_variable changed_;
  std::recursive_mutex delivering_;  // whoever is told something may cancel
  std::mutex joining_;
  std::thread thread_;  // under joining_
  Job waiting_;
  std::stop_source running_;
  bool busy_ = false;
  bool cancelled_ = true;
  bool quit_ = false;
  bool alive_ = false;  // the thread has not left run() yet
};

}  // namespace calvin::gst
