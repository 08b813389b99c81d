// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The worker: newest job only, a drain that waits, a cancel that does not.

#include <atomic>
#include <chrono>
#include <memory>
#include <thread>

#include <gst/check/gstcheck.h>

#include "worker.hpp"

using calvin::gst::Worker;

// Waits for the stop request, at the most ten seconds.
static void busy_until_stopped(std::stop_token stop) {
  for (int i = 0; i < 10000 && !stop.stop_requested(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

GST_START_TEST(test_drain_waits_for_the_job) {
  Worker worker;
  worker.start();
  std::atomic<bool> done = false;
  fail_unless(worker.offer([&](std::stop_token) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    done = true;
  }));
  fail_unless(worker.drain());
  fail_unless(done);
}
GST_END_TEST;

GST_START_TEST(test_only_the_newest_waiting_job_runs) {
  Worker worker;
  worker.start();
  std::atomic<bool> go = false;
  std::atomic<bool> begun = false;
  std::atomic<int> ran = 0;
  worker.offer([&](std::stop_token) {
    begun = true;
    while (!go) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  });
  while (!begun) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  for (int i = 1; i <= 5; ++i) worker.offer([&ran, i](std::stop_token) { ran = 10 * ran + i; });
  go = true;
  fail_unless(worker.drain());
  fail_unless_equals_int(ran, 5);
}
GST_END_TEST;

GST_START_TEST(test_cancel_wakes_a_drain_and_refuses_jobs) {
  Worker worker;
  worker.start();
  worker.offer(busy_until_stopped);
  std::thread canceller([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    worker.cancel();
  });
  fail_if(worker.drain());
  canceller.join();
  fail_if(worker.offer([](std::stop_token) {}));
  worker.resume();
  fail_unless(worker.offer([](std::stop_token) {}));
  fail_unless(worker.drain());
}
GST_END_TEST;

// A job that does not look at its stop token: the old thread goes on with it and then serves the
// new jobs, and join() waits for it.
GST_START_TEST(test_stop_does_not_wait_for_a_stubborn_job) {
  std::atomic<bool> go = false;
  std::atomic<bool> begun = false;
  std::atomic<int> ended = 0;
  std::atomic<int> ran = 0;
  {
    Worker worker;
    worker.start();
    worker.offer([&](std::stop_token) {
      begun = true;
      while (!go) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      ++ended;
    });
    while (!begun) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    worker.stop();
    fail_unless_equals_int(ended, 0);
    worker.start();
    fail_if(worker.idle());
    worker.offer([&](std::stop_token stop) { ran += stop.stop_requested() ? 100 : 1; });
    fail_unless_equals_int(ran, 0);
    go = true;
    fail_unless(worker.drain());
    fail_unless_equals_int(ran, 1);
    fail_unless(worker.idle());

    go = begun = false;
    worker.offer([&](std::stop_token) {
      begun = true;
      while (!go) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      ++ended;
    });
    while (!begun) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    worker.stop();
    go = true;
  }
  fail_unless_equals_int(ended, 2);
}
GST_END_TEST;

// What a job holds is gone when drain() returns: a frame, say, must be writable again.
GST_START_TEST(test_drain_leaves_no_job_in_memory) {
  Worker worker;
  worker.start();
  for (int i = 0; i < 200; ++i) {
    auto held = std::make_shared<int>(i);
    worker.offer([held](std::stop_token) {});
    fail_unless(worker.drain());
    fail_unless_equals_int(held.use_count(), 1);
  }
}
GST_END_TEST;

GST_START_TEST(test_start_works_again_after_stop) {
  Worker worker;
  for (int i = 0; i < 20; ++i) {
    worker.start();
    worker.offer(busy_until_stopped);
    worker.stop();
    fail_if(worker.offer([](std::stop_token) {}));
  }
}
GST_END_TEST;

GST_START_TEST(test_nothing_is_told_after_cancel) {
  for (int i = 0; i < 200; ++i) {
    Worker worker;
    worker.start();
    std::atomic<bool> listening = true;
    std::atomic<bool> begun = false;
    worker.offer([&](std::stop_token stop) {
      do {
        begun = true;
      } while (worker.deliver(stop, [&] { fail_unless(listening); }));
    });
    while (!begun) std::this_thread::yield();
    worker.cancel();
    listening = false;
    worker.join();
  }
}
GST_END_TEST;

GST_START_TEST(test_two_threads_may_join) {
  for (int i = 0; i < 200; ++i) {
    Worker worker;
    worker.start();
    worker.offer([](std::stop_token) {});
    std::thread other([&] { worker.join(); });
    worker.join();
    other.join();
  }
}
GST_END_TEST;

static Suite* worker_suite() {
  Suite* suite = suite_create("worker");
  TCase* tc = tcase_create("general");
  tcase_add_test(tc, test_drain_waits_for_the_job);
  tcase_add_test(tc, test_only_the_newest_waiting_job_runs);
  tcase_add_test(tc, test_cancel_wakes_a_drain_and_refuses_jobs);
  tcase_add_test(tc, test_stop_does_not_wait_for_a_stubborn_job);
  tcase_add_test(tc, test_drain_leaves_no_job_in_memory);
  tcase_add_test(tc, test_start_works_again_after_stop);
  suite_add_tcase(suite, tc);
  tcase_add_test(tc, test_nothing_is_told_after_cancel);
  tcase_add_test(tc, test_two_threads_may_join);
  return suite;
}

GST_CHECK_MAIN(worker)
