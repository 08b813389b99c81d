// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// One thread beside the streaming thread.

#include "worker.hpp"

#include <pthread.h>

#include <chrono>
#include <set>
#include <system_error>
#include <utility>

namespace calvin::gst {

namespace {

// A program may end with elements that were never freed. Their threads must be gone before the
// libraries that the jobs use tear down what they keep.
class Everyone {
 public:
  // What is registered last goes first: call it when the libraries have made what they keep.
  static void stop_at_exit() { static const StopAtExit kAtExit; }

  static void add(Worker* worker) {
    Members& all = members();
    const std::lock_guard guard(all.lock);
    all.workers.insert(worker);
  }
  static void remove(Worker* worker) {
    Members& all = members();
    const std::lock_guard guard(all.lock);
    all.workers.erase(worker);
  }

 private:
  struct Members {
    std::mutex lock;
    std::set<Worker*> workers;
  };
  // Never freed: workers may go later than any static object. A child that the process forks has
  // none of its threads, and perhaps one of its locks for ever: it begins with no members.
  static Members& members() {
    static Members* all = [] {
      pthread_atfork(nullptr, nullptr, [] { all = new Members; });
      return new Members;
    }();
    return *all;
  }
  struct StopAtExit {
    ~StopAtExit() {
      Members& all = members();
      // Whoever frees one of them meanwhile waits in remove().
      const std::lock_guard guard(all.lock);
      for (Worker* worker : all.workers) worker->stop_at_exit();
    }
  };
};

}  // namespace

Status Worker::start() {
  stop();
  {
    const std::lock_guard guard(lock_);
    quit_ = false;
    cancelled_ = false;
    if (std::exchange(alive_, true)) return {};  // still at an old job, and good for new ones
  }
  try {
    const std::lock_guard guard(joining_);
    if (thread_.joinable()) thread_.join();
    thread_ = std::thread([this] { run(); });
  } catch (const std::system_error& error) {
    const std::lock_guard guard(lock_);
    alive_ = false;
    cancelled_ = quit_ = true;
    changed_.notify_all();
    return make_error(ErrorCode::kIo,
                      "The system does not give the element a thread of its own (" +
                          error.code().message() +
                          "): end other programs, or raise the limit of processes (ulimit -u, or "
                          "that of the container).");
  }
  Everyone::add(this);
  return {};
}

bool Worker::idle() {
  const std::lock_guard guard(lock_);
  return !busy_ && !waiting_;
}

bool Worker::offer(Job job) {
  const std::lock_guard guard(lock_);
  if (cancelled_) return false;
  waiting_ = std::move(job);
  changed_.notify_all();
  return true;
}

bool Worker::drain() {
  std::unique_lock guard(lock_);
  changed_.wait(guard, [this] { return cancelled_ || (!busy_ && !waiting_); });
  return !cancelled_;
}

std::unique_ptr<Worker::Telling> Worker::begin_telling(const std::stop_token& stop,
                                                       GstElement* element) {
  const std::lock_guard guard(lock_);
  if (stop.stop_requested()) return nullptr;
  telling_ = true;
  return std::unique_ptr<Telling>(new Telling(*this, element));
}

Worker::Telling::~Telling() {
  const std::lock_guard guard(worker_.lock_);
  worker_.telling_ = false;
  worker_.changed_.notify_all();
}

void Worker::cancel() {
  const std::lock_guard guard(lock_);
  cancelled_ = true;
  waiting_ = nullptr;
  running_.request_stop();
  changed_.notify_all();
}

void Worker::resume() {
  const std::lock_guard guard(lock_);
  cancelled_ = quit_;
}

void Worker::stop() {
  // Told in less, unless a handler waits; and a program that ends next finds nobody at work.
  constexpr std::chrono::milliseconds kMoment{200};
  cancel();
  std::unique_lock guard(lock_);
  quit_ = true;
  changed_.notify_all();
  changed_.wait_for(guard, kMoment, [this] { return !telling_ || on_own_thread(); });
}

Worker::~Worker() {
  Everyone::remove(this);
  join();
}

void Worker::join() {
  stop();
  const std::lock_guard guard(joining_);
  if (thread_.joinable()) thread_.join();
}

void Worker::stop_at_exit() {
  stop();
  {
    std::unique_lock guard(lock_);
    changed_.wait(guard, [this] { return !alive_ || telling_ || on_own_thread(); });
    if (alive_) return;
  }
  join();
}

void Worker::run() {
  std::unique_lock guard(lock_);
  runner_ = std::this_thread::get_id();
  for (;;) {
    changed_.wait(guard, [this] { return quit_ || waiting_; });
    if (quit_) break;
    Job job = std::exchange(waiting_, nullptr);
    running_ = std::stop_source();
    busy_ = true;
    guard.unlock();
    job(running_.get_token());
    job = nullptr;  // with all that it holds, before anybody is told
    Everyone::stop_at_exit();
    guard.lock();
    busy_ = false;
    changed_.notify_all();
  }
  alive_ = false;
  runner_ = {};
  changed_.notify_all();
}

}  // namespace calvin::gst
