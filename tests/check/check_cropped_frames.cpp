// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A frame that is a part of the picture in memory (GstVideoCropMeta): every element takes that part
// for the frame, as if it had been copied out.

#include <cmath>

#include "calvin_config.h"
#include "common/frames/frame_part.hpp"
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
    gst::attach_guidance(in,
                         {3, 0.5, 0.5, 0.5, 0.5, 0.5, {}, {}, {}, false, "tilt it", {}, {}, 0, {}});
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

// ---- calibundistort -----------------------------------------------------------------------------

// A frame of noise in memory, of which `part` is the frame that the caps speak of.
static GstBuffer* cropped_noise(const char* format, const FramePart& part, int n) {
  GstBuffer* buffer = Fixture::noise(format, part.whole, n);
  GstVideoInfo info;
  gst_video_info_set_format(&info, gst_video_format_from_string(format),
                            static_cast<guint>(part.whole.width),
                            static_cast<guint>(part.whole.height));
  add_crop(buffer, info, part);
  return buffer;
}

// What the frames are when they were copied out of the larger picture, for which the calibration
// holds: the lens kBarrel whose centre has moved.
static std::string moved_barrel(const FramePart& part) {
  return "fx=480,fy=478,cx=" + std::to_string(325 - part.x) +
         ",cy=" + std::to_string(236 - part.y) +
         ",k1=-0.28,k2=0.09,p1=0.0005,p2=-0.0007,width=" + std::to_string(part.size.width) +
         ",height=" + std::to_string(part.size.height);
}

static GstBuffer* copied_out(GstBuffer* whole, const FramePart& part) {
  const auto pixels = gray_of(whole, part.whole);
  GrayImage image(part.size.width, part.size.height);
  for (int y = 0; y < part.size.height; ++y) {
    std::copy_n(pixels.begin() + (part.y + y) * part.whole.width + part.x, part.size.width,
                image.row(y));
  }
  return frame_of(image, "GRAY8", 0);
}

// The picture wanders over the sensor: each frame is as if it had been cut out and undistorted.
GST_START_TEST(test_a_crop_is_followed_from_frame_to_frame) {
  const ImageSize size = {320, 200};
  Fixture f("calibundistort");
  g_object_set(f.element, "calibration", kBarrel, nullptr);
  f.set_caps("GRAY8", size);
  int n = 0;
  for (const Pixel at : {Pixel{0, 0}, Pixel{160, 140}, Pixel{161, 140}, Pixel{320, 280}}) {
    const FramePart part = {kSize, static_cast<int>(at.u), static_cast<int>(at.v), size};
    GstBuffer* in = cropped_noise("GRAY8", part, n++);
    Fixture plain("calibundistort");
    g_object_set(plain.element, "calibration", moved_barrel(part).c_str(), nullptr);
    plain.set_caps("GRAY8", size);
    g_autoptr(GstBuffer) want = gst_harness_push_and_pull(plain.h, copied_out(in, part));
    g_autoptr(GstBuffer) out = gst_harness_push_and_pull(f.h, in);
    fail_unless(gray_of(out, size) == gray_of(want, size), "%d", n);
    fail_unless(gst_buffer_get_video_crop_meta(out) == nullptr);
    fail_unless(output_calibration(f) == output_calibration(plain));
  }
  fail_unless(f.bus.texts(GST_MESSAGE_WARNING).empty());
  // The whole picture again.
  f.set_caps("GRAY8", kSize);
  g_autoptr(GstBuffer) whole = f.push(kSize, n);
  fail_unless(gray_of(whole, kSize) == expected_gray(kBarrel, kSize));
}
GST_END_TEST;

// Decoders have rows in memory that are not part of the picture.
GST_START_TEST(test_a_calibration_of_the_cropped_frames_holds_for_them) {
  const FramePart part = {{672, 512}, 16, 0, kSize};
  Fixture f("calibundistort");
  g_object_set(f.element, "calibration", kBarrel, nullptr);
  f.set_caps("GRAY8", kSize);
  GstBuffer* in = cropped_noise("GRAY8", part, 0);
  Fixture plain("calibundistort");
  g_object_set(plain.element, "calibration", kBarrel, nullptr);
  plain.set_caps("GRAY8", kSize);
  g_autoptr(GstBuffer) want = gst_harness_push_and_pull(plain.h, copied_out(in, part));
  g_autoptr(GstBuffer) out = gst_harness_push_and_pull(f.h, in);
  fail_unless(gray_of(out, kSize) == gray_of(want, kSize));
}
GST_END_TEST;

// Chroma comes from beside its luma.
GST_START_TEST(test_a_crop_of_several_planes) {
  const char* const format = __i__ == 0 ? "NV12" : __i__ == 1 ? "I420" : "YUY2";
  const FramePart part = {kSize, 64, 48, {320, 200}};
  Fixture f("calibundistort");
  g_object_set(f.element, "calibration", kBarrel, nullptr);
  f.set_caps(format, part.size);
  // GStreamer's own way to cut the frame out.
  Fixture plain("videocrop left=64 top=48 right=256 bottom=232 ! calibundistort");
  g_object_set(plain.element, "calibration", moved_barrel(part).c_str(), nullptr);
  plain.set_caps(format, kSize);
  g_autoptr(GstBuffer) want = gst_harness_push_and_pull(plain.h, Fixture::noise(format, kSize, 0));
  g_autoptr(GstBuffer) out = gst_harness_push_and_pull(f.h, cropped_noise(format, part, 0));
  GstMapInfo map;
  gst_buffer_map(want, &map, GST_MAP_READ);
  fail_unless(gst_buffer_memcmp(out, 0, map.data, map.size) == 0, "%s", format);
  gst_buffer_unmap(want, &map);
}
GST_END_TEST;

GST_START_TEST(test_without_a_calibration_a_crop_passes_through) {
  const FramePart part = {kSize, 64, 48, {320, 200}};
  Fixture f("calibundistort");
  f.set_caps("GRAY8", part.size);
  GstBuffer* in = cropped_noise("GRAY8", part, 0);
  g_autoptr(GstBuffer) out = gst_harness_push_and_pull(f.h, in);
  fail_unless(out == in);
  fail_unless(gst_buffer_get_video_crop_meta(out) != nullptr);
}
GST_END_TEST;

// All but the size, and what follows from it.
GST_START_TEST(test_the_format_of_a_part_is_that_of_the_picture) {
  g_autoptr(GstCaps) caps = gst_caps_from_string(
      "video/x-raw,format=I420,width=640,height=480,framerate=25/2,pixel-aspect-ratio=4/3,"
      "interlace-mode=mixed,colorimetry=bt709,chroma-site=dv");
  GstVideoInfo whole;
  fail_unless(gst_video_info_from_caps(&whole, caps));
  const GstVideoInfo part = gst::with_size(whole, {320, 200});
  g_autoptr(GstCaps) got = gst_video_info_to_caps(&part);
  gst_caps_set_simple(caps, "width", G_TYPE_INT, 320, "height", G_TYPE_INT, 200, nullptr);
  fail_unless(gst_caps_is_equal(got, caps));
  fail_unless_equals_int(part.chroma_site, GST_VIDEO_CHROMA_SITE_DV);
  fail_unless_equals_int(part.size, 320 * 200 * 3 / 2);
}
GST_END_TEST;

// What reaches past the picture in memory on any side says nothing.
GST_START_TEST(test_a_crop_past_the_picture_says_nothing) {
  static constexpr guint kCrops[][4] = {{2, 0, 639, 480},       {0, 2, 640, 479},
                                        {0, 0, 641, 480},       {0, 0, 640, 481},
                                        {G_MAXUINT, 0, 64, 48}, {0, G_MAXUINT, 64, 48}};
  const check::Scene scene;
  std::vector<Observation> want;
  for (std::size_t i = 0; i <= std::size(kCrops); ++i) {
    GstHarness* h = harness_of(make_element("calibdetect mode=sync"));
    gst_harness_set_src_caps(h, check::caps_of("GRAY8", scene.size));
    GstBuffer* in = frame_of(scene.picture(2), "GRAY8", 0);
    if (i > 0) {
      GstVideoCropMeta* crop = gst_buffer_add_video_crop_meta(in);
      crop->x = kCrops[i - 1][0];
      crop->y = kCrops[i - 1][1];
      crop->width = kCrops[i - 1][2];
      crop->height = kCrops[i - 1][3];
    }
    g_autoptr(GstBuffer) out = gst_harness_push_and_pull(h, in);
    const auto found = gst::read_observations(out);
    if (i == 0) want = found;
    fail_unless(found.size() == 1 && found[0].ids.size() == 54, "%d", static_cast<int>(i));
    for (std::size_t k = 0; k < 54; ++k) {
      fail_unless(std::abs(found[0].uv[k].u - want[0].uv[k].u) < 1e-6);
      fail_unless(std::abs(found[0].uv[k].v - want[0].uv[k].v) < 1e-6);
    }
    gst_harness_teardown(h);
  }
}
GST_END_TEST;

// GStreamer maps no frame that is larger than its GstVideoMeta.
GST_START_TEST(test_a_part_of_less_than_the_caps_is_refused) {
  const char* const elements[] = {"calibdetect mode=sync", "calibundistort", "caliboverlay"};
  const std::string name = elements[__i__];
  const bool undistorts = name == "calibundistort";
  const Scene scene;
  GstElement* element = make_element(undistorts ? name + " calibration=" + kBarrel : name);
  Bus bus(element);
  GstHarness* h = harness_of(element);
  gst_harness_set_src_caps(h, caps_of("GRAY8", kSize));
  for (int n = 0; n < 2; ++n) {
    GstBuffer* in = Fixture::noise("GRAY8", kSize, n);
    GstVideoInfo info;
    gst_video_info_set_format(&info, GST_VIDEO_FORMAT_GRAY8, 640, 480);
    add_crop(in, info, {{320, 240}, 10, 10, {300, 200}});
    gst::attach_observations(in, std::vector{scene.truth(3)});
    const auto before = gray_of(in, {320, 240});
    fail_unless_equals_int(gst_harness_push(h, in), GST_FLOW_OK);
    g_autoptr(GstBuffer) out = gst_harness_try_pull(h);
    fail_unless((out == nullptr) == undistorts);
    if (out != nullptr) fail_unless(gray_of(out, {320, 240}) == before);
  }
  const auto warnings = bus.texts(GST_MESSAGE_WARNING);
  const std::string all = join(warnings, " ");
  // Who cannot draw does not look at the frame.
  const std::string said = name == "caliboverlay" && !CALVIN_HAVE_CAIRO
                               ? "This build draws nothing on the video"
                               : "is GRAY8 of 320x240 px, but GRAY8 of 640x480 was negotiated";
  fail_unless(all.find(said) != std::string::npos, "%s", all.c_str());
  fail_unless(all.find("Internal") == std::string::npos, "%s", all.c_str());
  bus.detach();
  gst_harness_teardown(h);
}
GST_END_TEST;

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
  tcase_add_test(tc, test_a_crop_is_followed_from_frame_to_frame);
  tcase_add_test(tc, test_a_calibration_of_the_cropped_frames_holds_for_them);
  tcase_add_loop_test(tc, test_a_crop_of_several_planes, 0, 3);
  tcase_add_test(tc, test_without_a_calibration_a_crop_passes_through);
  tcase_add_test(tc, test_the_format_of_a_part_is_that_of_the_picture);
  tcase_add_test(tc, test_a_crop_past_the_picture_says_nothing);
  tcase_add_loop_test(tc, test_a_part_of_less_than_the_caps_is_refused, 0, 3);
  return suite;
}

GST_CHECK_MAIN(cropped_frames)
