// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibundistort: sizes and shapes of frames, on both sides of it.

#include "undistort_fixture.hpp"

#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>

using namespace calvin;
using namespace calvin::check;

GST_START_TEST(test_another_size_is_scaled_and_another_aspect_refused) {
  Fixture f("calibundistort");
  g_object_set(f.element, "calibration", kBarrel, nullptr);
  for (const ImageSize size : {kSize, ImageSize{320, 240}, ImageSize{1280, 960}}) {
    f.set_caps("GRAY8", size);
    for (int n = 0; n < 2; ++n) {
      g_autoptr(GstBuffer) out = f.push(size, n);
      fail_unless(gray_of(out, size) == expected_gray(kBarrel, size));
    }
    const Calibration out = parse_calibration(output_calibration(f)).value();
    fail_unless(out.image_size == size);
  }
  const auto warnings = f.bus.texts(GST_MESSAGE_WARNING);
  fail_unless_equals_int(warnings.size(), 2);
  fail_unless(warnings[0].find("320x240") != std::string::npos);
  fail_unless(warnings[1].find("1280x960") != std::string::npos);

  f.set_caps("GRAY8", {640, 360});
  GstBuffer* in = Fixture::noise("GRAY8", {640, 360}, 3);
  g_autoptr(GstBuffer) out = gst_harness_push_and_pull(f.h, in);
  fail_unless(in == out);
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "another aspect"));
  fail_unless(output_calibration(f).empty());

  f.set_caps("GRAY8", kSize);
  g_autoptr(GstBuffer) again = f.push(kSize, 4);
  fail_unless(gray_of(again, kSize) == expected_gray(kBarrel, kSize));
}
GST_END_TEST;

GST_START_TEST(test_a_sensor_crop_says_what_the_frames_show) {
  // The middle of what was calibrated, at twice the resolution.
  Calibration calibration = calibration_of(kBarrel);
  calibration.sensor_crop = Rectangle{40, 60, 560, 315};
  const std::string json = print_calibration(calibration).value();
  Fixture f("calibundistort");
  g_object_set(f.element, "calibration", json.c_str(), nullptr);
  const ImageSize size = {1120, 630};
  f.set_caps("GRAY8", size);
  g_autoptr(GstBuffer) out = f.push(size);
  static const char kSame[] =
      "fx=960,fy=956,cx=570.5,cy=352.5,k1=-0.28,k2=0.09,p1=0.0005,p2=-0.0007,width=1120,height=630";
  fail_unless(gray_of(out, size) == expected_gray(kSame, size));
  fail_unless_equals_int(f.bus.texts(GST_MESSAGE_WARNING).size(), 1);
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "sensor_crop"));
  // What is not the cropped shape is refused.
  f.set_caps("GRAY8", kSize);
  GstBuffer* in = Fixture::noise("GRAY8", kSize, 1);
  g_autoptr(GstBuffer) same = gst_harness_push_and_pull(f.h, in);
  fail_unless(in == same);
  fail_unless(f.bus.says(GST_MESSAGE_WARNING,
                         "sensor_crop of the calibration is a part of 560x315 px of its picture of "
                         "640x480, the frames are 640x480: another aspect"));
}
GST_END_TEST;

// A grey gradient that tells where each pixel of the picture comes from: 0.3 per column, 0.1 per
// row.
static GstBuffer* gradient(ImageSize size, int n) {
  GrayImage image(size.width, size.height);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      image.row(y)[x] = static_cast<guint8>(std::lround(0.3 * x + 0.1 * y));
    }
  }
  return frame_of(image, "GRAY8", n);
}

static ImageSize size_out(Fixture& f) {
  g_autoptr(GstCaps) caps = gst_pad_get_current_caps(f.h->sinkpad);
  ImageSize size;
  const GstStructure* s = gst_caps_get_structure(caps, 0);
  gst_structure_get_int(s, "width", &size.width);
  gst_structure_get_int(s, "height", &size.height);
  return size;
}

// What is in front of, behind and between, and the size that comes out for 640x480.
static const struct {
  const char* behind;
  ImageSize out;
} kNegotiated[] = {
    {"video/x-raw", {640, 480}},
    {"video/x-raw,width=[1,1000],height=[1,1000]", {640, 480}},
    {"video/x-raw,width=320,height=240", {320, 240}},
    {"video/x-raw,width=320", {320, 240}},
    {"video/x-raw,height=240", {320, 240}},
    {"video/x-raw,width=[1,320],height=[1,1000]", {320, 240}},
    {"video/x-raw,width=[800,1000],height=[600,1000]", {800, 600}},
    {"video/x-raw,width=300,height=480", {300, 480}},
    {"video/x-raw,width=1280,height=480;video/x-raw,width=640,height=480", {640, 480}},
};

GST_START_TEST(test_the_size_of_the_input_is_preferred_and_then_its_aspect) {
  const auto& [behind, out] = kNegotiated[__i__];
  Fixture f((std::string("calibundistort ! capsfilter caps=") + behind).c_str());
  gst_harness_set_src_caps_str(
      f.h, "video/x-raw,format=GRAY8,width=640,height=480,framerate=25/1,pixel-aspect-ratio=8/9");
  GstBuffer* in = gradient(kSize, 0);
  g_autoptr(GstBuffer) buffer = gst_harness_push_and_pull(f.h, in);
  fail_unless(size_out(f) == out, "%dx%d", size_out(f).width, size_out(f).height);
  fail_unless((buffer == in) == (out == kSize));
  // Pixels keep their shape.
  g_autoptr(GstCaps) caps = gst_pad_get_current_caps(f.h->sinkpad);
  int n = 0;
  int d = 0;
  gst_structure_get_fraction(gst_caps_get_structure(caps, 0), "pixel-aspect-ratio", &n, &d);
  fail_unless(n == 8 && d == 9);
}
GST_END_TEST;

// What comes out for 640x480 where elements behind change the size: they do it once.
static const struct {
  const char* behind;
  ImageSize out;
} kChangedBehind[] = {
    {"videocrop left=100", {540, 480}},
    {"videocrop left=100 right=100 top=60 bottom=60", {440, 360}},
    {"videobox left=-100", {740, 480}},
    {"videoflip video-direction=90r", {480, 640}},
    {"videoscale ! capsfilter caps=video/x-raw,width=320,height=240", {320, 240}},
    {"videocrop left=100 ! capsfilter caps=video/x-raw,width=440,height=480", {440, 480}},
};

GST_START_TEST(test_a_change_of_size_behind_counts_once) {
  const auto& [behind, out] = kChangedBehind[__i__];
  const std::string line = behind;
  g_autoptr(GstElementFactory) factory =
      gst_element_factory_find(line.substr(0, line.find(' ')).c_str());
  if (factory == nullptr) return;
  for (const char* set : {"", "calibration=fx=480,fy=480,cx=320,cy=240,k1=-0.2"}) {
    Fixture f((std::string("calibundistort ") + set + " ! " + line).c_str());
    f.set_caps("I420", kSize);
    g_autoptr(GstBuffer) buffer = gst_harness_push_and_pull(f.h, Fixture::noise("I420", kSize, 1));
    fail_unless(size_out(f) == out, "%dx%d", size_out(f).width, size_out(f).height);
  }
}
GST_END_TEST;

// One factor both ways, the middle in the middle, and the frame is full.
static void check_scaled(GstBuffer* buffer, ImageSize out, int row_step) {
  const auto picture = gray_of(buffer, out);
  const double factor = std::min(639.0 / (out.width - 1), 479.0 / (out.height - 1));
  for (int y = 0; y < out.height; y += row_step) {
    for (int x = 0; x < out.width; ++x) {
      const double u = 319.5 + factor * (x - (out.width - 1) / 2.0);
      const double v = 239.5 + factor * (y - (out.height - 1) / 2.0);
      const double got = picture[static_cast<std::size_t>(y * out.width + x)];
      fail_unless(std::abs(got - (0.3 * u + 0.1 * v)) <= 1.01, "%d, %d", x, y);
    }
  }
}

static const ImageSize kSizes[] = {{320, 240}, {641, 481}, {1280, 960}, {200, 480}, {640, 100}};

GST_START_TEST(test_without_a_calibration_another_size_is_scaled) {
  const ImageSize size = kSizes[__i__];
  const std::string behind =
      "calibundistort ! capsfilter caps=video/x-raw,width=" + std::to_string(size.width) +
      ",height=" + std::to_string(size.height);
  Fixture f(behind.c_str());
  f.set_caps("GRAY8", kSize);
  g_autoptr(GstBuffer) none = gst_harness_push_and_pull(f.h, gradient(kSize, 0));
  check_scaled(none, size, 1);
  fail_unless(events_out(f).empty() && output_calibration(f).empty());
  fail_unless(f.bus.texts(GST_MESSAGE_WARNING).empty());
  // Neither is there one to be used, here.
  g_object_set(f.element, "calibration", kBarrel, "enabled", FALSE, nullptr);
  g_autoptr(GstBuffer) off = gst_harness_push_and_pull(f.h, gradient(kSize, 1));
  check_scaled(off, size, 7);
}
GST_END_TEST;

GST_START_TEST(test_with_a_calibration_of_another_aspect_it_is_scaled_too) {
  Fixture f("calibundistort ! capsfilter caps=video/x-raw,width=320,height=240");
  g_object_set(f.element, "calibration", "fx=500,fy=500,cx=320,cy=180,width=640,height=360",
               nullptr);
  f.set_caps("GRAY8", kSize);
  g_autoptr(GstBuffer) out = gst_harness_push_and_pull(f.h, gradient(kSize, 2));
  check_scaled(out, {320, 240}, 1);
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "another aspect"));
}
GST_END_TEST;

// px of a pinhole -> px of the lens kBarrel.
static Pixel source_of(const Camera& view, double u, double v) {
  const double x = (u - view.cx()) / view.fx();
  const double y = (v - view.cy()) / view.fy();
  const double r2 = x * x + y * y;
  const double g = 1 - 0.28 * r2 + 0.09 * r2 * r2;
  return {480 * (x * g + 2 * 0.0005 * x * y - 0.0007 * (r2 + 2 * x * x)) + 325,
          478 * (y * g + 0.0005 * (r2 + 2 * y * y) - 2 * 0.0007 * x * y) + 236};
}

GST_START_TEST(test_the_view_is_rendered_at_the_size_of_the_output) {
  const ImageSize size = kSizes[__i__];
  const std::string behind =
      "calibundistort ! capsfilter caps=video/x-raw,width=" + std::to_string(size.width) +
      ",height=" + std::to_string(size.height);
  Fixture f(behind.c_str());
  g_object_set(f.element, "calibration", kBarrel, nullptr);
  f.set_caps("GRAY8", kSize);
  g_autoptr(GstBuffer) out = gst_harness_push_and_pull(f.h, gradient(kSize, 0));
  const Camera view = Camera::make(parse_calibration(output_calibration(f)).value()).value();
  fail_unless(view.image_size() == size);
  fail_unless(std::abs(view.fx() / view.fy() - 480.0 / 478) < 1e-9);
  const auto picture = gray_of(out, size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const Pixel at = source_of(view, x, y);
      fail_unless(std::min({at.u, at.v, 639 - at.u, 479 - at.v}) > -0.01);
      const double got = picture[static_cast<std::size_t>(y * size.width + x)];
      fail_unless(std::abs(got - (0.3 * at.u + 0.1 * at.v)) <= 1.01, "%d, %d", x, y);
    }
  }
}
GST_END_TEST;

GST_START_TEST(test_a_scaled_picture_goes_on_with_its_calibration) {
  Fixture f("calibundistort enabled=false ! capsfilter caps=video/x-raw,width=320,height=480");
  f.set_caps("GRAY8", kSize);
  gst_harness_push_event(f.h, event_of(kBarrel));
  gst_buffer_unref(gst_harness_push_and_pull(f.h, gradient(kSize, 0)));
  auto events = events_out(f);
  fail_unless_equals_int(events.size(), 1);
  const Calibration told = parse_calibration(events[0].json).value();
  fail_unless_equals_string(told.model.c_str(), "brown4");
  fail_unless(told.image_size == (ImageSize{320, 480}));
  // As high as before, and 160 columns cut off on either side.
  fail_unless(std::abs(told.find("fx")->value - 480) < 1e-6);
  fail_unless(std::abs(told.find("fy")->value - 478) < 1e-6);
  fail_unless(std::abs(told.find("cx")->value - (325 - 160)) < 1e-6);
  fail_unless(std::abs(told.find("cy")->value - 236) < 1e-6);
  fail_unless(told.find("p2")->value == -0.0007);

  // On: a pinhole. Off again: as before.
  g_object_set(f.element, "enabled", TRUE, nullptr);
  gst_buffer_unref(gst_harness_push_and_pull(f.h, gradient(kSize, 1)));
  g_object_set(f.element, "enabled", FALSE, nullptr);
  gst_buffer_unref(gst_harness_push_and_pull(f.h, gradient(kSize, 2)));
  events = events_out(f);
  fail_unless_equals_int(events.size(), 2);
  const auto pinhole = parse_calibration(events[0].json);
  fail_unless_equals_string(pinhole->model.c_str(), "pinhole");
  fail_unless(parse_calibration(events[1].json)->find("cx")->value == told.find("cx")->value);
}
GST_END_TEST;

GST_START_TEST(test_the_output_may_change_its_size_while_running) {
  Fixture f("calibundistort ! capsfilter name=behind caps=video/x-raw");
  g_object_set(f.element, "calibration", kBarrel, nullptr);
  f.set_caps("GRAY8", kSize);
  GstElement* behind = gst_bin_get_by_name(GST_BIN(f.h->element), "behind");
  int n = 0;
  for (const ImageSize size : {ImageSize{640, 480}, ImageSize{320, 240}, ImageSize{500, 480},
                               ImageSize{640, 480}, ImageSize{1280, 960}}) {
    g_autoptr(GstCaps) caps = gst_caps_new_simple("video/x-raw", "width", G_TYPE_INT, size.width,
                                                  "height", G_TYPE_INT, size.height, nullptr);
    g_object_set(behind, "caps", caps, nullptr);
    for (int i = 0; i < 2; ++i) {
      g_autoptr(GstBuffer) out = gst_harness_push_and_pull(f.h, gradient(kSize, n++));
      fail_unless(size_out(f) == size);
      const auto picture = gray_of(out, size);
      const Camera view = Camera::make(parse_calibration(output_calibration(f)).value()).value();
      fail_unless(view.image_size() == size);
      for (int x = 0; x < size.width; x += 5) {
        const Pixel at = source_of(view, x, 7);
        const double got = picture[static_cast<std::size_t>(7 * size.width + x)];
        fail_unless(std::abs(got - (0.3 * at.u + 0.1 * at.v)) <= 1.01);
      }
    }
  }
  fail_unless(f.bus.texts(GST_MESSAGE_WARNING).empty());
  gst_object_unref(behind);
}
GST_END_TEST;

// Without colorimetry and siting in the caps the number of lines decides on them: where it changes,
// they are said.
GST_START_TEST(test_colours_keep_their_meaning_in_another_size) {
  const ImageSize large = {1280, 720};
  const ImageSize small = {854, 480};
  const bool grows = __i__ == 1;
  const char* site = __i__ == 0 ? "mpeg2" : "jpeg";
  Fixture f(grows ? "calibundistort ! capsfilter caps=video/x-raw,width=1280,height=720"
                  : "calibundistort ! capsfilter caps=video/x-raw,width=854,height=480");
  GstCaps* in = check::caps_of("I420", grows ? small : large);
  // One that the lines of the output would say too.
  if (__i__ == 2) gst_caps_set_simple(in, "chroma-site", G_TYPE_STRING, site, nullptr);
  gst_harness_set_src_caps(f.h, in);
  gst_buffer_unref(
      gst_harness_push_and_pull(f.h, Fixture::noise("I420", grows ? small : large, 0)));
  g_autoptr(GstCaps) caps = gst_pad_get_current_caps(f.h->sinkpad);
  const GstStructure* s = gst_caps_get_structure(caps, 0);
  fail_unless_equals_string(gst_structure_get_string(s, "colorimetry"), grows ? "bt601" : "bt709");
  fail_unless_equals_string(gst_structure_get_string(s, "chroma-site"), site);
}
GST_END_TEST;

GST_START_TEST(test_late_frames_are_left_out) {
  Fixture f("calibundistort");
  g_object_set(f.element, "calibration", kBarrel, nullptr);
  f.set_caps("GRAY8", kSize);
  gst_buffer_unref(f.push(kSize, 0));
  gst_harness_push_upstream_event(f.h,
                                  gst_event_new_qos(GST_QOS_TYPE_UNDERFLOW, 2.0, GST_SECOND, 0));
  const guint before = gst_harness_buffers_received(f.h);
  gst_harness_push(f.h, Fixture::noise("GRAY8", kSize, 1));
  fail_unless_equals_int(gst_harness_buffers_received(f.h), before);
  gst_harness_push(f.h, Fixture::noise("GRAY8", kSize, 100));
  fail_unless_equals_int(gst_harness_buffers_received(f.h), before + 1);
}
GST_END_TEST;

static Suite* calibundistort_sizes_suite() {
  Suite* suite = suite_create("calibundistort_sizes");
  TCase* tc = tcase_create("general");
  const int sizes = static_cast<int>(std::size(kSizes));
  const int negotiated = static_cast<int>(std::size(kNegotiated));
  const int behind = static_cast<int>(std::size(kChangedBehind));
  tcase_add_loop_test(tc, test_a_change_of_size_behind_counts_once, 0, behind);
  tcase_add_test(tc, test_another_size_is_scaled_and_another_aspect_refused);
  tcase_add_test(tc, test_a_sensor_crop_says_what_the_frames_show);
  tcase_add_loop_test(tc, test_the_size_of_the_input_is_preferred_and_then_its_aspect, 0,
                      negotiated);
  tcase_add_loop_test(tc, test_without_a_calibration_another_size_is_scaled, 0, sizes);
  tcase_add_test(tc, test_with_a_calibration_of_another_aspect_it_is_scaled_too);
  tcase_add_loop_test(tc, test_the_view_is_rendered_at_the_size_of_the_output, 0, sizes);
  tcase_add_test(tc, test_a_scaled_picture_goes_on_with_its_calibration);
  tcase_add_test(tc, test_the_output_may_change_its_size_while_running);
  tcase_add_loop_test(tc, test_colours_keep_their_meaning_in_another_size, 0, 3);
  tcase_add_test(tc, test_late_frames_are_left_out);
  suite_add_tcase(suite, tc);
  return suite;
}

GST_CHECK_MAIN(calibundistort_sizes)
