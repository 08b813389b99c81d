// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Every thread waits for its turn, works on its part and counts itself out; the caller works on the
// first part.

#include "undistort/row_workers.hpp"

#include <unistd.h>

#include <condition_variable>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace calvin::gst {

class RowWorkers::Threads {
 public:
  void resize(int threads);
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

void RowWorkers::Threads::resize(int threads) {
  if (static_cast<int>(threads_.size()) == threads - 1) return;
  threads_.clear();  // each is told to stop, and joined
  // A thread that starts late must not miss a turn.
  const int turn = turn_;
  for (int part = 1; part < threads; ++part) {
    try {
      threads_.emplace_back(
          [this, part, turn](const std::stop_token& stop) { serve(stop, part, turn); });
    } catch (const std::system_error&) {
      return;
    }
  }
}

void RowWorkers::Threads::run(const std::function<void(int, int)>& work) {
  const int parts = static_cast<int>(threads_.size()) + 1;
  if (parts > 1) {
    const std::lock_guard guard(lock_);
    work_ = &work;
    busy_ = parts - 1;
    ++turn_;
    begin_.notify_all();
  }
  work(0, parts);
  std::unique_lock guard(lock_);
  end_.wait(guard, [this] { return busy_ == 0; });
}

void RowWorkers::Threads::serve(const std::stop_token& stop, int part, int done) {
  std::unique_lock guard(lock_);
  while (begin_.wait(guard, stop, [&] { return turn_ != done; })) {
    done = turn_;
    const auto& work = *work_;
    const int parts = static_cast<int>(threads_.size()) + 1;
    guard.unlock();
    work(part, parts);
    guard.lock();
    if (--busy_ == 0) end_.notify_one();
  }
}

RowWorkers::RowWorkers() : threads_(std::make_unique<Threads>()), process_(::getpid()) {}

RowWorkers::~RowWorkers() { threads().resize(1); }

RowWorkers::Threads& RowWorkers::threads() {
  if (const pid_t process = ::getpid(); process != process_) {
    static_cast<void>(threads_.release());
    threads_ = std::make_unique<Threads>();
    process_ = process;
  }
  return *threads_;
}

void RowWorkers::resize(int threads) { this->threads().resize(threads); }

void RowWorkers::run(const std::function<void(int, int)>& work) { threads().run(work); }

}  // namespace calvin::gst
