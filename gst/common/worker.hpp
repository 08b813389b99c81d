// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// One thread beside the streaming thread, with room for one job that waits.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <stop_token>
#include <thread>

#include <gst/gst.h>

#include "calvin/core/result.hpp"
#include "common/messages.hpp"

namespace calvin::gst {

// All functions may be called from any thread; start() and stop() not against each other.
//
// A job that cannot be interrupted at once holds nobody up: the thread then ends by itself after
// it, and is joined by the next start() or by join(). A child that the process forks has no such
// thread: there a worker is as if it had never been started.
class Worker {
  struct State;

 public:
  using Job = std::function<void(std::stop_token)>;

  // To be held by a job while it posts one message or notifies of one property. No lock of ours is
  // held meanwhile: a handler of the report may wait for another thread, and that one for us.
  class Report {
   public:
    Report(const Report&) = delete;
    Report& operator=(const Report&) = delete;
    ~Report();

   private:
    friend class Worker;
    Report(State& state, GstElement* element) : state_(state), posting_(element) {}

    State& state_;
    Posting posting_;
  };

  Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;
  ~Worker();

  // An error where the system has no thread for it; then no job is taken.
  [[nodiscard]] Status start();

  // For a live stream: from the next job on the thread takes no core from a streaming thread that
  // wants one. Until the next start(): but a priority is raised again by nobody without rights, and
  // a thread that is still at an old job by then stays low.
  void give_way();

  // Whether a job that is offered now begins at once.
  [[nodiscard]] bool idle();

  // Runs the job after the one that runs now. A job that still waits is replaced: newest only.
  // False while cancelled or stopped.
  bool offer(Job job);

  // Waits until there is nothing left to do, and no job is left in memory; false when cancel()
  // came first.
  bool drain();
  // Likewise, but no longer than that: whether there is nothing left to do.
  bool drain_for(std::chrono::milliseconds most);

  // For a job, with its own token: may it report something in the name of the element? nullptr once
  // it was cancelled. A report that has begun by then is made to its end.
  [[nodiscard]] std::unique_ptr<Report> begin_report(const std::stop_token& stop,
                                                     GstElement* element);

  // Asks the running job to stop, forgets the waiting one, wakes drain() and refuses new jobs
  // until resume(). Returns at once.
  void cancel();
  void resume();

  // cancel(), and the thread ends soon. Returns at once, or when the report that a job makes is
  // made, but never waits longer than a moment: its handler may wait for whoever stops. An element
  // does so in its dispose(): afterwards no job begins a report, and none takes a reference of it.
  void stop();
  // stop(), and waits for the thread: for whoever owns what the jobs use, before that goes.
  void join();
  // join() for the end of a program, but does not wait for what a job is reporting: that may be
  // what ends the program, or wait for a lock of the thread that does.
  void stop_at_exit();

 private:
  // In a forked child a new one, and the parent's is left: what its thread waits at cannot be
  // destroyed there.
  [[nodiscard]] State& state();
  static void run(State& s);

  std::atomic<State*> state_;
};

}  // namespace calvin::gst
