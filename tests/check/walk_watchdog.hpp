// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Ends a test that stands still, and tells where every thread stood.
#pragma once

#include <sys/prctl.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <string>
#include <thread>

#include <glib.h>

namespace calvin::check {

class Watchdog {
 public:
  explicit Watchdog(std::chrono::seconds patience)
      : patience_(patience), thread_([this] { watch(); }) {
    // gdb is a child of this process; some systems let a parent only look at its children.
    prctl(PR_SET_PTRACER, PR_SET_PTRACER_ANY);
    for (const int signal : {SIGTRAP, SIGSEGV}) std::signal(signal, on_signal);
  }
  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;
  ~Watchdog() {
    {
      const std::lock_guard guard(lock_);
      quit_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }

  // Each step has the whole patience.
  void step(std::string what) {
    const std::lock_guard guard(lock_);
    what_ = std::move(what);
    g_strlcpy(last_step_, what_.c_str(), sizeof last_step_);
    ++beats_;
    changed_.notify_all();
  }

 private:
  void watch() {
    std::unique_lock guard(lock_);
    while (!quit_) {
      const auto seen = beats_;
      const auto moved = [&] { return quit_ || beats_ != seen; };
      if (!changed_.wait_for(guard, patience_, moved)) give_up();
    }
  }
  void give_up() {
    g_printerr("\nno progress in %d s: %s\n", static_cast<int>(patience_.count()), what_.c_str());
    const std::string gdb =
        "gdb -p " + std::to_string(getpid()) + " -batch -ex 'thread apply all bt' >&2 2>/dev/null";
    if (std::system(gdb.c_str()) != 0) g_printerr("install gdb to see where the threads stand\n");
    std::abort();
  }

  // A fatal warning of GLib, or a crash: in which walk?
  static void on_signal(int signal) {
    for (const char* text : {"\nin ", static_cast<const char*>(last_step_), "\n"}) {
      const auto written = write(STDERR_FILENO, text, std::strlen(text));
      static_cast<void>(written);
    }
    std::signal(signal, SIG_DFL);
    std::raise(signal);
  }

  static inline char last_step_[4096];
  const std::chrono::seconds patience_;
  std::mutex lock_;
  std::condition_variable changed_;
  std::string what_;
  std::uint64_t beats_ = 0;
  bool quit_ = false;
  std::thread thread_;
};

}  // namespace calvin::check
