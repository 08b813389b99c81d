// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// One thread beside the streaming thread.

#include "common/worker.hpp"

#include <pthread.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <set>
#include <system_error>
#include <utility>

namespace calvin::gst {

namespace {

// A program may end with elements that were never freed. Their threads must be gone before the
// libraries that the jobs use tear down what they keep.
class RunningWorkers {
 public:
  // How many forks this process is behind the first one.
  static unsigned process() {
    members();
    return generation;
  }
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
      pthread_atfork(nullptr, nullptr, [] {
        all = new Members;
        ++generation;
      });
      return new Members;
    }();
    return *all;
  }
  static inline std::atomic<unsigned> generation{0};
  struct StopAtExit {
    ~StopAtExit() {
      Members& all = members();
      // Whoever frees one of them meanwhile waits in remove().
      const std::lock_guard guard(all.lock);
      for (Worker* worker : all.workers) worker->stop_at_exit();
    }
  };
};

// Of the calling thread alone, as Linux has it. At ten steps a thread that is ready to run takes
// the core from this one at once, and where others want all cores a tenth of one is left to it.
void lower_priority() {
  constexpr int kSteps = 10;
  // What comes back may be -1 without an error, and a thread that is as low as it gets stays so.
  [[maybe_unused]] const int now = ::nice(kSteps);
}

}  // namespace

struct Worker::State {
  [[nodiscard]] bool on_own_thread() const { return runner == std::this_thread::get_id(); }

  const unsigned process = RunningWorkers::process();

  std::mutex joining;
  std::thread thread;  // under joining

  std::mutex lock;  // of everything below
  std::condition_variable changed;
  std::thread::id runner;
  Job waiting;
  std::stop_source running;
  bool busy = false;
  bool reporting = false;
  bool cancelled = true;
  bool gives_way = false;
  bool quit = false;
  bool alive = false;  // the thread has not left run() yet
};

Worker::Worker() : state_(new State) {}

Worker::State& Worker::state() {
  State* now = state_;
  if (now->process == RunningWorkers::process()) return *now;
  auto fresh = std::make_unique<State>();
  return state_.compare_exchange_strong(now, fresh.get()) ? *fresh.release() : *now;
}

Status Worker::start() {
  stop();
  State& s = state();
  {
    const std::lock_guard guard(s.lock);
    s.quit = false;
    s.cancelled = false;
    s.gives_way = false;
    if (std::exchange(s.alive, true)) return {};  // still at an old job, and good for new ones
  }
  try {
    const std::lock_guard guard(s.joining);
    if (s.thread.joinable()) s.thread.join();
    s.thread = std::thread([&s] { run(s); });
  } catch (const std::system_error& error) {
    const std::lock_guard guard(s.lock);
    s.alive = false;
    s.cancelled = s.quit = true;
    s.changed.notify_all();
    return make_error(ErrorCode::kIo,
                      "The system does not give the element a thread of its own (" +
                          error.code().message() +
                          "): end other programs, or raise the limit of processes (ulimit -u, or "
                          "that of the container).");
  }
  RunningWorkers::add(this);
  return {};
}

void Worker::give_way() {
  State& s = state();
  const std::lock_guard guard(s.lock);
  s.gives_way = true;
}

bool Worker::idle() {
  State& s = state();
  const std::lock_guard guard(s.lock);
  return !s.busy && !s.waiting;
}

bool Worker::offer(Job job) {
  State& s = state();
  const std::lock_guard guard(s.lock);
  if (s.cancelled) return false;
  s.waiting = std::move(job);
  s.changed.notify_all();
  return true;
}

bool Worker::drain() {
  State& s = state();
  std::unique_lock guard(s.lock);
  s.changed.wait(guard, [&s] { return s.cancelled || (!s.busy && !s.waiting); });
  return !s.cancelled;
}

bool Worker::drain_for(std::chrono::milliseconds most) {
  State& s = state();
  std::unique_lock guard(s.lock);
  const auto is_done = [&s] { return !s.busy && !s.waiting; };
  s.changed.wait_for(guard, most, [&] { return s.cancelled || is_done(); });
  return is_done();
}

std::unique_ptr<Worker::Report> Worker::begin_report(const std::stop_token& stop,
                                                     GstElement* element) {
  State& s = state();
  const std::lock_guard guard(s.lock);
  if (stop.stop_requested()) return nullptr;
  s.reporting = true;
  return std::unique_ptr<Report>(new Report(s, element));
}

Worker::Report::~Report() {
  const std::lock_guard guard(state_.lock);
  state_.reporting = false;
  state_.changed.notify_all();
}

void Worker::cancel() {
  State& s = state();
  const std::lock_guard guard(s.lock);
  s.cancelled = true;
  s.waiting = nullptr;
  s.running.request_stop();
  s.changed.notify_all();
}

void Worker::resume() {
  State& s = state();
  const std::lock_guard guard(s.lock);
  s.cancelled = s.quit;
}

void Worker::stop() {
  State& s = state();
  // A report takes less, unless a handler waits; and a program that ends next finds nobody at work.
  constexpr std::chrono::milliseconds kMoment{200};
  cancel();
  std::unique_lock guard(s.lock);
  s.quit = true;
  s.changed.notify_all();
  s.changed.wait_for(guard, kMoment, [&s] { return !s.reporting || s.on_own_thread(); });
}

Worker::~Worker() {
  RunningWorkers::remove(this);
  join();
  delete &state();
}

void Worker::join() {
  State& s = state();
  stop();
  const std::lock_guard guard(s.joining);
  if (s.thread.joinable()) s.thread.join();
}

void Worker::stop_at_exit() {
  State& s = state();
  stop();
  {
    std::unique_lock guard(s.lock);
    s.changed.wait(guard, [&s] { return !s.alive || s.reporting || s.on_own_thread(); });
    if (s.alive) return;
  }
  join();
}

void Worker::run(State& s) {
  std::unique_lock guard(s.lock);
  s.runner = std::this_thread::get_id();
  bool is_low = false;
  for (;;) {
    s.changed.wait(guard, [&s] { return s.quit || s.waiting; });
    if (s.quit) break;
    Job job = std::exchange(s.waiting, nullptr);
    s.running = std::stop_source();
    s.busy = true;
    const bool lowers = s.gives_way && !std::exchange(is_low, true);
    guard.unlock();
    if (lowers) lower_priority();
    job(s.running.get_token());
    job = nullptr;  // with all that it holds, before anybody is woken
    RunningWorkers::stop_at_exit();
    guard.lock();
    s.busy = false;
    s.changed.notify_all();
  }
  s.alive = false;
  s.runner = {};
  s.changed.notify_all();
}

}  // namespace calvin::gst
