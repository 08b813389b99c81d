// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What events from downstream ask of calibsolve, alone and in calibrate.

#include "solve_fixture.hpp"

#include <gst/check/gstcheck.h>
#include <gst/video/navigation.h>

using namespace calvin;
using check::SolveFixture;

static GstEvent* custom(const char* name, int index = -1,
                        GstEventType type = GST_EVENT_CUSTOM_UPSTREAM) {
  GstStructure* s = gst_structure_new_empty(name);
  if (index >= 0) gst_structure_set(s, "index", G_TYPE_UINT, index, nullptr);
  return gst_event_new_custom(type, s);
}
// As sinks make them.
static GstEvent* key(const char* name, const char* event = "key-press") {
  return gst_event_new_navigation(gst_structure_new("application/x-gst-navigation", "event",
                                                    G_TYPE_STRING, event, "key", G_TYPE_STRING,
                                                    name, nullptr));
}
static GstEvent* click(int button) {
  return gst_event_new_navigation(gst_structure_new("application/x-gst-navigation", "event",
                                                    G_TYPE_STRING, "mouse-button-press", "button",
                                                    G_TYPE_INT, button, "pointer_x", G_TYPE_DOUBLE,
                                                    3.0, "pointer_y", G_TYPE_DOUBLE, 4.0, nullptr));
}

static int views(SolveFixture& f) {
  g_autoptr(GstStructure) stats = nullptr;
  g_object_get(f.element, "stats", &stats, nullptr);
  int count = -1;
  gst_structure_get_int(stats, "views", &count);
  return count;
}
// Whether an event from downstream reaches what is upstream of the element.
static bool passes(SolveFixture& f, GstEvent* event) {
  const GstEventType type = GST_EVENT_TYPE(event);
  fail_unless(gst_harness_push_upstream_event(f.h, event));
  bool found = false;
  while (GstEvent* seen = gst_harness_try_pull_upstream_event(f.h)) {
    found |= GST_EVENT_TYPE(seen) == type;
    gst_event_unref(seen);
  }
  return found;
}

GST_START_TEST(test_custom_events_are_the_signals) {
  SolveFixture f("", {}, "capture-mode=manual ");
  gst_buffer_unref(f.push(0));
  fail_unless_equals_int(views(f), 0);
  for (int n = 1; n <= 5; ++n) {
    const GstEventType type = n == 1   ? GST_EVENT_CUSTOM_BOTH
                              : n == 2 ? GST_EVENT_CUSTOM_BOTH_OOB
                                       : GST_EVENT_CUSTOM_UPSTREAM;
    fail_if(passes(f, custom("calvin-capture-view", -1, type)), "the event is obeyed and ends");
    gst_buffer_unref(f.push(n));
    gst_buffer_unref(f.push(n + 100));
    fail_unless_equals_int(views(f), n);
  }
  fail_if(passes(f, custom("calvin-solve")));
  for (int i = 0; i < 1000 && f.result("final") == nullptr; ++i) g_usleep(10000);
  fail_unless(f.result("final") != nullptr);
  fail_if(passes(f, custom("calvin-remove-view", 1)));
  fail_unless_equals_int(views(f), 4);
  fail_if(f.bus.says(GST_MESSAGE_WARNING, "calvin-remove-view"));
  fail_if(passes(f, custom("calvin-remove-view", 4)));
  fail_unless_equals_int(views(f), 4);
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "names no view that there is"));
  GstStructure* odd = gst_structure_new("calvin-remove-view", "index", G_TYPE_STRING, "1", nullptr);
  fail_if(passes(f, gst_event_new_custom(GST_EVENT_CUSTOM_UPSTREAM, odd)));
  odd = gst_structure_new("calvin-remove-view", "index", G_TYPE_INT, -1, nullptr);
  fail_if(passes(f, gst_event_new_custom(GST_EVENT_CUSTOM_UPSTREAM, odd)));
  fail_unless_equals_int(views(f), 4);
  fail_if(passes(f, custom("calvin-remove-view")));
  fail_unless_equals_int(views(f), 3);
  fail_if(passes(f, custom("calvin-reset")));
  fail_unless_equals_int(views(f), 0);
  fail_if(passes(f, custom("calvin-remove-view")));
  fail_unless_equals_int(views(f), 0);
  fail_unless(passes(f, custom("calvin-of-tomorrow")), "others go on");
}
GST_END_TEST;

GST_START_TEST(test_keys_and_clicks_are_obeyed_and_go_on) {
  SolveFixture f("", {}, "capture-mode=manual ");
  fail_unless(passes(f, key("space")));
  gst_buffer_unref(f.push(1));
  fail_unless_equals_int(views(f), 1);
  fail_unless(passes(f, click(1)));
  gst_buffer_unref(f.push(2));
  fail_unless_equals_int(views(f), 2);
  for (GstEvent* other : {key("space", "key-release"), key("x"), click(3)}) {
    fail_unless(passes(f, other));
    gst_buffer_unref(f.push(3));
    fail_unless_equals_int(views(f), 2);
  }
  fail_unless(passes(f, click(1)));
  gst_buffer_unref(f.push(4));
  fail_unless(passes(f, key("Return")));
  for (int i = 0; i < 1000 && f.result("final") == nullptr; ++i) g_usleep(10000);
  fail_unless(f.result("final") != nullptr);
  fail_unless(passes(f, key("BackSpace")));
  fail_unless_equals_int(views(f), 2);
  fail_unless(passes(f, key("Delete")));
  fail_unless_equals_int(views(f), 0);
}
GST_END_TEST;

// A sink behind calibrate: the event passes the overlay and the bin's pads.
GST_START_TEST(test_calibrate_passes_them_on) {
  GstHarness* h = check::harness_of(check::make_element("calibrate capture-mode=manual mode=sync"));
  check::Scene scene;
  gst_harness_set_src_caps(h, check::caps_of("GRAY8", scene.size));
  const auto views = [h] {
    g_autoptr(GstStructure) stats = nullptr;
    g_object_get(h->element, "stats", &stats, nullptr);
    int count = -1;
    gst_structure_get_int(stats, "views", &count);
    return count;
  };
  for (int n = 0; n < 4; ++n) {
    if (n == 2) gst_harness_push_upstream_event(h, custom("calvin-capture-view"));
    if (n == 3) gst_element_send_event(h->element, custom("calvin-capture-view"));
    GstBuffer* buffer = check::frame_of(scene.picture(n), "GRAY8", n);
    gst_buffer_unref(gst_harness_push_and_pull(h, buffer));
    fail_unless_equals_int(views(), std::max(0, n - 1));
  }
  gst_harness_teardown(h);
}
GST_END_TEST;

static Suite* calibsolve_events_suite() {
  Suite* suite = suite_create("calibsolve_events");
  TCase* tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_checked_fixture(tc, gst::register_metas, nullptr);
  tcase_add_test(tc, test_custom_events_are_the_signals);
  tcase_add_test(tc, test_keys_and_clicks_are_obeyed_and_go_on);
  tcase_add_test(tc, test_calibrate_passes_them_on);
  return suite;
}

GST_CHECK_MAIN(calibsolve_events)
