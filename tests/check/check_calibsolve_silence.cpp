// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A camera that stops sending is told of by calibsolve, once, and its session goes on when frames
// come again. A stream that is paused, ended, flushed or held up is no such camera.

#include <atomic>
#include <memory>
#include <thread>

#include "pipeline.hpp"
#include "solve_fixture.hpp"

#include <gst/check/gstcheck.h>

using namespace calvin;
using check::SolveFixture;

static constexpr const char* kSilence = "No frame has come";
// Longer than the silence that is told, and much longer.
static constexpr gulong kLonger = 8 * G_USEC_PER_SEC;

static void wait_for(check::Bus& bus, GstMessageType type, const char* part) {
  for (int i = 0; i < 3000 && !bus.says(type, part); ++i) g_usleep(10000);
  fail_unless(bus.says(type, part), "nobody says '%s'", part);
}

GST_START_TEST(test_a_camera_that_stops_is_told_and_the_session_goes_on) {
  SolveFixture f;
  f.push_views(3);
  wait_for(f.bus, GST_MESSAGE_WARNING, kSilence);
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "3 views wait"));
  g_usleep(3 * G_USEC_PER_SEC);
  fail_unless_equals_int(f.bus.texts(GST_MESSAGE_WARNING).size(), 1);
  for (int n = 3; n < 6; ++n) gst_buffer_unref(f.push(n));
  wait_for(f.bus, GST_MESSAGE_INFO, "Frames come again");
  f.eos();
  int views = 0;
  gst_structure_get_int(f.result("final"), "views", &views);
  fail_unless_equals_int(views, 6);
}
GST_END_TEST;

// The caps come, and no frame ever does.
GST_START_TEST(test_a_camera_that_never_begins_is_told_too) {
  SolveFixture f;
  wait_for(f.bus, GST_MESSAGE_WARNING, kSilence);
}
GST_END_TEST;

// Whoever waits for a display or a disk downstream has no silent camera.
struct HeldDownstream {
  HeldDownstream() {
    f.push_views(1);
    g_autoptr(GstPad) src = gst_element_get_static_pad(f.element, "src");
    gst_pad_add_probe(
        src, GST_PAD_PROBE_TYPE_BUFFER,
        [](GstPad*, GstPadProbeInfo*, gpointer is_open) {
          while (!*static_cast<std::atomic<bool>*>(is_open)) g_usleep(1000);
          return GST_PAD_PROBE_OK;
        },
        &open, nullptr);
    streaming = std::thread([this] { gst_buffer_unref(f.push(1)); });
  }
  HeldDownstream(const HeldDownstream&) = delete;
  HeldDownstream& operator=(const HeldDownstream&) = delete;
  ~HeldDownstream() {
    open = true;
    streaming.join();
  }

  std::atomic<bool> open = false;
  SolveFixture f;
  std::thread streaming;
};

GST_START_TEST(test_no_other_stream_is_a_silent_camera) {
  SolveFixture paused;
  paused.push_views(1);
  gst_element_set_state(paused.element, GST_STATE_PAUSED);
  SolveFixture ready;
  ready.push_views(1);
  gst_element_set_state(ready.element, GST_STATE_READY);
  SolveFixture ended("min-views=100");
  ended.push_views(1);
  ended.eos();
  SolveFixture flushed;
  flushed.push_views(1);
  gst_harness_push_event(flushed.h, gst_event_new_flush_start());
  gst_harness_push_event(flushed.h, gst_event_new_flush_stop(TRUE));
  SolveFixture slow;
  g_autoptr(GstCaps) caps = check::caps_of("GRAY8", slow.scene.size);
  gst_caps_set_simple(caps, "framerate", GST_TYPE_FRACTION, 1, 10, nullptr);
  gst_harness_set_src_caps(slow.h, gst_caps_ref(caps));
  slow.push_views(1);
  HeldDownstream held;
  g_usleep(kLonger);
  SolveFixture* const all[] = {&paused, &ready, &ended, &flushed, &slow, &held.f};
  for (std::size_t i = 0; i < G_N_ELEMENTS(all); ++i) {
    fail_if(all[i]->bus.says(GST_MESSAGE_WARNING, kSilence), "stream %d", static_cast<int>(i));
  }
}
GST_END_TEST;

// What is not live comes when it comes.
GST_START_TEST(test_a_source_that_is_not_live_may_take_its_time) {
  check::Pipeline p(
      "appsrc name=src format=time caps=video/x-raw,format=GRAY8,width=64,height=48,framerate=30/1 "
      "! calibsolve ! fakesink async=false");
  p.set_state(GST_STATE_PLAYING);
  g_autoptr(GstBuffer) buffer = gst_buffer_new_allocate(nullptr, 64 * 48, nullptr);
  GST_BUFFER_PTS(buffer) = 0;
  GstFlowReturn flow = GST_FLOW_OK;
  g_signal_emit_by_name(p.get("src"), "push-buffer", buffer, &flow);
  g_usleep(kLonger);
  g_autoptr(GstBus) bus = gst_element_get_bus(GST_ELEMENT(p.bin()));
  g_autoptr(GstMessage) message = gst_bus_pop_filtered(bus, GST_MESSAGE_WARNING);
  fail_unless(message == nullptr);
}
GST_END_TEST;

// As a user meets it: behind calibtestsrc nothing passes any more.
GST_START_TEST(test_a_live_pipeline_goes_on_where_it_was) {
  check::Pipeline p(
      "calibtestsrc is-live=true ! video/x-raw,width=320,height=240 ! valve name=valve ! calibrate "
      "overlay=false ! fakesink");
  g_autoptr(GstBus) bus = gst_element_get_bus(GST_ELEMENT(p.bin()));
  p.preroll(GST_STATE_PLAYING);
  g_usleep(G_USEC_PER_SEC);
  for (const auto& [drop, type] :
       {std::pair{true, GST_MESSAGE_WARNING}, std::pair{false, GST_MESSAGE_INFO}}) {
    g_object_set(p.get("valve"), "drop", static_cast<gboolean>(drop), nullptr);
    g_autoptr(GstMessage) message = gst_bus_timed_pop_filtered(bus, 30 * GST_SECOND, type);
    fail_unless(message != nullptr);
    fail_unless_equals_string(G_OBJECT_TYPE_NAME(GST_MESSAGE_SRC(message)), "GstCalibSolve");
  }
}
GST_END_TEST;

static Suite* calibsolve_silence_suite() {
  Suite* suite = suite_create("calibsolve_silence");
  TCase* tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_checked_fixture(tc, gst::register_metas, nullptr);
  tcase_add_test(tc, test_a_camera_that_stops_is_told_and_the_session_goes_on);
  tcase_add_test(tc, test_a_camera_that_never_begins_is_told_too);
  tcase_add_test(tc, test_no_other_stream_is_a_silent_camera);
  tcase_add_test(tc, test_a_source_that_is_not_live_may_take_its_time);
  tcase_add_test(tc, test_a_live_pipeline_goes_on_where_it_was);
  return suite;
}

GST_CHECK_MAIN(calibsolve_silence)
