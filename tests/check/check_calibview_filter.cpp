// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibview behind calibrig: a filter that shows the rig of upstream.

#include <algorithm>
#include <string>
#include <vector>

#include "calvin_config.h"
#include "common/rig_event.hpp"
#include "view_fixture.hpp"

#include <gst/check/gstcheck.h>
#include <gst/video/navigation.h>
#include <gst/video/video.h>

using namespace calvin;
using check::rig_of;
using check::ViewFixture;

#if CALVIN_HAVE_CAIRO

// A harness links the pad `sink`, which makes it a filter.
struct FilterFixture {
  explicit FilterFixture(const std::string& rig = {}) : h(harness_of(rig)), bus(h->element) {
    gst_harness_set_sink_caps_str(h, "video/x-raw,format=BGRx,width=320,height=240");
    gst_harness_set_src_caps_str(h, "video/x-raw,format=I420,width=64,height=48,framerate=50/1");
  }
  ~FilterFixture() {
    bus.detach();
    gst_harness_teardown(h);
  }
  GstBuffer* push(GstClockTime pts) {
    GstBuffer* frame = gst_harness_create_buffer(h, 64 * 48 * 3 / 2);
    gst_buffer_memset(frame, 0, 0, gst_buffer_get_size(frame));
    GST_BUFFER_PTS(frame) = pts;
    GST_BUFFER_DURATION(frame) = 20 * GST_MSECOND;
    gst_buffer_add_video_region_of_interest_meta(frame, "board", 1, 2, 3, 4);
    return gst_harness_push_and_pull(h, frame);
  }
  std::vector<std::uint8_t> picture(GstClockTime pts) {
    g_autoptr(GstBuffer) out = push(pts);
    GstMapInfo map;
    fail_unless(gst_buffer_map(out, &map, GST_MAP_READ));
    std::vector<std::uint8_t> pixels(map.data, map.data + map.size);
    gst_buffer_unmap(out, &map);
    return pixels;
  }
  void tell(const std::string& json) { gst_harness_push_event(h, gst::new_rig_event(json)); }

  static GstHarness* harness_of(const std::string& rig) {
    g_autoptr(GstElement) element = gst_element_factory_make("calibview", nullptr);
    gst_object_ref_sink(element);
    g_object_set(element, "orbit", 0.0, nullptr);
    if (!rig.empty()) g_object_set(element, "rig", rig.c_str(), nullptr);
    return gst_harness_new_with_element(element, "sink", "src");
  }

  GstHarness* h;
  check::Bus bus;
};

GST_START_TEST(test_is_a_filter_that_shows_the_rig_of_upstream) {
  FilterFixture f;
  g_autoptr(GstBuffer) out = f.push(20 * GST_MSECOND);
  fail_unless_equals_uint64(GST_BUFFER_PTS(out), 20 * GST_MSECOND);
  fail_unless_equals_uint64(GST_BUFFER_DURATION(out), 20 * GST_MSECOND);
  fail_unless_equals_int(gst_buffer_get_size(out), 4 * 320 * 240);
  fail_unless(gst_buffer_get_video_region_of_interest_meta(out) == nullptr, "of another picture");
  const auto nothing = f.picture(40 * GST_MSECOND);
  fail_unless(f.bus.texts(GST_MESSAGE_WARNING).empty(), "it is waited for");
  f.tell(print_rig(rig_of(0.1)).value());
  const auto shown = f.picture(60 * GST_MSECOND);
  fail_unless(shown != nothing);
  f.tell("{\"half\": ");
  fail_unless(f.picture(80 * GST_MSECOND) == shown);
  fail_unless_equals_int(f.bus.texts(GST_MESSAGE_WARNING).size(), 1);
  f.tell(print_rig(rig_of(0.5)).value());
  fail_unless(f.picture(100 * GST_MSECOND) != shown);
  // The same picture as that of a source.
  ViewFixture source;
  gst_harness_play(source.h);
  fail_unless(source.pull() == shown);
}
GST_END_TEST;

GST_START_TEST(test_a_rig_that_is_set_beats_that_of_upstream) {
  FilterFixture f(print_rig(rig_of(0.1)).value());
  const auto shown = f.picture(0);
  f.tell(print_rig(rig_of(0.5)).value());
  fail_unless(f.picture(20 * GST_MSECOND) == shown);
}
GST_END_TEST;

static GstPadProbeReturn note_event(GstPad* /*pad*/, GstPadProbeInfo* info, gpointer names) {
  GstEvent* event = GST_PAD_PROBE_INFO_EVENT(info);
  const GstStructure* s = gst_event_get_structure(event);
  static_cast<std::vector<std::string>*>(names)->emplace_back(
      s != nullptr && GST_EVENT_TYPE(event) != GST_EVENT_CAPS ? gst_structure_get_name(s)
                                                              : GST_EVENT_TYPE_NAME(event));
  return GST_PAD_PROBE_OK;
}

// Its picture is not that of the camera: no turn and no lens of that is its own, no click in it is
// one of the camera's, and it has a size of its own.
GST_START_TEST(test_a_filter_keeps_what_is_said_of_the_camera) {
  FilterFixture f;
  g_autoptr(GstPad) src = gst_element_get_static_pad(f.h->element, "src");
  std::vector<std::string> passed;
  gst_pad_add_probe(src, GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM, note_event, &passed, nullptr);
  gst_harness_push_event(
      f.h, gst_event_new_tag(gst_tag_list_new(GST_TAG_IMAGE_ORIENTATION, "rotate-90", nullptr)));
  gst_harness_push_event(
      f.h, gst_event_new_custom(
               GST_EVENT_CUSTOM_DOWNSTREAM_STICKY,
               gst_structure_new("calvin-calibration", "json", G_TYPE_STRING, "{}", nullptr)));
  f.tell(print_rig(rig_of(0.1)).value());
  const auto before = f.picture(0);
  for (const std::string& name : passed) {
    fail_if(name == "calvin-calibration" || name == "tag" || name == "GstTagList", "%s passed",
            name.c_str());
  }
  fail_unless(std::count(passed.begin(), passed.end(), "calvin-rig") == 1);
  while (GstEvent* event = gst_harness_try_pull_upstream_event(f.h)) gst_event_unref(event);
  const auto none = static_cast<GstNavigationModifierType>(0);
  gst_harness_push_upstream_event(f.h, gst_navigation_event_new_mouse_scroll(9, 9, 0, 1, none));
  fail_unless(f.picture(20 * GST_MSECOND) != before, "the wheel comes closer");
  while (GstEvent* event = gst_harness_try_pull_upstream_event(f.h)) {
    fail_if(GST_EVENT_TYPE(event) == GST_EVENT_NAVIGATION);
    gst_event_unref(event);
  }
  g_autoptr(GstCaps) asked = gst_pad_peer_query_caps(f.h->srcpad, nullptr);
  g_autoptr(GstCaps) other = gst_caps_from_string(
      "video/x-raw(memory:DMABuf),format=NV12,width=1920,height=1080,framerate=30/1");
  fail_unless(gst_caps_can_intersect(asked, other), "%s", gst_caps_to_string(asked));
}
GST_END_TEST;

GST_START_TEST(test_a_pad_is_asked_for_before_it_runs) {
  check::TemporaryFolder folder;
  const std::string location = folder / "rig.json";
  (void)write_rig(location, rig_of(0.1));
  GstElement* element = gst_element_factory_make("calibview", nullptr);
  gst_object_ref_sink(element);
  check::Bus bus(element);
  g_object_set(element, "rig", location.c_str(), nullptr);
  GstPad* sink = gst_element_request_pad_simple(element, "sink");
  fail_unless(sink != nullptr);
  gst_element_release_request_pad(element, sink);
  gst_object_unref(sink);
  fail_unless(gst_element_get_static_pad(element, "sink") == nullptr);
  gst_element_set_state(element, GST_STATE_PAUSED);
  fail_unless(gst_element_request_pad_simple(element, "sink") == nullptr);
  fail_unless(bus.says(GST_MESSAGE_WARNING, "NULL or READY"));
  gst_element_set_state(element, GST_STATE_NULL);
  bus.detach();
  gst_object_unref(element);
}
GST_END_TEST;

// In one text, with the pad of calibrig that comes before its camera.
GST_START_TEST(test_shows_what_calibrig_solves) {
  g_autoptr(GstElement) pipeline = gst_parse_launch(
      "calibrig name=rig rig.src_0 ! calibview orbit=0 name=view ! fakesink name=sink "
      "calibtestsrc num-buffers=30 ! calibrate ! rig.sink_0 "
      "calibtestsrc num-buffers=30 ! calibrate ! rig.sink_1",
      nullptr);
  fail_unless(pipeline != nullptr);
  g_autoptr(GstElement) view = gst_bin_get_by_name(GST_BIN(pipeline), "view");
  g_autoptr(GstPad) src = gst_element_get_static_pad(view, "src");
  std::vector<std::string> passed;
  gst_pad_add_probe(src, GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM, note_event, &passed, nullptr);
  g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  g_autoptr(GstMessage) end = gst_bus_timed_pop_filtered(
      bus, 60 * GST_SECOND, static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR));
  fail_unless(end != nullptr && GST_MESSAGE_TYPE(end) == GST_MESSAGE_EOS);
  gst_bus_set_flushing(bus, TRUE);
  gst_element_set_state(pipeline, GST_STATE_NULL);
  fail_unless(std::count(passed.begin(), passed.end(), "calvin-rig") > 0);
}
GST_END_TEST;

#endif

static Suite* calibview_filter_suite(void) {
  Suite* s = suite_create("calibview_filter");
  TCase* tc = tcase_create("general");
  suite_add_tcase(s, tc);
  tcase_set_timeout(tc, 60);
#if CALVIN_HAVE_CAIRO
  tcase_add_test(tc, test_is_a_filter_that_shows_the_rig_of_upstream);
  tcase_add_test(tc, test_a_rig_that_is_set_beats_that_of_upstream);
  tcase_add_test(tc, test_a_filter_keeps_what_is_said_of_the_camera);
  tcase_add_test(tc, test_a_pad_is_asked_for_before_it_runs);
  tcase_add_test(tc, test_shows_what_calibrig_solves);
#endif
  return s;
}

GST_CHECK_MAIN(calibview_filter);
