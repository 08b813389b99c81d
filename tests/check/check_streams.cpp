// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Streams one after the other, as from concat or a playlist: nothing of one is told of the next.

#include "common/calibration_event.hpp"
#include "gate.hpp"
#include "solve_fixture.hpp"

#include <gst/check/gstcheck.h>

using namespace calvin;
using check::SolveFixture;

// The next stream, with frames of that size that begin at `base` of running time.
static void begin_stream(GstHarness* h, const char* id, ImageSize size, GstClockTime base = 0) {
  gst_harness_push_event(h, gst_event_new_stream_start(id));
  g_autoptr(GstCaps) caps = check::caps_of("GRAY8", size);
  gst_harness_push_event(h, gst_event_new_caps(caps));
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  segment.base = base;
  gst_harness_push_event(h, gst_event_new_segment(&segment));
}

// The events of that name that came out since they were last looked at.
static int events_named(GstHarness* h, const char* name) {
  int count = 0;
  while (GstEvent* event = gst_harness_try_pull_event(h)) {
    count += gst_event_has_name(event, name) != FALSE ? 1 : 0;
    gst_event_unref(event);
  }
  return count;
}

// ---- calibdetect --------------------------------------------------------------------------------

static check::Gate detected;

static GstBusSyncReply hold_detection(GstBus*, GstMessage* message, gpointer) {
  const GstStructure* s = gst_message_get_structure(message);
  if (s != nullptr && gst_structure_has_name(s, "calib-detection")) detected.pass();
  return GST_BUS_PASS;
}

// What a worker finds on a frame of the stream before rides on no frame of this one.
GST_START_TEST(test_a_held_detection_is_not_of_the_next_stream) {
  const check::Scene scene;
  GstElement* element = check::make_element("calibdetect mode=async post-messages=true");
  check::Bus bus(element);
  g_autoptr(GstBus) posts = gst_element_get_bus(element);
  gst_bus_set_sync_handler(posts, hold_detection, nullptr, nullptr);
  GstHarness* h = check::harness_of(element);
  gst_harness_set_src_caps(h, check::caps_of("GRAY8", scene.size));
  detected.close();
  gst_buffer_unref(gst_harness_push_and_pull(h, check::frame_of(scene.picture(2), "GRAY8", 0)));
  fail_unless(detected.reached());
  const ImageSize next = __i__ == 0 ? scene.size : ImageSize{320, 240};
  begin_stream(h, "second", next);
  detected.open();
  events_named(h, gst::kObservationName);
  gst_harness_push_event(h, gst_event_new_eos());
  fail_unless_equals_int(events_named(h, gst::kObservationName), 0);
  bus.detach();
  gst_harness_teardown(h);
  fail_if(detected.forced());
}
GST_END_TEST;

// The beat of max-rate begins anew.
GST_START_TEST(test_the_first_frame_of_a_stream_is_looked_at) {
  const check::Scene scene;
  GstHarness* h = check::harness_of(check::make_element("calibdetect mode=sync max-rate=1"));
  gst_harness_set_src_caps(h, check::caps_of("GRAY8", scene.size));
  const auto looked_at = [&](int n) {
    g_autoptr(GstBuffer) out =
        gst_harness_push_and_pull(h, check::frame_of(scene.picture(2), "GRAY8", n));
    return !gst::read_observations(out).empty();
  };
  fail_unless(looked_at(0));
  fail_if(looked_at(1));
  begin_stream(h, "second", scene.size, GST_SECOND / 2);
  fail_unless(looked_at(0));
  fail_if(looked_at(1));
  gst_harness_teardown(h);
}
GST_END_TEST;

// ---- calibsolve ---------------------------------------------------------------------------------

static int views_of(GstElement* element) {
  g_autoptr(GstStructure) stats = nullptr;
  g_object_get(element, "stats", &stats, nullptr);
  int views = -1;
  gst_structure_get_int(stats, "views", &views);
  return views;
}

GST_START_TEST(test_another_stream_of_the_same_size_goes_on_with_the_session) {
  SolveFixture f;
  f.push_views(6);
  begin_stream(f.h, "second", f.scene.size);
  fail_unless_equals_int(views_of(f.element), 6);
  for (int n = 6; n < 10; ++n) gst_buffer_unref(f.push(n));
  f.eos();
  int views = 0;
  gst_structure_get_int(f.result("final"), "views", &views);
  fail_unless_equals_int(views, 10);
}
GST_END_TEST;

// Another size: nothing is left of what the stream before had, neither what it found nor what it
// was told.
GST_START_TEST(test_a_stream_of_another_size_begins_a_session) {
  SolveFixture f("max-views=12 runs=2");
  f.push_views(12);
  f.eos();
  fail_unless(f.result("final") != nullptr);
  const auto results = f.bus.named("calib-result").size();
  begin_stream(f.h, "second", {320, 240});
  f.scene = check::Scene{{320, 240}};
  fail_unless_equals_int(views_of(f.element), 0);
  g_autofree char* json = nullptr;
  g_object_get(f.element, "calibration", &json, nullptr);
  fail_unless(json == nullptr);
  while (GstEvent* event = gst_harness_try_pull_upstream_event(f.h)) gst_event_unref(event);
  events_named(f.h, gst::kCalibrationEvent);
  g_autoptr(GstBuffer) first = f.push(0);
  const auto guidance = gst::read_guidance(first);
  fail_unless_equals_int(guidance->views, 1);
  fail_if(guidance->expected_error.has_value());
  fail_unless_equals_int(events_named(f.h, gst::kCalibrationEvent), 0);
  f.eos();
  fail_unless(f.bus.named("calib-result").size() == results);
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "only one view"));
}
GST_END_TEST;

// What kept one stream from being solved is not what keeps the next.
GST_START_TEST(test_the_failure_of_a_stream_is_not_told_of_the_next) {
  SolveFixture f;
  for (int i = 0; i < 4; ++i) gst_buffer_unref(f.push_observation(f.seen(3), i));
  f.eos();
  fail_unless_equals_int(f.bus.texts(GST_MESSAGE_WARNING).size(), 1);
  begin_stream(f.h, "second", {320, 240});
  f.eos();
  const auto said = f.bus.texts(GST_MESSAGE_WARNING);
  fail_unless_equals_int(said.size(), 2);
  fail_unless(said[1].find("no view of the board was taken") != std::string::npos, "%s",
              said[1].c_str());
}
GST_END_TEST;

// A rejection is posted when its reason is new; in a new session every reason is.
GST_START_TEST(test_a_new_session_tells_its_rejections) {
  SolveFixture f("capture-mode=manual", {}, "");
  const auto rejections = [&] { return f.bus.named("calib-view").size(); };
  f.push_views(3);
  fail_unless_equals_int(rejections(), 1);
  g_signal_emit_by_name(f.element, "reset");
  f.push_views(3);
  fail_unless_equals_int(rejections(), 2);
}
GST_END_TEST;

// A camera, and then its recording: of that every view is kept.
GST_START_TEST(test_each_stream_is_asked_whether_it_is_live) {
  SolveFixture f("", {}, "");
  f.push_views(1);
  fail_unless_equals_int(views_of(f.element), 0);
  gst_harness_set_live(f.h, FALSE);
  begin_stream(f.h, "second", {320, 240});
  f.scene = check::Scene{{320, 240}};
  f.push_views(1);
  fail_unless_equals_int(views_of(f.element), 1);
}
GST_END_TEST;

// Another detector may be upstream of it.
GST_START_TEST(test_each_stream_is_asked_for_patches) {
  SolveFixture f("runs=2");
  const auto asked = [&] {
    int count = 0;
    while (GstEvent* event = gst_harness_try_pull_upstream_event(f.h)) {
      count += gst_event_has_name(event, gst::kWantPatchesName) != FALSE ? 1 : 0;
      gst_event_unref(event);
    }
    return count;
  };
  f.push_views(2);
  fail_unless_equals_int(asked(), 1);
  begin_stream(f.h, "second", {320, 240});
  fail_unless_equals_int(asked(), 1);
}
GST_END_TEST;

static Suite* streams_suite() {
  Suite* suite = suite_create("streams");
  TCase* tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_checked_fixture(tc, gst::register_metas, nullptr);
  tcase_add_loop_test(tc, test_a_held_detection_is_not_of_the_next_stream, 0, 2);
  tcase_add_test(tc, test_the_first_frame_of_a_stream_is_looked_at);
  tcase_add_test(tc, test_another_stream_of_the_same_size_goes_on_with_the_session);
  tcase_add_test(tc, test_a_stream_of_another_size_begins_a_session);
  tcase_add_test(tc, test_the_failure_of_a_stream_is_not_told_of_the_next);
  tcase_add_test(tc, test_a_new_session_tells_its_rejections);
  tcase_add_test(tc, test_each_stream_is_asked_whether_it_is_live);
  tcase_add_test(tc, test_each_stream_is_asked_for_patches);
  return suite;
}

GST_CHECK_MAIN(streams)
