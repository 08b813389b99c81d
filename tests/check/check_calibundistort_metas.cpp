// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibundistort: what moves with the pixels.

#include "undistort_fixture.hpp"

#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>

using namespace calvin;
using namespace calvin::check;

GST_START_TEST(test_corners_follow_the_pixels) {
  Fixture f("calibundistort");
  g_object_set(f.element, "calibration", kBarrel, nullptr);
  f.set_caps("GRAY8", kSize);
  Observation seen;
  seen.camera = "left";
  seen.board = "checkerboard:9x6:25mm";
  seen.image_size = kSize;
  seen.ids = {3, 8, 9};
  seen.uv = {{100, 120}, {500.5, 300.25}, {0, 0}};
  seen.sigma = {0.1, 0.1, 0.1};
  GstBuffer* in = Fixture::noise("GRAY8", kSize, 0);
  gst::attach_observations(in, std::vector{seen});
  g_autoptr(GstBuffer) out = gst_harness_push_and_pull(f.h, in);
  const auto mapped = gst::read_observations(out);
  fail_unless_equals_int(mapped.size(), 1);
  fail_unless_equals_int(mapped[0].ids.size(), 2);  // the corner of the picture is cut off
  // The ray of each corner, through the camera that the element announces.
  const Camera source = camera_of(kBarrel);
  const Camera view = Camera::make(parse_calibration(output_calibration(f)).value()).value();
  for (std::size_t i = 0; i < 2; ++i) {
    const Pixel back = source.project(*view.unproject(mapped[0].uv[i])).value();
    fail_unless(std::hypot(back.u - seen.uv[i].u, back.v - seen.uv[i].v) < 1e-6);
  }
}
GST_END_TEST;

static GstVideoRegionOfInterestMeta* add_region(GstBuffer* buffer, int id, int parent, guint x,
                                                guint y, guint w, guint h) {
  auto* region = gst_buffer_add_video_region_of_interest_meta(buffer, "face", x, y, w, h);
  region->id = id;
  region->parent_id = parent;
  return region;
}

// Where a pixel of a source with the lens kBarrel is in the output, by going there in small steps.
static Pixel seen_at(const Camera& view, Pixel source) {
  Pixel at = source;
  for (int i = 0; i < 200; ++i) {
    const double x = (at.u - view.cx()) / view.fx();
    const double y = (at.v - view.cy()) / view.fy();
    const double r2 = x * x + y * y;
    const double g = 1 - 0.28 * r2 + 0.09 * r2 * r2;
    const double u = 480 * (x * g + 2 * 0.0005 * x * y - 0.0007 * (r2 + 2 * x * x)) + 325;
    const double v = 478 * (y * g + 0.0005 * (r2 + 2 * y * y) - 2 * 0.0007 * x * y) + 236;
    at.u += source.u - u;
    at.v += source.v - v;
  }
  return at;
}

static Camera view_of(Fixture& f) {
  return Camera::make(parse_calibration(output_calibration(f)).value()).value();
}

GST_START_TEST(test_regions_of_interest_follow_the_pixels) {
  Fixture f("calibundistort");
  g_object_set(f.element, "calibration", kBarrel, nullptr);
  f.set_caps("GRAY8", kSize);
  GstBuffer* in = Fixture::noise("GRAY8", kSize, 0);
  gst_video_region_of_interest_meta_add_param(
      add_region(in, 7, -1, 400, 300, 100, 80),
      gst_structure_new("detection", "confidence", G_TYPE_DOUBLE, 0.75, nullptr));
  add_region(in, 8, 7, 0, 0, 3, 3);      // cut off
  add_region(in, 9, 7, 0, 0, 640, 480);  // all there is
  g_autoptr(GstBuffer) out = gst_harness_push_and_pull(f.h, in);
  const Camera view = view_of(f);

  fail_unless_equals_int(gst_buffer_get_n_meta(out, GST_VIDEO_REGION_OF_INTEREST_META_API_TYPE), 2);
  const auto* region = gst_buffer_get_video_region_of_interest_meta_id(out, 7);
  fail_unless(region != nullptr);
  fail_unless_equals_int(region->parent_id, -1);
  fail_unless_equals_string(g_quark_to_string(region->roi_type), "face");
  // To the right of and below the centre of a barrel: the left edge bows least in the middle of the
  // picture and most in a corner, so the corners decide on the right and below.
  const Pixel corner = seen_at(view, {499.5, 379.5});
  fail_unless(std::abs(static_cast<int>(region->x + region->w) - (corner.u + 0.5)) <= 1);
  fail_unless(std::abs(static_cast<int>(region->y + region->h) - (corner.v + 0.5)) <= 1);
  double left = 1e9;
  double top = 1e9;
  for (int i = 0; i <= 100; ++i) {
    left = std::min(left, seen_at(view, {399.5, 299.5 + 0.8 * i}).u + 0.5);
    top = std::min(top, seen_at(view, {399.5 + i, 299.5}).v + 0.5);
  }
  fail_unless(std::abs(static_cast<int>(region->x) - left) <= 1);
  fail_unless(std::abs(static_cast<int>(region->y) - top) <= 1);
  double confidence = 0;
  const GstStructure* parameter = gst_video_region_of_interest_meta_get_param(
      const_cast<GstVideoRegionOfInterestMeta*>(region), "detection");
  fail_unless(parameter != nullptr);
  fail_unless(gst_structure_get_double(parameter, "confidence", &confidence));
  fail_unless(confidence == 0.75);

  const auto* all = gst_buffer_get_video_region_of_interest_meta_id(out, 9);
  fail_unless(all != nullptr && all->x == 0 && all->y == 0 && all->w == 640 && all->h == 480);
  fail_unless_equals_int(all->parent_id, 7);
}
GST_END_TEST;

GST_START_TEST(test_regions_of_interest_are_scaled_with_the_frames) {
  Fixture f("calibundistort ! capsfilter caps=video/x-raw,width=320,height=240");
  f.set_caps("GRAY8", kSize);
  GstBuffer* in = Fixture::noise("GRAY8", kSize, 0);
  add_region(in, 1, -1, 100, 60, 200, 80);
  g_autoptr(GstBuffer) out = gst_harness_push_and_pull(f.h, in);
  const auto* region = gst_buffer_get_video_region_of_interest_meta_id(out, 1);
  fail_unless(region != nullptr);
  fail_unless(std::abs(static_cast<int>(region->x) - 50) <= 1);
  fail_unless(std::abs(static_cast<int>(region->y) - 30) <= 1);
  fail_unless(std::abs(static_cast<int>(region->w) - 100) <= 1);
  fail_unless(std::abs(static_cast<int>(region->h) - 40) <= 1);
}
GST_END_TEST;

// Metas that speak of places in the picture, of which nothing is known here, would be wrong behind
// it; those that do not are kept.
GST_START_TEST(test_metas_that_would_be_stale_are_dropped) {
  static const char* kTags[][4] = {{GST_META_TAG_VIDEO_STR, GST_META_TAG_VIDEO_SIZE_STR, nullptr},
                                   {GST_META_TAG_VIDEO_STR, GST_META_TAG_VIDEO_ORIENTATION_STR},
                                   {GST_META_TAG_VIDEO_STR, nullptr},
                                   {nullptr}};
  static const char* const kNames[] = {"test-size", "test-orientation", "test-video", "test-none"};
  for (int i = 0; i < 4; ++i) {
    gst_meta_register_custom(kNames[i], kTags[i], nullptr, nullptr, nullptr);
  }
  Fixture f("calibundistort");
  f.set_caps("GRAY8", kSize);
  for (const bool undistort : {false, true}) {
    if (undistort) g_object_set(f.element, "calibration", kBarrel, nullptr);
    GstBuffer* in = Fixture::noise("GRAY8", kSize, 0);
    for (const char* name : kNames) gst_buffer_add_custom_meta(in, name);
    gst::attach_guidance(in, {});
    gst::attach_ground_truth(in, {});
    g_autoptr(GstBuffer) out = gst_harness_push_and_pull(f.h, in);
    for (int i = 0; i < 4; ++i) {
      const bool kept = gst_buffer_get_custom_meta(out, kNames[i]) != nullptr;
      fail_unless(kept == (!undistort || i >= 2), "%s", kNames[i]);
    }
    fail_unless(gst::read_guidance(out).has_value());
    fail_unless(gst::read_ground_truth(out).has_value() == !undistort);
  }
}
GST_END_TEST;

// The pointer event that comes out above for one sent in below.
static Pixel pointed_at(Fixture& f, GstEvent* event) {
  while (GstEvent* old = gst_harness_try_pull_upstream_event(f.h)) gst_event_unref(old);
  gst_harness_push_upstream_event(f.h, event);
  Pixel at = {-1, -1};
  while (GstEvent* up = gst_harness_try_pull_upstream_event(f.h)) {
    if (GST_EVENT_TYPE(up) == GST_EVENT_NAVIGATION) {
      gst_navigation_event_get_coordinates(up, &at.u, &at.v);
    }
    gst_event_unref(up);
  }
  return at;
}

GST_START_TEST(test_the_pointer_is_where_the_camera_saw_it) {
  Fixture f("calibundistort");
  f.set_caps("GRAY8", kSize);
  gst_buffer_unref(f.push(kSize, 0));
  Pixel at =
      pointed_at(f, gst_navigation_event_new_mouse_move(100, 50, GST_NAVIGATION_MODIFIER_NONE));
  fail_unless(at.u == 100 && at.v == 50);

  g_object_set(f.element, "calibration", kBarrel, "alpha", 1.0, nullptr);
  gst_buffer_unref(f.push(kSize, 1));
  const Camera view = view_of(f);
  for (const Pixel source : {Pixel{40, 60}, Pixel{500.25, 300}, Pixel{325, 236}}) {
    const Pixel shown = seen_at(view, source);
    GstEvent* const events[] = {gst_navigation_event_new_mouse_move(shown.u + 0.5, shown.v + 0.5,
                                                                    GST_NAVIGATION_MODIFIER_NONE),
                                gst_navigation_event_new_mouse_button_press(
                                    1, shown.u + 0.5, shown.v + 0.5, GST_NAVIGATION_MODIFIER_NONE),
                                gst_navigation_event_new_touch_up(3, shown.u + 0.5, shown.v + 0.5,
                                                                  GST_NAVIGATION_MODIFIER_NONE)};
    for (GstEvent* event : events) {
      at = pointed_at(f, event);
      fail_unless(std::hypot(at.u - 0.5 - source.u, at.v - 0.5 - source.v) < 1e-6);
    }
  }
  // Where the output is black: at the border, on the same side.
  at = pointed_at(
      f, gst_navigation_event_new_mouse_button_release(1, 320, 0.5, GST_NAVIGATION_MODIFIER_NONE));
  fail_unless(std::abs(at.v) < 0.01 && std::abs(at.u - 320) < 20);
  // A key has no place.
  at = pointed_at(f, gst_navigation_event_new_key_press("a", GST_NAVIGATION_MODIFIER_NONE));
  fail_unless(at.u == -1);
}
GST_END_TEST;

GST_START_TEST(test_the_pointer_is_scaled_with_the_frames) {
  Fixture f("calibundistort ! capsfilter caps=video/x-raw,width=320,height=240");
  f.set_caps("GRAY8", kSize);
  gst_buffer_unref(f.push(kSize, 0));
  const Pixel at =
      pointed_at(f, gst_navigation_event_new_mouse_move(80, 60, GST_NAVIGATION_MODIFIER_NONE));
  fail_unless(std::abs(at.u - 160) < 0.5 && std::abs(at.v - 120) < 0.5, "%f %f", at.u, at.v);
}
GST_END_TEST;

static Suite* calibundistort_metas_suite() {
  Suite* suite = suite_create("calibundistort_metas");
  TCase* tc = tcase_create("general");
  tcase_add_test(tc, test_corners_follow_the_pixels);
  tcase_add_test(tc, test_regions_of_interest_follow_the_pixels);
  tcase_add_test(tc, test_regions_of_interest_are_scaled_with_the_frames);
  tcase_add_test(tc, test_metas_that_would_be_stale_are_dropped);
  tcase_add_test(tc, test_the_pointer_is_where_the_camera_saw_it);
  tcase_add_test(tc, test_the_pointer_is_scaled_with_the_frames);
  suite_add_tcase(suite, tc);
  return suite;
}

GST_CHECK_MAIN(calibundistort_metas)
