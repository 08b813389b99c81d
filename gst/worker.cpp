// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// One thread beside the streaming thread.

#include "worker.hpp"

#include <set>
#include <utility>

namespace calvin::gst {

namespace {

// A program may end with elements that were never freed. Their threads must be gone before the
// libraries that the jobs use tear down what they keep.
class Everyone {
 public:
  // What is registered last goes first: call it when the libraries have made what they keep.
  static void join_at_exit() { static const JoinAtExit kAtExit; }

  static void add(Worker* worker) {
    const std::lock_guard guard(members().lock);
    members().workers.insert(worker);
  }
  static void remove(Worker* worker) {
    const std::lock_guard guard(members().lock);
    members().workers.erase(worker);
  }

 private:
  struct Members {
    std::mutex lock;
    std::set<Worker*> workers;
  };
  // Never freed: workers may go later than any static object.
  static Members& members() {
    static auto* const kMembers = new Members;
    return *kMembers;
  }
  struct JoinAtExit {
    ~JoinAtExit() {
      // Whoever frees one of them meanwhile waits in remove().
      const std::lock_guard guard(members().lock);
      for (Worker* worker : members().workers) worker->join();
    }
  };
};

}  // namespace

void Worker::start() {
  stop();
  {
    const std::lock_guard guard(lock_);
    quit_ = false;
    cancelled_ = false;
    if (std::exchange(alive_, true)) return;  // still at an old job, and good for new ones
  }
  {
    const std::lock_guard guard(joining_);
    if (thread_.joinable()) thread_.join();
    thread_ = std::thread([this] { run(); });
  }
  Everyone::add(this);
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

bool Worker::deliver(const std::stop_token& stop, const std::function<void()>& tell) {
  const std::lock_guard guard(delivering_);
  if (stop.stop_requested()) return false;
  tell();
  return true;
}

void Worker::cancel() {
  {
    const std::lock_guard guard(lock_);
    cancelled_ = true;
    waiting_ = nullptr;
    running_.request_stop();
    changed_.notify_all();
  }
  const std::lock_guard guard(delivering_);
}

void Worker::resume() {
  const std::lock_guard guard(lock_);
  cancelled_ = quit_;
}

void Worker::stop() {
  cancel();
  const std::lock_guard guard(lock_);
  quit_ = true;
  changed_.notify_all();
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

void Worker::run() {
  std::unique_lock guard(lock_);
  for (;;) {
    changed_.wait(guard, [this] { return quit_ || waiting_; });
    if (quit_) break;
    Job job = std::exchange(waiting_, nullptr);
    running_ = std::stop_source();
    busy_ = true;
    guard.unlock();
    job(running_.get_token());
    job = nullptr;  // with all that it holds, before anybody is told
    Everyone::join_at_exit();
    guard.lock();
    busy_ = false;
    changed_.notify_all();
  }
  alive_ = false;
}

}  // namespace calvin::gst
