// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A frame that is a part of the picture in memory (GstVideoCropMeta): every element takes that part
// for the frame, as if it had been copied out.

#include <cmath>

#include "calvin_config.h"
#include "undistort_fixture.hpp"

#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>

using namespace calvin;
using namespace calvin::check;

static const FramePart kPart = {{800, 600}, 97, 50, kSize};

// The picture amid something else, which the caps do not speak of.
static GstBuffer* amid(const GrayImage& picture, const char* format, int n) {
  GrayImage whole(kPart.whole.width, kPart.whole.height, 60);
  paste(picture, whole, kPart.x, kPart.y);
  GstBuffer* buffer = frame_of(whole, format, n);
  GstVideoInfo info;
  gst_video_info_set_format(&info, gst_video_format_from_string(format),
                            static_cast<guint>(whole.width), static_cast<guint>(whole.height));
  add_crop(buffer, info, kPart);
  return buffer;
}

static void assert_same_corners(const std::vector<Observation>& found, const Observation& truth,
                                const char* what) {
  fail_unless_equals_int(found.size(), 1);
  fail_unless(found[0].image_size == truth.image_size, "%s", what);
  fail_unless(found[0].ids == truth.ids, "%s: no board", what);
  for (std::size_t i = 0; i < truth.uv.size(); ++i) {
    const double off =
        std::hypot(found[0].uv[i].u - truth.uv[i].u, found[0].uv[i].v - truth.uv[i].v);
    fail_unless(off < 0.3, "%s: corner %d is off by %f", what, truth.ids[i], off);
  }
}

// Luma in place, by the high byte, computed from RGB, and converted.
static const char* const kFormats[] = {"GRAY8", "NV12", "YUY2", "P010_10LE", "RGB", "v210"};

GST_START_TEST(test_corners_are_places_of_the_frame) {
  const char* format = kFormats[__i__];
  const Scene scene;
  GstElement* element = make_element("calibdetect mode=sync");
  Bus bus(element);
  GstHarness* h = harness_of(element);
  gst_harness_set_src_caps(h, caps_of(format, kSize));
  g_autoptr(GstBuffer) part = gst_harness_push_and_pull(h, amid(scene.picture(3), format, 0));
  assert_same_corners(gst::read_observations(part), scene.truth(3), format);
  // Not every frame need be a part.
  g_autoptr(GstBuffer) plain = gst_harness_push_and_pull(h, frame_of(scene.picture(4), format, 1));
  assert_same_corners(gst::read_observations(plain), scene.truth(4), format);
  fail_unless(bus.texts(GST_MESSAGE_WARNING).empty());
  bus.detach();
  gst_harness_teardown(h);
}
GST_END_TEST;

GST_START_TEST(test_a_worker_looks_at_the_frame) {
  const Scene scene;
  GstHarness* h = harness_of(make_element("calibdetect mode=async"));
  gst_harness_set_src_caps(h, caps_of("GRAY8", kSize));
  gst_buffer_unref(gst_harness_push_and_pull(h, amid(scene.picture(3), "GRAY8", 0)));
  gst_harness_push_event(h, gst_event_new_eos());
  std::vector<Observation> found;
  while (GstEvent* event = gst_harness_try_pull_event(h)) {
    const GstStructure* s = gst_event_get_structure(event);
    if (s != nullptr && gst_structure_has_name(s, gst::kObservationName)) {
      found = gst::observations_from_structure(s);
    }
    gst_event_unref(event);
  }
  assert_same_corners(found, scene.truth(3), "async");
  gst_harness_teardown(h);
}
GST_END_TEST;

// The calibration is of the frames: where the part lies in memory changes nothing.
GST_START_TEST(test_corners_move_with_the_frame) {
  const Scene scene;
  const std::string json = print_calibration(scene.camera.to_calibration()).value();
  std::vector<Observation> moved[2];
  for (const bool cropped : {false, true}) {
    Fixture f("calibdetect mode=sync ! calibundistort");
    g_object_set(f.element, "calibration", json.c_str(), nullptr);
    f.set_caps("GRAY8", kSize);
    const GrayImage picture = scene.picture(3);
    g_autoptr(GstBuffer) out = gst_harness_push_and_pull(
        f.h, cropped ? amid(picture, "GRAY8", 0) : frame_of(picture, "GRAY8", 0));
    moved[cropped ? 1 : 0] = gst::read_observations(out);
  }
  fail_unless_equals_int(moved[0].size(), 1);
  fail_unless(moved[0][0].found());
  assert_same_corners(moved[1], moved[0][0], "undistorted");
}
GST_END_TEST;

#if CALVIN_HAVE_CAIRO
GST_START_TEST(test_drawings_are_on_the_frame) {
  const Scene scene;
  GrayImage drawn[2];
  for (const bool cropped : {false, true}) {
    GstHarness* h = harness_of(make_element("caliboverlay"));
    gst_harness_set_src_caps(h, caps_of("GRAY8", kSize));
    const GrayImage picture = scene.picture(3, 0);
    GstBuffer* in = cropped ? amid(picture, "GRAY8", 0) : frame_of(picture, "GRAY8", 0);
    gst::attach_observations(in, std::vector{scene.truth(3)});
    gst::attach_guidance(in, {"tilt it", 0.5, 0.5, 0.5, 0.5, 0.5, {}, {}, 3, false});
    g_autoptr(GstBuffer) out = gst_harness_push_and_pull(h, in);
    const ImageSize size = cropped ? kPart.whole : kSize;
    GrayImage& all = drawn[cropped ? 1 : 0];
    all = GrayImage(size.width, size.height);
    all.pixels = gray_of(out, size);
    gst_harness_teardown(h);
  }
  fail_unless(drawn[0].pixels != scene.picture(3, 0).pixels);
  // What surrounds the frame is not drawn on.
  GrayImage wanted(kPart.whole.width, kPart.whole.height, 60);
  paste(drawn[0], wanted, kPart.x, kPart.y);
  fail_unless(drawn[1].pixels == wanted.pixels);
}
GST_END_TEST;
#endif

static Suite* cropped_frames_suite() {
  gst::register_metas();
  Suite* suite = suite_create("cropped_frames");
  TCase* tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_loop_test(tc, test_corners_are_places_of_the_frame, 0, G_N_ELEMENTS(kFormats));
  tcase_add_test(tc, test_a_worker_looks_at_the_frame);
  tcase_add_test(tc, test_corners_move_with_the_frame);
#if CALVIN_HAVE_CAIRO
  tcase_add_test(tc, test_drawings_are_on_the_frame);
#endif
  return suite;
}

GST_CHECK_MAIN(cropped_frames)
