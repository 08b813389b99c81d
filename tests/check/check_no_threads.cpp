// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A system that gives no more threads, as in a container with a limit of processes: an element that
// needs one says so and does not start; the program goes on.

#include <dlfcn.h>
#include <pthread.h>

#include <atomic>
#include <cerrno>

#include "support.hpp"

#include <gst/check/gstcheck.h>

using namespace calvin;

static std::atomic<bool> refused;

// Stands before the C library's own.
extern "C" {
GST_EXPORT int pthread_create(pthread_t* thread, const pthread_attr_t* attributes,
                              void* (*run)(void*), void* data) {
  static auto* const kReal =
      reinterpret_cast<decltype(&pthread_create)>(dlsym(RTLD_NEXT, "pthread_create"));
  return refused ? EAGAIN : kReal(thread, attributes, run, data);
}
}

static const char* const kElements[] = {"calibdetect", "calibsolve", "calibundistort"};

GST_START_TEST(test_no_thread_is_an_error_and_not_the_end) {
  GstElement* element = gst_element_factory_make(kElements[__i__], nullptr);
  gst_object_ref_sink(element);
  {
    check::Bus bus(element);
    for (int round = 0; round < 2; ++round) {
      refused = true;
      const auto change = gst_element_set_state(element, GST_STATE_PAUSED);
      refused = false;
      fail_unless_equals_int(change, GST_STATE_CHANGE_FAILURE);
      fail_unless_equals_int(bus.texts(GST_MESSAGE_ERROR).size(), round + 1);
      fail_unless(bus.says(GST_MESSAGE_ERROR, "thread"));
      fail_unless_equals_int(gst_element_set_state(element, GST_STATE_NULL),
                             GST_STATE_CHANGE_SUCCESS);
    }
    // Once there are threads again, it works.
    fail_unless_equals_int(gst_element_set_state(element, GST_STATE_PAUSED),
                           GST_STATE_CHANGE_SUCCESS);
    gst_element_set_state(element, GST_STATE_NULL);
    bus.detach();
  }
  gst_object_unref(element);
}
GST_END_TEST;

static Suite* no_threads_suite() {
  Suite* suite = suite_create("no_threads");
  TCase* tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_loop_test(tc, test_no_thread_is_an_error_and_not_the_end, 0, G_N_ELEMENTS(kElements));
  return suite;
}

GST_CHECK_MAIN(no_threads)
