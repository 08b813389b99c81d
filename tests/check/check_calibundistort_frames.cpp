// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibundistort: frames that are interlaced, lie on a side, or are none; what ends with them.

#include "undistort_fixture.hpp"

#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>

using namespace calvin;
using namespace calvin::check;

static const char* const kInterlaced[] = {
    "video/x-raw,interlace-mode=interleaved", "video/x-raw,interlace-mode=mixed",
    "video/x-raw,interlace-mode=fields", "video/x-raw(format:Interlaced),interlace-mode=alternate"};

GST_START_TEST(test_interlaced_video_passes_with_a_warning) {
  Fixture f("calibundistort");
  g_object_set(f.element, "calibration", kBarrel, nullptr);
  const std::string caps =
      std::string(kInterlaced[__i__]) + ",format=GRAY8,width=640,height=480,framerate=25/1";
  gst_harness_set_src_caps_str(f.h, caps.c_str());
  for (int n = 0; n < 2; ++n) {
    GstBuffer* in = Fixture::noise("GRAY8", kSize, n);
    g_autoptr(GstBuffer) out = gst_harness_push_and_pull(f.h, in);
    fail_unless(in == out);
  }
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "deinterlace"));
  fail_unless_equals_int(f.bus.texts(GST_MESSAGE_WARNING).size(), 1);
  fail_unless(output_calibration(f).empty());
  // Progressive again.
  f.set_caps("GRAY8", kSize);
  g_autoptr(GstBuffer) out = f.push(kSize, 2);
  fail_unless(gray_of(out, kSize) == expected_gray(kBarrel, kSize));
}
GST_END_TEST;

GST_START_TEST(test_interlaced_video_is_not_scaled) {
  Fixture f("calibundistort ! capsfilter caps=video/x-raw,width=320,height=240");
  gst_harness_set_src_caps_str(
      f.h,
      "video/x-raw,format=GRAY8,width=640,height=480,framerate=25/1,interlace-mode=interleaved");
  fail_unless(gst_harness_push(f.h, Fixture::noise("GRAY8", kSize, 0)) == GST_FLOW_NOT_NEGOTIATED);
  fail_unless(f.bus.says(GST_MESSAGE_ERROR, "deinterlace"));
}
GST_END_TEST;

GST_START_TEST(test_frames_that_are_too_short_are_left_out) {
  Fixture f("calibundistort");
  g_object_set(f.element, "calibration", kBarrel, nullptr);
  f.set_caps("GRAY8", kSize);
  for (int n = 0; n < 4; ++n) {
    const bool is_whole = n % 2 == 0;
    GstBuffer* in = is_whole ? Fixture::noise("GRAY8", kSize, n)
                             : gst_buffer_new_allocate(nullptr, 1000, nullptr);
    fail_unless_equals_int(gst_harness_push(f.h, in), GST_FLOW_OK);
    fail_unless_equals_int(gst_harness_buffers_in_queue(f.h), is_whole ? 1 : 0);
    if (!is_whole) continue;
    g_autoptr(GstBuffer) out = gst_harness_pull(f.h);
    fail_unless(gray_of(out, kSize) == expected_gray(kBarrel, kSize));
  }
  // Once is enough.
  fail_unless_equals_int(f.bus.texts(GST_MESSAGE_WARNING).size(), 1);
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "1000 bytes"));
  fail_unless(f.bus.texts(GST_MESSAGE_ERROR).empty());
}
GST_END_TEST;

// Orientations, and how they take a pixel of a lying frame of w x h to the upright picture.
using Turn = Pixel (*)(Pixel, double w, double h);
static const struct {
  const char* tag;
  bool on_its_side;
  Turn turn;
} kTurns[] = {
    {"rotate-0", false, [](Pixel p, double, double) { return p; }},
    {"rotate-90", true,
     [](Pixel p, double, double h) {
       return Pixel{h - 1 - p.v, p.u};
     }},
    {"rotate-180", false,
     [](Pixel p, double w, double h) {
       return Pixel{w - 1 - p.u, h - 1 - p.v};
     }},
    {"rotate-270", true,
     [](Pixel p, double w, double) {
       return Pixel{p.v, w - 1 - p.u};
     }},
    {"flip-rotate-0", false,
     [](Pixel p, double w, double) {
       return Pixel{w - 1 - p.u, p.v};
     }},
    {"flip-rotate-90", true,
     [](Pixel p, double w, double h) {
       return Pixel{h - 1 - p.v, w - 1 - p.u};
     }},
    {"flip-rotate-180", false,
     [](Pixel p, double, double h) {
       return Pixel{p.u, h - 1 - p.v};
     }},
    {"flip-rotate-270", true,
     [](Pixel p, double, double) {
       return Pixel{p.v, p.u};
     }},
};

// What the table above says is what the element behind does that turns pictures by their tag.
GST_START_TEST(test_videoflip_turns_as_the_table_says) {
  const auto& [tag, on_its_side, turn] = kTurns[__i__];
  g_autoptr(GstElementFactory) flip = gst_element_factory_find("videoflip");
  if (flip == nullptr) return;
  GstHarness* h = gst_harness_new_parse("videoflip video-direction=auto");
  const ImageSize lying = {64, 48};
  const ImageSize upright = on_its_side ? ImageSize{48, 64} : lying;
  gst_harness_set_src_caps(h, caps_of("GRAY8", lying));
  GstTagList* tags = gst_tag_list_new(GST_TAG_IMAGE_ORIENTATION, tag, nullptr);
  gst_harness_push_event(h, gst_event_new_tag(tags));
  g_autoptr(GstBuffer) in = Fixture::noise("GRAY8", lying, 0);
  g_autoptr(GstBuffer) out = gst_harness_push_and_pull(h, gst_buffer_ref(in));
  const auto before = gray_of(in, lying);
  const auto after = gray_of(out, upright);
  for (int y = 0; y < lying.height; ++y) {
    for (int x = 0; x < lying.width; ++x) {
      const Pixel to = turn({0.0 + x, 0.0 + y}, lying.width, lying.height);
      fail_unless(after[static_cast<std::size_t>(to.v * upright.width + to.u)] ==
                  before[static_cast<std::size_t>(y * lying.width + x)]);
    }
  }
  gst_harness_teardown(h);
}
GST_END_TEST;

static GstEvent* orientation_event(const char* tag, GstTagScope scope) {
  GstTagList* tags = gst_tag_list_new(GST_TAG_IMAGE_ORIENTATION, tag, nullptr);
  gst_tag_list_set_scope(tags, scope);
  return gst_event_new_tag(tags);
}

// Of the upright picture, 480x640.
static const char kUpright[] =
    "fx=478,fy=480,cx=243,cy=325,k1=-0.28,k2=0.09,p1=-0.0007,p2=0.0005,width=480,height=640";

// px of a pinhole without distortion -> px of the lens kUpright.
static Pixel upright_source(double x, double y) {
  const double r2 = x * x + y * y;
  const double g = 1 - 0.28 * r2 + 0.09 * r2 * r2;
  return {478 * (x * g - 2 * 0.0007 * x * y + 0.0005 * (r2 + 2 * x * x)) + 243,
          480 * (y * g - 0.0007 * (r2 + 2 * y * y) + 2 * 0.0005 * x * y) + 325};
}

// Every straight line of the scene is straight in the turned output. The ray (x, y, 1) of the
// upright camera lies in the lying one at the inverse of the turn; the view that is announced must
// show it where the pixels are.
GST_START_TEST(test_a_calibration_of_the_upright_picture_is_turned_to_the_frames) {
  const auto& [tag, on_its_side, turn] = kTurns[__i__];
  Fixture f("calibundistort");
  g_object_set(f.element, "calibration", kUpright, "alpha", 1.0, nullptr);
  gst_harness_push_event(f.h, gst_event_new_stream_start("one"));
  f.set_caps("GRAY8", kSize);
  gst_harness_push_event(
      f.h, orientation_event(tag, __i__ % 2 == 0 ? GST_TAG_SCOPE_STREAM : GST_TAG_SCOPE_GLOBAL));
  GstBuffer* in = Fixture::noise("GRAY8", kSize, 0);
  g_autoptr(GstBuffer) out = gst_harness_push_and_pull(f.h, in);
  if (!on_its_side) {
    fail_unless(out == in);
    fail_unless(f.bus.says(GST_MESSAGE_WARNING, "another aspect"));
    return;
  }
  fail_unless(f.bus.texts(GST_MESSAGE_WARNING).empty());
  const Camera view = Camera::make(parse_calibration(output_calibration(f)).value()).value();
  fail_unless(view.image_size() == kSize);
  // The source pixel of an output pixel, as the pointer sees it, turned upright, is where the
  // upright lens shows the ray of the output pixel turned upright.
  int compared = 0;
  for (int v = 60; v < 420; v += 40) {
    for (int u = 80; u < 560; u += 40) {
      gst_harness_push_upstream_event(
          f.h, gst_navigation_event_new_mouse_move(u + 0.5, v + 0.5, GST_NAVIGATION_MODIFIER_NONE));
      Pixel source = {};
      while (GstEvent* up = gst_harness_try_pull_upstream_event(f.h)) {
        if (gst_navigation_event_get_coordinates(up, &source.u, &source.v)) ++compared;
        gst_event_unref(up);
      }
      const Pixel shown = turn({source.u - 0.5, source.v - 0.5}, 640, 480);
      const Pixel centre = turn({view.cx(), view.cy()}, 640, 480);
      const Pixel turned = turn({0.0 + u, 0.0 + v}, 640, 480);
      const Pixel want =
          upright_source((turned.u - centre.u) / view.fy(), (turned.v - centre.v) / view.fx());
      fail_unless(std::hypot(shown.u - want.u, shown.v - want.v) < 1e-6, "%s at %d, %d", tag, u, v);
    }
  }
  fail_unless(compared > 50);
}
GST_END_TEST;

GST_START_TEST(test_the_tag_of_the_stream_beats_that_of_the_medium) {
  Fixture f("calibundistort");
  g_object_set(f.element, "calibration", kUpright, nullptr);
  gst_harness_push_event(f.h, gst_event_new_stream_start("one"));
  f.set_caps("GRAY8", kSize);
  const auto passes = [&](int n) {
    GstBuffer* in = Fixture::noise("GRAY8", kSize, n);
    g_autoptr(GstBuffer) out = gst_harness_push_and_pull(f.h, in);
    return in == out;
  };
  gst_harness_push_event(f.h, orientation_event("rotate-90", GST_TAG_SCOPE_GLOBAL));
  fail_if(passes(0));
  gst_harness_push_event(f.h, orientation_event("rotate-0", GST_TAG_SCOPE_STREAM));
  fail_unless(passes(1));
  gst_harness_push_event(f.h, orientation_event("rotate-270", GST_TAG_SCOPE_STREAM));
  fail_if(passes(2));
  // Tags go on: whoever turns the picture is behind.
  int tags = 0;
  while (GstEvent* event = gst_harness_try_pull_event(f.h)) {
    tags += GST_EVENT_TYPE(event) == GST_EVENT_TAG ? 1 : 0;
    gst_event_unref(event);
  }
  fail_unless_equals_int(tags, 3);
}
GST_END_TEST;

// A calibration of the frames as they are is not turned, whatever a tag says.
GST_START_TEST(test_a_calibration_of_the_sensor_holds_whatever_the_orientation) {
  Fixture f("calibundistort");
  g_object_set(f.element, "calibration", kBarrel, nullptr);
  f.set_caps("GRAY8", kSize);
  gst_harness_push_event(f.h, orientation_event(kTurns[__i__].tag, GST_TAG_SCOPE_STREAM));
  g_autoptr(GstBuffer) out = f.push(kSize);
  fail_unless(gray_of(out, kSize) == expected_gray(kBarrel, kSize));
}
GST_END_TEST;

// Files one after the other, as from a playlist: what the first one says of its pictures is not
// true of the second.
GST_START_TEST(test_an_orientation_ends_with_its_stream) {
  Fixture f("calibundistort");
  g_object_set(f.element, "calibration", kUpright, nullptr);
  gst_harness_push_event(f.h, gst_event_new_stream_start("one"));
  f.set_caps("GRAY8", kSize);
  gst_harness_push_event(f.h, orientation_event("rotate-90", GST_TAG_SCOPE_STREAM));
  const auto passes = [&](int n) {
    GstBuffer* in = Fixture::noise("GRAY8", kSize, n);
    g_autoptr(GstBuffer) out = gst_harness_push_and_pull(f.h, in);
    return in == out;
  };
  fail_if(passes(0));
  gst_harness_push_event(f.h, gst_event_new_stream_start("two"));
  f.set_caps("GRAY8", kSize);
  fail_unless(passes(1));
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "another aspect"));
}
GST_END_TEST;

// Stopped and started again, as an application does for the next camera: nothing is known of that
// one, whatever came with the frames of the last.
GST_START_TEST(test_a_stop_forgets_the_stream) {
  constexpr GstState kStops[] = {GST_STATE_READY, GST_STATE_NULL};
  Fixture f("calibundistort");
  gst_harness_push_event(f.h, gst_event_new_stream_start("one"));
  f.set_caps("GRAY8", kSize);
  // Past the pad of the harness, which would send it again: what is upstream next knows nothing.
  g_autoptr(GstPad) sink = gst_element_get_static_pad(f.element, "sink");
  fail_unless(gst_pad_send_event(sink, event_of(kBarrel)));
  g_autoptr(GstBuffer) before = f.push(kSize, 0);
  fail_unless(gray_of(before, kSize) == expected_gray(kBarrel, kSize));
  gst_element_set_state(f.h->element, kStops[__i__]);
  (void)events_out(f);
  gst_element_set_state(f.h->element, GST_STATE_PLAYING);
  gst_harness_push_event(f.h, gst_event_new_stream_start("two"));
  g_autoptr(GstCaps) caps = check::caps_of("GRAY8", kSize);
  gst_harness_push_event(f.h, gst_event_new_caps(caps));
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  gst_harness_push_event(f.h, gst_event_new_segment(&segment));
  GstBuffer* in = Fixture::noise("GRAY8", kSize, 1);
  g_autoptr(GstBuffer) after = gst_harness_push_and_pull(f.h, in);
  fail_unless(in == after);
  fail_unless(output_calibration(f).empty());
  for (const gst::CalibrationEvent& event : events_out(f)) fail_unless(event.json.empty());
}
GST_END_TEST;

static Suite* calibundistort_frames_suite() {
  Suite* suite = suite_create("calibundistort_frames");
  TCase* tc = tcase_create("general");
  const int turns = static_cast<int>(std::size(kTurns));
  tcase_add_loop_test(tc, test_interlaced_video_passes_with_a_warning, 0,
                      static_cast<int>(std::size(kInterlaced)));
  tcase_add_test(tc, test_interlaced_video_is_not_scaled);
  tcase_add_test(tc, test_frames_that_are_too_short_are_left_out);
  tcase_add_loop_test(tc, test_videoflip_turns_as_the_table_says, 0, turns);
  tcase_add_loop_test(tc, test_a_calibration_of_the_upright_picture_is_turned_to_the_frames, 0,
                      turns);
  tcase_add_test(tc, test_the_tag_of_the_stream_beats_that_of_the_medium);
  tcase_add_test(tc, test_an_orientation_ends_with_its_stream);
  tcase_add_loop_test(tc, test_a_stop_forgets_the_stream, 0, 2);
  tcase_add_loop_test(tc, test_a_calibration_of_the_sensor_holds_whatever_the_orientation, 0,
                      turns);
  suite_add_tcase(suite, tc);
  return suite;
}

GST_CHECK_MAIN(calibundistort_frames)
