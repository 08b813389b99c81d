// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The worker: newest job only, a drain that waits, a cancel that does not.

#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <memory>
#include <thread>

#include "common/worker.hpp"
#include "gate.hpp"

#include <gst/check/gstcheck.h>

using calvin::gst::Worker;
namespace check = calvin::check;

// Waits for the stop request, at the most ten seconds.
static void busy_until_stopped(std::stop_token stop) {
  for (int i = 0; i < 10000 && !stop.stop_requested(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

// One that waits for its thread yet, and one that has begun.
GST_START_TEST(test_drain_waits_for_the_job) {
  Worker worker;
  fail_unless(worker.start().has_value());
  std::atomic<bool> begun = false;
  std::atomic<bool> done = false;
  fail_unless(worker.offer([&](std::stop_token) {
    begun = true;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    done = true;
  }));
  while (__i__ == 1 && !begun) std::this_thread::yield();
  fail_unless(worker.drain());
  fail_unless(done);
}
GST_END_TEST;

GST_START_TEST(test_only_the_newest_waiting_job_runs) {
  Worker worker;
  fail_unless(worker.start().has_value());
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
  fail_unless(worker.start().has_value());
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
    fail_unless(worker.start().has_value());
    worker.offer([&](std::stop_token) {
      begun = true;
      while (!go) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      ++ended;
    });
    while (!begun) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    worker.stop();
    fail_unless_equals_int(ended, 0);
    fail_unless(worker.start().has_value());
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
  fail_unless(worker.start().has_value());
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
    fail_unless(worker.start().has_value());
    worker.offer(busy_until_stopped);
    worker.stop();
    fail_if(worker.offer([](std::stop_token) {}));
  }
}
GST_END_TEST;

// In whose name reports are made.
struct Element {
  Element() : element(GST_ELEMENT(gst_object_ref_sink(gst_bin_new(nullptr)))) {}
  Element(const Element&) = delete;
  Element& operator=(const Element&) = delete;
  ~Element() { gst_object_unref(element); }
  GstElement* element;
};

GST_START_TEST(test_no_report_begins_after_cancel) {
  for (int i = 0; i < 200; ++i) {
    Element e;
    Worker worker;
    fail_unless(worker.start().has_value());
    std::atomic<bool> cancelled = false;
    std::atomic<bool> begun = false;
    std::atomic<bool> late = false;
    worker.offer([&](std::stop_token stop) {
      for (;;) {
        const bool before = cancelled;
        const auto report = worker.begin_report(stop, e.element);
        begun = true;
        if (!report) return;
        late = late || before;
      }
    });
    while (!begun) std::this_thread::yield();
    worker.cancel();
    cancelled = true;
    worker.join();
    fail_if(late);
  }
}
GST_END_TEST;

// A handler of a report may wait for whoever cancels.
GST_START_TEST(test_nobody_waits_for_a_report) {
  Element e;
  check::Gate gate;
  Worker worker;
  fail_unless(worker.start().has_value());
  gate.close();
  worker.offer([&](std::stop_token stop) {
    const auto report = worker.begin_report(stop, e.element);
    gate.pass();
  });
  fail_unless(gate.reached());
  worker.cancel();
  worker.resume();
  fail_unless(worker.offer([](std::stop_token) {}));
  worker.stop();
  fail_unless(worker.start().has_value());
  worker.stop_at_exit();
  gate.open();
  worker.join();
  fail_if(gate.forced());
}
GST_END_TEST;

// A bin's bus passes the messages on of what is in it, and is gone with the bin.
GST_START_TEST(test_bins_stay_during_a_report_in_them) {
  static std::atomic<int> gone;
  gone = 0;
  auto* outer = GST_BIN(gst_object_ref_sink(gst_bin_new(nullptr)));
  GstElement* inner = gst_bin_new(nullptr);
  GstElement* element = gst_bin_new(nullptr);
  gst_bin_add(outer, inner);
  gst_bin_add(GST_BIN(inner), element);
  for (gpointer object : {gpointer(outer), gpointer(inner), gpointer(element)}) {
    g_object_weak_ref(
        G_OBJECT(object), [](gpointer, GObject*) { ++gone; }, nullptr);
  }
  check::Gate gate;
  Worker worker;
  fail_unless(worker.start().has_value());
  gate.close();
  worker.offer([&](std::stop_token stop) {
    const auto report = worker.begin_report(stop, element);
    gate.pass();
  });
  fail_unless(gate.reached());
  gst_object_unref(outer);
  fail_unless_equals_int(gone, 0);
  gate.open();
  worker.join();
  for (int i = 0; i < 1000 && gone < 3; ++i) g_usleep(10000);
  fail_unless_equals_int(gone, 3);
}
GST_END_TEST;

// At the end of a program, which a job itself may bring about.
GST_START_TEST(test_at_exit_a_worker_does_not_wait_for_itself) {
  Worker worker;
  fail_unless(worker.start().has_value());
  worker.offer([&](std::stop_token) { worker.stop_at_exit(); });
  fail_if(worker.drain());
  worker.join();
}
GST_END_TEST;

// Once, not ten steps with each job; and what is started again has the priority of its program.
GST_START_TEST(test_what_gives_way_does_so_until_it_is_started_again) {
  Worker worker;
  const auto priority_of_a_job = [&worker] {
    int now = 0;
    worker.offer([&now](std::stop_token) { now = getpriority(PRIO_PROCESS, 0); });
    fail_unless(worker.drain());
    return now;
  };
  const int own = getpriority(PRIO_PROCESS, 0);
  fail_unless(worker.start().has_value());
  fail_unless_equals_int(priority_of_a_job(), own);
  worker.give_way();
  const int low = std::min(own + 10, 19);
  for (int i = 0; i < 2; ++i) fail_unless_equals_int(priority_of_a_job(), low);
  worker.join();
  fail_unless(worker.start().has_value());
  fail_unless_equals_int(priority_of_a_job(), own);
  fail_unless_equals_int(getpriority(PRIO_PROCESS, 0), own);
}
GST_END_TEST;

GST_START_TEST(test_two_threads_may_join) {
  for (int i = 0; i < 200; ++i) {
    Worker worker;
    fail_unless(worker.start().has_value());
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
  tcase_add_loop_test(tc, test_drain_waits_for_the_job, 0, 2);
  tcase_add_test(tc, test_only_the_newest_waiting_job_runs);
  tcase_add_test(tc, test_cancel_wakes_a_drain_and_refuses_jobs);
  tcase_add_test(tc, test_stop_does_not_wait_for_a_stubborn_job);
  tcase_add_test(tc, test_drain_leaves_no_job_in_memory);
  tcase_add_test(tc, test_start_works_again_after_stop);
  suite_add_tcase(suite, tc);
  tcase_add_test(tc, test_no_report_begins_after_cancel);
  tcase_add_test(tc, test_nobody_waits_for_a_report);
  tcase_add_test(tc, test_bins_stay_during_a_report_in_them);
  tcase_add_test(tc, test_at_exit_a_worker_does_not_wait_for_itself);
  tcase_add_test(tc, test_what_gives_way_does_so_until_it_is_started_again);
  tcase_add_test(tc, test_two_threads_may_join);
  return suite;
}

GST_CHECK_MAIN(worker)
