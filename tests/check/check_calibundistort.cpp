// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibundistort: which calibration is in force when, and what downstream hears of it.

#include <chrono>
#include <fstream>
#include <thread>

#include "calibration_event.hpp"
#include "calvin/io/calibration_io.hpp"
#include "undistort_fixture.hpp"

#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>

using namespace calvin;
using check::calibration_of;
using check::Fixture;
using check::kBarrel;
using check::kSize;

static const char kPincushion[] =
    "fx=480,fy=478,cx=325,cy=236,k1=0.1,k2=0,p1=0,p2=0,width=640,height=480";

static Camera camera_of(const char* text) { return Camera::make(calibration_of(text)).value(); }
static std::string json_of(const char* text) {
  Calibration calibration = calibration_of(text);
  calibration.camera = "left";
  return print_calibration(calibration).value();
}
static GstEvent* event_of(const char* text) {
  return gst::new_calibration_event({"left", json_of(text)});
}

// What the library makes of the grey noise.
static std::vector<guint8> expected_gray(const char* text, ImageSize size, double alpha = 0) {
  const Camera source = fit_to_frame(calibration_of(text), size)->camera;
  const auto undistorter = Undistorter::make(source, {alpha, {}}, {PlaneLayout{}}).value();
  g_autoptr(GstBuffer) in = Fixture::noise("GRAY8", size, 0);
  GstVideoInfo info;
  gst_video_info_set_format(&info, GST_VIDEO_FORMAT_GRAY8, static_cast<guint>(size.width),
                            static_cast<guint>(size.height));
  GstMapInfo map;
  gst_buffer_map(in, &map, GST_MAP_READ);
  std::vector<guint8> out(static_cast<std::size_t>(size.width * size.height));
  undistorter.apply(0, {map.data, info.stride[0]}, {out.data(), size.width});
  gst_buffer_unmap(in, &map);
  return out;
}

// The pixels of a grey frame without padding.
static std::vector<guint8> gray_of(GstBuffer* buffer, ImageSize size) {
  GstVideoInfo info;
  gst_video_info_set_format(&info, GST_VIDEO_FORMAT_GRAY8, static_cast<guint>(size.width),
                            static_cast<guint>(size.height));
  GstVideoFrame frame;
  fail_unless(gst_video_frame_map(&frame, &info, buffer, GST_MAP_READ));
  std::vector<guint8> pixels;
  for (int y = 0; y < size.height; ++y) {
    const auto* row = static_cast<const guint8*>(GST_VIDEO_FRAME_PLANE_DATA(&frame, 0)) +
                      static_cast<std::ptrdiff_t>(y) * GST_VIDEO_FRAME_PLANE_STRIDE(&frame, 0);
    pixels.insert(pixels.end(), row, row + size.width);
  }
  gst_video_frame_unmap(&frame);
  return pixels;
}

static std::string output_calibration(const Fixture& f) {
  g_autofree gchar* text = nullptr;
  g_object_get(f.element, "output-calibration", &text, nullptr);
  return text != nullptr ? text : "";
}

// The calibration events that came out since the last call.
static std::vector<gst::CalibrationEvent> events_out(Fixture& f) {
  std::vector<gst::CalibrationEvent> all;
  while (GstEvent* event = gst_harness_try_pull_event(f.h)) {
    if (auto calibration = gst::parse_calibration_event(event)) all.push_back(*calibration);
    gst_event_unref(event);
  }
  return all;
}

GST_START_TEST(test_without_a_calibration_the_buffer_passes_through) {
  Fixture f(__i__ == 0 ? "calibundistort" : "calibundistort enabled=false");
  if (__i__ == 1) g_object_set(f.element, "calibration", kBarrel, nullptr);
  f.set_caps("GRAY8", kSize);
  GstBuffer* in = Fixture::noise("GRAY8", kSize, 0);
  g_autoptr(GstBuffer) out = gst_harness_push_and_pull(f.h, in);
  fail_unless(in == out);
  fail_unless(output_calibration(f).empty());
  fail_unless(events_out(f).empty());
  fail_unless(f.bus.texts(GST_MESSAGE_WARNING).empty());
}
GST_END_TEST;

GST_START_TEST(test_an_event_undistorts_and_goes_on_as_a_pinhole) {
  Fixture f("calibundistort");
  int notified = 0;
  g_signal_connect_swapped(f.element, "notify::output-calibration",
                           G_CALLBACK(+[](int* count) { ++*count; }), &notified);
  f.set_caps("GRAY8", kSize);
  g_autoptr(GstBuffer) before = f.push(kSize, 0);
  fail_if(gray_of(before, kSize) == expected_gray(kBarrel, kSize));
  fail_unless(gst_harness_push_event(f.h, event_of(kBarrel)));
  g_autoptr(GstBuffer) after = f.push(kSize, 1);
  fail_unless(gray_of(after, kSize) == expected_gray(kBarrel, kSize));

  const auto events = events_out(f);
  fail_unless_equals_int(events.size(), 1);
  fail_unless_equals_string(events[0].camera.c_str(), "left");
  fail_unless(events[0].json == output_calibration(f));
  fail_unless_equals_int(notified, 1);
  const Calibration out = parse_calibration(events[0].json).value();
  const Camera want = output_camera(camera_of(kBarrel), {}).value();
  fail_unless_equals_string(out.model.c_str(), "pinhole");
  fail_unless_equals_string(out.camera.c_str(), "left");
  fail_unless(Camera::make(out)->parameters() == want.parameters());

  // "The frames have no calibration any more."
  gst_harness_push_event(f.h, gst::new_calibration_event({"left", ""}));
  g_autoptr(GstBuffer) last = f.push(kSize, 2);
  fail_if(gray_of(last, kSize) == expected_gray(kBarrel, kSize));
  fail_unless(output_calibration(f).empty());
}
GST_END_TEST;

GST_START_TEST(test_an_event_before_the_caps_waits_for_them) {
  Fixture f("calibundistort");
  gst_harness_push_event(f.h, gst_event_new_stream_start("one"));
  gst_harness_push_event(f.h, event_of(kBarrel));
  f.set_caps("GRAY8", kSize);
  g_autoptr(GstBuffer) out = f.push(kSize);
  fail_unless(gray_of(out, kSize) == expected_gray(kBarrel, kSize));
  fail_unless_equals_int(events_out(f).size(), 1);
}
GST_END_TEST;

GST_START_TEST(test_a_second_one_does_not_undo_twice) {
  Fixture f("calibundistort name=a ! calibundistort name=b");
  f.set_caps("GRAY8", kSize);
  gst_harness_push_event(f.h, event_of(kBarrel));
  g_autoptr(GstBuffer) out = f.push(kSize);
  fail_unless(gray_of(out, kSize) == expected_gray(kBarrel, kSize));
}
GST_END_TEST;

GST_START_TEST(test_the_event_of_cameracalibrate_is_understood) {
  static const char kSettings[] =
      "<?xml version=\"1.0\"?><opencv_storage><cameraMatrix type_id=\"opencv-matrix\">"
      "<rows>3</rows><cols>3</cols><dt>d</dt><data>480. 0. 325. 0. 478. 236. 0. 0. 1.</data>"
      "</cameraMatrix><distCoeffs type_id=\"opencv-matrix\"><rows>5</rows><cols>1</cols><dt>d</dt>"
      "<data>-0.28 0.09 0.0005 -0.0007 0.</data></distCoeffs></opencv_storage>";
  Fixture f("calibundistort");
  f.set_caps("GRAY8", kSize);
  gst_harness_push_event(
      f.h, gst_event_new_custom(GST_EVENT_CUSTOM_BOTH,
                                gst_structure_new("GstEventCalibrated", "undistort-settings",
                                                  G_TYPE_STRING, kSettings, nullptr)));
  g_autoptr(GstBuffer) out = f.push(kSize);
  fail_unless(gray_of(out, kSize) == expected_gray(kBarrel, kSize));
  fail_unless_equals_int(events_out(f).size(), 1);
}
GST_END_TEST;

GST_START_TEST(test_the_property_beats_the_event) {
  Fixture f("calibundistort");
  g_object_set(f.element, "calibration", kPincushion, nullptr);
  f.set_caps("GRAY8", kSize);
  gst_harness_push_event(f.h, event_of(kBarrel));
  g_autoptr(GstBuffer) first = f.push(kSize, 0);
  fail_unless(gray_of(first, kSize) == expected_gray(kPincushion, kSize));
  g_object_set(f.element, "calibration", nullptr, nullptr);
  g_autoptr(GstBuffer) second = f.push(kSize, 1);
  fail_unless(gray_of(second, kSize) == expected_gray(kBarrel, kSize));
}
GST_END_TEST;

GST_START_TEST(test_disabled_it_forwards_the_event_untouched) {
  Fixture f("calibundistort enabled=false");
  f.set_caps("GRAY8", kSize);
  gst_harness_push_event(f.h, event_of(kBarrel));
  auto events = events_out(f);
  fail_unless_equals_int(events.size(), 1);
  fail_unless(events[0].json == json_of(kBarrel));

  // On and off again: downstream always knows what the frames are.
  g_object_set(f.element, "enabled", TRUE, nullptr);
  gst_buffer_unref(f.push(kSize, 0));
  events = events_out(f);
  fail_unless_equals_int(events.size(), 1);
  fail_unless(events[0].json.find("pinhole") != std::string::npos);
  g_object_set(f.element, "enabled", FALSE, nullptr);
  GstBuffer* in = Fixture::noise("GRAY8", kSize, 1);
  g_autoptr(GstBuffer) off = gst_harness_push_and_pull(f.h, in);
  fail_unless(in == off);
  events = events_out(f);
  fail_unless_equals_int(events.size(), 1);
  fail_unless(events[0].json == json_of(kBarrel));
}
GST_END_TEST;

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

GST_START_TEST(test_interlaced_video_passes_with_a_warning) {
  Fixture f("calibundistort");
  g_object_set(f.element, "calibration", kBarrel, nullptr);
  gst_harness_set_src_caps_str(f.h,
                               "video/x-raw,format=GRAY8,width=640,height=480,framerate=25/1,"
                               "interlace-mode=interleaved");
  GstBuffer* in = Fixture::noise("GRAY8", kSize, 0);
  g_autoptr(GstBuffer) out = gst_harness_push_and_pull(f.h, in);
  fail_unless(in == out);
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "deinterlace"));
}
GST_END_TEST;

static const char* const kBroken[] = {"{\"format\": ", "<?xml version=\"1.0\"?><a/>",
                                      "fx=-1,fy=1,cx=1,cy=1,width=640,height=480",
                                      "fx=nan,fy=1,cx=1,cy=1", "%YAML:1.0\n---\n"};

GST_START_TEST(test_an_unreadable_calibration_is_an_error_at_the_start) {
  GstElement* element = gst_element_factory_make("calibundistort", nullptr);
  gst_object_ref_sink(element);
  {
    check::Bus bus(element);
    g_object_set(element, "calibration", kBroken[__i__], nullptr);
    fail_unless(gst_element_set_state(element, GST_STATE_PAUSED) == GST_STATE_CHANGE_FAILURE);
    fail_unless_equals_int(bus.texts(GST_MESSAGE_ERROR).size(), 1);
    // It is fit for use again as soon as it has a good one.
    g_object_set(element, "calibration", kBarrel, nullptr);
    fail_if(gst_element_set_state(element, GST_STATE_PAUSED) == GST_STATE_CHANGE_FAILURE);
    gst_element_set_state(element, GST_STATE_NULL);
    bus.detach();
  }
  gst_object_unref(element);
}
GST_END_TEST;

GST_START_TEST(test_an_unreadable_calibration_while_running_is_a_warning) {
  Fixture f("calibundistort");
  g_object_set(f.element, "calibration", kBarrel, nullptr);
  f.set_caps("GRAY8", kSize);
  gst_buffer_unref(f.push(kSize, 0));
  g_object_set(f.element, "calibration", kBroken[__i__], nullptr);
  g_autoptr(GstBuffer) second = f.push(kSize, 1);
  fail_unless(gray_of(second, kSize) == expected_gray(kBarrel, kSize));
  fail_unless_equals_int(f.bus.texts(GST_MESSAGE_WARNING).size(), 1);
  fail_unless(f.bus.texts(GST_MESSAGE_ERROR).empty());
}
GST_END_TEST;

// Pushes frames, one every 20 ms, until one looks as `want`; false after ten seconds.
static bool comes_to(Fixture& f, const std::vector<guint8>& want, int& n) {
  for (int i = 0; i < 500; ++i) {
    g_autoptr(GstBuffer) out = f.push(kSize, n++);
    if (gray_of(out, kSize) == want) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return false;
}

GST_START_TEST(test_a_file_is_taken_in_when_it_appears_and_when_it_is_replaced) {
  check::TemporaryFolder folder;
  const std::string path = folder / "cam.json";
  Fixture f("calibundistort", __i__ == 1);
  g_object_set(f.element, "calibration", path.c_str(), nullptr);
  f.set_caps("GRAY8", kSize);
  int n = 0;
  GstBuffer* in = Fixture::noise("GRAY8", kSize, n++);
  g_autoptr(GstBuffer) out = gst_harness_push_and_pull(f.h, in);
  fail_unless(in == out);
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "cam.json"));

  fail_unless(write_calibration(path, calibration_of(kBarrel)).has_value());
  fail_unless(comes_to(f, expected_gray(kBarrel, kSize), n));
  fail_unless(write_calibration(path, calibration_of(kPincushion)).has_value());
  fail_unless(comes_to(f, expected_gray(kPincushion, kSize), n));

  // A broken replacement is heard of and changes nothing.
  const auto before = f.bus.texts(GST_MESSAGE_WARNING).size();
  std::ofstream(path) << "{\"format\": \"calvin-cal";
  for (int i = 0; i < 500 && f.bus.texts(GST_MESSAGE_WARNING).size() == before; ++i) {
    g_autoptr(GstBuffer) frame = f.push(kSize, n++);
    fail_unless(gray_of(frame, kSize) == expected_gray(kPincushion, kSize));
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  fail_unless_equals_int(f.bus.texts(GST_MESSAGE_WARNING).size(), before + 1);
  std::filesystem::remove(path);
  fail_unless(write_calibration(path, calibration_of(kBarrel)).has_value());
  fail_unless(comes_to(f, expected_gray(kBarrel, kSize), n));
}
GST_END_TEST;

GST_START_TEST(test_a_change_is_exact_to_the_frame_where_nothing_is_live) {
  Fixture f("calibundistort");
  g_object_set(f.element, "calibration", kBarrel, nullptr);
  f.set_caps("GRAY8", kSize);
  for (int n = 0; n < 6; ++n) {
    const double alpha = n / 5.0;
    const char* text = n % 2 == 0 ? kBarrel : kPincushion;
    g_object_set(f.element, "alpha", alpha, "calibration", text, nullptr);
    g_autoptr(GstBuffer) out = f.push(kSize, n);
    fail_unless(gray_of(out, kSize) == expected_gray(text, kSize, alpha));
  }
}
GST_END_TEST;

GST_START_TEST(test_a_change_in_a_live_stream_shows_no_third_picture) {
  Fixture f("calibundistort", true);
  g_object_set(f.element, "calibration", kBarrel, nullptr);
  f.set_caps("GRAY8", kSize);
  const auto old_picture = expected_gray(kBarrel, kSize);
  const auto new_picture = expected_gray(kPincushion, kSize, 1);
  g_autoptr(GstBuffer) first = f.push(kSize, 0);
  fail_unless(gray_of(first, kSize) == old_picture);
  g_object_set(f.element, "calibration", kPincushion, "alpha", 1.0, nullptr);
  bool switched = false;
  for (int n = 1; n < 1000 && !switched; ++n) {
    g_autoptr(GstBuffer) out = f.push(kSize, n);
    const auto picture = gray_of(out, kSize);
    switched = picture == new_picture;
    fail_unless(switched || picture == old_picture);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  fail_unless(switched);
}
GST_END_TEST;

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

GST_START_TEST(test_a_board_is_where_the_announced_camera_sees_it) {
  const check::Scene scene;
  Fixture f("calibundistort ! calibdetect mode=sync");
  const std::string json = print_calibration(scene.camera.to_calibration()).value();
  g_object_set(f.element, "calibration", json.c_str(), "alpha", __i__ * 0.5, nullptr);
  f.set_caps("GRAY8", scene.size);
  double sum = 0;
  int points = 0;
  for (int n = 0; n < 5; ++n) {
    GstBuffer* in = check::frame_of(scene.picture(n), "GRAY8", n);
    g_autoptr(GstBuffer) out = gst_harness_push_and_pull(f.h, in);
    const Camera view = Camera::make(parse_calibration(output_calibration(f)).value()).value();
    const Observation truth = true_observation(view, scene.board, scene.pose(n));
    for (const Observation& o : gst::read_observations(out)) {
      for (std::size_t i = 0; i < o.ids.size(); ++i, ++points) {
        const auto it = std::find(truth.ids.begin(), truth.ids.end(), o.ids[i]);
        fail_unless(it != truth.ids.end());
        const Pixel want = truth.uv[static_cast<std::size_t>(it - truth.ids.begin())];
        sum += std::pow(o.uv[i].u - want.u, 2) + std::pow(o.uv[i].v - want.v, 2);
      }
    }
  }
  fail_unless(points >= 3 * 54);
  fail_unless(std::sqrt(sum / points) < 0.1, "%f px", std::sqrt(sum / points));
}
GST_END_TEST;

GST_START_TEST(test_states_come_and_go) {
  Fixture f("calibundistort", true);
  g_object_set(f.element, "calibration", kBarrel, nullptr);
  f.set_caps("GRAY8", kSize);
  for (int i = 0; i < 10; ++i) {
    g_autoptr(GstBuffer) out = f.push(kSize, i);
    fail_unless(gray_of(out, kSize) == expected_gray(kBarrel, kSize));
    g_object_set(f.element, "alpha", 0.5, nullptr);  // the worker is busy when it has to go
    gst_buffer_unref(f.push(kSize, i + 1));
    gst_element_set_state(f.h->element, GST_STATE_NULL);
    g_object_set(f.element, "alpha", 0.0, nullptr);
    gst_harness_play(f.h);
    gst_element_set_state(f.h->element, GST_STATE_PLAYING);
    gst_harness_push_event(f.h, gst_event_new_stream_start("again"));
    gst_harness_set_src_caps(f.h, check::caps_of("GRAY8", kSize));
    GstSegment segment;
    gst_segment_init(&segment, GST_FORMAT_TIME);
    gst_harness_push_event(f.h, gst_event_new_segment(&segment));
  }
}
GST_END_TEST;

static Suite* calibundistort_suite() {
  Suite* suite = suite_create("calibundistort");
  TCase* tc = tcase_create("general");
  const int broken = static_cast<int>(std::size(kBroken));
  tcase_add_loop_test(tc, test_without_a_calibration_the_buffer_passes_through, 0, 2);
  tcase_add_test(tc, test_an_event_undistorts_and_goes_on_as_a_pinhole);
  tcase_add_test(tc, test_an_event_before_the_caps_waits_for_them);
  tcase_add_test(tc, test_a_second_one_does_not_undo_twice);
  tcase_add_test(tc, test_the_event_of_cameracalibrate_is_understood);
  tcase_add_test(tc, test_the_property_beats_the_event);
  tcase_add_test(tc, test_disabled_it_forwards_the_event_untouched);
  tcase_add_test(tc, test_another_size_is_scaled_and_another_aspect_refused);
  tcase_add_test(tc, test_interlaced_video_passes_with_a_warning);
  tcase_add_loop_test(tc, test_an_unreadable_calibration_is_an_error_at_the_start, 0, broken);
  tcase_add_loop_test(tc, test_an_unreadable_calibration_while_running_is_a_warning, 0, broken);
  tcase_add_loop_test(tc, test_a_file_is_taken_in_when_it_appears_and_when_it_is_replaced, 0, 2);
  tcase_add_test(tc, test_a_change_is_exact_to_the_frame_where_nothing_is_live);
  tcase_add_test(tc, test_a_change_in_a_live_stream_shows_no_third_picture);
  tcase_add_test(tc, test_corners_follow_the_pixels);
  tcase_add_loop_test(tc, test_a_board_is_where_the_announced_camera_sees_it, 0, 3);
  tcase_add_test(tc, test_states_come_and_go);
  suite_add_tcase(suite, tc);
  return suite;
}

GST_CHECK_MAIN(calibundistort)
