// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibundistort: which calibration is in force when, and what downstream hears of it.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <map>
#include <thread>

#include "calvin_config.h"
#include "undistort_fixture.hpp"

#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>

using namespace calvin;
using namespace calvin::check;

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

// What is told where both have a calibration: of `b` alone, and where it undistorts a second time.
static const struct {
  const char* launch;
  const char* second;  // the calibration of b; nullptr: the output-calibration of a
  int warnings;
} kChains[] = {
    {"calibundistort name=a ! calibundistort name=b", kBarrel, 1},
    {"calibundistort name=a projection=panini ! calibundistort name=b", kPincushion, 1},
    // Something between that passes the event on, or makes one of its own.
    {"calibundistort name=a ! calibundistort enabled=false ! calibundistort name=b", kBarrel, 1},
    {"calibundistort name=a ! calibundistort ! calibundistort name=b", kBarrel, 1},
    {"calibundistort name=a ! calibundistort name=b", "", 0},
    {"calibundistort name=a ! calibundistort name=b pan=5", nullptr, 0},
    {"calibundistort name=a ! calibundistort name=b enabled=false", kBarrel, 0},
    {"calibundistort name=a alpha=1 ! calibundistort name=b alpha=1 direction=distort", kBarrel, 0},
    {"calibundistort name=a enabled=false ! calibundistort name=b", kBarrel, 0},
    {"calibundistort name=a direction=distort ! calibundistort name=b", kBarrel, 0},
};

GST_START_TEST(test_undistorting_twice_is_told_once) {
  const auto& chain = kChains[__i__];
  Fixture f(chain.launch);
  g_autoptr(GstElement) a = gst_bin_get_by_name(GST_BIN(f.h->element), "a");
  g_autoptr(GstElement) b = gst_bin_get_by_name(GST_BIN(f.h->element), "b");
  g_object_set(a, "calibration", kBarrel, nullptr);
  if (chain.second != nullptr) g_object_set(b, "calibration", chain.second, nullptr);
  f.set_caps("GRAY8", kSize);
  for (int n = 0; n < 3; ++n) {
    gst_buffer_unref(f.push(kSize, n));
    if (chain.second == nullptr) {
      g_autofree gchar* shown = nullptr;
      g_object_get(a, "output-calibration", &shown, nullptr);
      g_object_set(b, "calibration", shown, nullptr);
    }
  }
  const auto warnings = f.bus.texts(GST_MESSAGE_WARNING);
  fail_unless_equals_int(static_cast<int>(warnings.size()), chain.warnings);
  for (const std::string& warning : warnings) {
    fail_unless(warning.find("already undistorted") != std::string::npos, "%s", warning.c_str());
  }
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
  // The event is XML.
#if CALVIN_HAVE_FORMATS
  fail_unless(gray_of(out, kSize) == expected_gray(kBarrel, kSize));
  fail_unless_equals_int(events_out(f).size(), 1);
#else
  g_autoptr(GstBuffer) in = Fixture::noise("GRAY8", kSize, 0);
  fail_unless(gray_of(out, kSize) == gray_of(in, kSize));
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "-Dformats=enabled"));
#endif
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

// Two names of one value: whoever listens to either hears of it, once, and reads the same.
GST_START_TEST(test_both_names_of_a_property_are_notified) {
  GstElement* element = gst_element_factory_make("calibundistort", nullptr);
  gst_object_ref_sink(element);
  std::string heard;
  g_signal_connect(element, "notify",
                   G_CALLBACK(+[](GObject*, GParamSpec* spec, std::string* names) {
                     names->append(spec->name).append(" ");
                   }),
                   &heard);
  for (const char* name : {"calibration", "settings"}) {
    heard.clear();
    g_object_set(element, name, kBarrel, nullptr);
    const bool both = heard == "calibration settings " || heard == "settings calibration ";
    fail_unless(both, "%s: %s", name, heard.c_str());
  }
  for (const char* name : {"enabled", "undistort"}) {
    heard.clear();
    g_object_set(element, name, FALSE, nullptr);
    fail_unless(heard == "enabled undistort " || heard == "undistort enabled ", "%s: %s", name,
                heard.c_str());
  }
  heard.clear();
  g_object_set(element, "alpha", 0.5, nullptr);
  fail_unless_equals_string(heard.c_str(), "alpha ");
  gst_object_unref(element);
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

// Removed while the streaming thread makes a map as slow as they come: of a huge picture, to the
// poles of a lens that sees them.
using Seconds = std::chrono::duration<double>;

// A frame that takes a map of the largest kind; with a size behind it that is to be scaled to.
struct SlowMap {
  explicit SlowMap(bool scaled)
      : fixture(scaled ? "calibundistort projection=equirectangular alpha=1 ! "
                         "capsfilter caps=video/x-raw,width=8004,height=6003"
                       : "calibundistort projection=equirectangular alpha=1") {
    g_object_set(fixture.element, "calibration",
                 "model=fisheye,fx=2000,fy=2000,cx=4000,cy=3000,k1=-0.02,k2=0.005,k3=-0.003,"
                 "k4=0.0005,width=8000,height=6000",
                 nullptr);
    fixture.set_caps("GRAY8", {8000, 6000});
    frame = gst_buffer_new_allocate(nullptr, 8000 * 6000, nullptr);
    gst_buffer_memset(frame, 0, 99, 8000 * 6000);
    GST_BUFFER_PTS(frame) = 0;
  }
  Fixture fixture;
  GstBuffer* frame;
};

GST_START_TEST(test_a_state_change_does_not_wait_for_a_map) {
  Seconds whole{};
  {
    SlowMap slow(__i__ == 1);
    const auto before = std::chrono::steady_clock::now();
    fail_unless_equals_int(gst_harness_push(slow.fixture.h, slow.frame), GST_FLOW_OK);
    whole = std::chrono::steady_clock::now() - before;
  }
  SlowMap slow(__i__ == 1);
  std::thread streaming([&] { gst_harness_push(slow.fixture.h, slow.frame); });
  std::this_thread::sleep_for(whole / 8);
  const auto before = std::chrono::steady_clock::now();
  gst_element_set_state(slow.fixture.h->element, GST_STATE_NULL);
  const Seconds waited = std::chrono::steady_clock::now() - before;
  streaming.join();
  // 50 ms are the aim; other programs want the processor too.
  fail_unless(waited < whole / 4, "%f s of %f s", waited.count(), whole.count());
  auto& bus = slow.fixture.bus;
  fail_unless(bus.texts(GST_MESSAGE_ERROR).empty());
  // What follows may be down already, which GstBaseTransform takes for a fault of the caps.
  for (const std::string& warning : bus.texts(GST_MESSAGE_WARNING)) {
    fail_unless_equals_string(warning.c_str(), "not negotiated");
  }
}
GST_END_TEST;

// What the element said to GST_DEBUG, by its level.
static std::map<GstDebugLevel, std::vector<std::string>> logged;
static void take_log(GstDebugCategory* category, GstDebugLevel level, const gchar*, const gchar*,
                     gint, GObject*, GstDebugMessage* message, gpointer) {
  if (std::string(gst_debug_category_get_name(category)) != "calibundistort") return;
  logged[level].emplace_back(gst_debug_message_get(message));
}
static int lines_with(GstDebugLevel level, const char* part) {
  const auto& lines = logged[level];
  return static_cast<int>(std::count_if(lines.begin(), lines.end(), [&](const std::string& line) {
    return line.find(part) != std::string::npos;
  }));
}

GST_START_TEST(test_decisions_are_logged_once_and_frames_each) {
  Fixture f("calibundistort");
  gst_debug_set_threshold_for_name("calibundistort", GST_LEVEL_LOG);
  // In brackets: the macros of these names compare a function's address with void*.
  (gst_debug_add_log_function)(take_log, nullptr, nullptr);
  f.set_caps("GRAY8", kSize);
  for (int n = 0; n < 6; ++n) {
    if (n == 2) g_object_set(f.element, "calibration", kBarrel, nullptr);
    if (n == 4) g_object_set(f.element, "alpha", 1.0, nullptr);
    gst_buffer_unref(f.push(kSize, n));
  }
  (gst_debug_remove_log_function)(take_log);
  gst_debug_unset_threshold_for_name("calibundistort");
  fail_unless_equals_int(lines_with(GST_LEVEL_INFO, "become"), 1);
  fail_unless_equals_int(lines_with(GST_LEVEL_INFO, "takes a calibration"), 1);
  // One map for each view.
  fail_unless_equals_int(lines_with(GST_LEVEL_DEBUG, "undistorts frames of 640x480 px"), 2);
  fail_unless_equals_int(lines_with(GST_LEVEL_LOG, "passes frames as they are: buffer"), 2);
  fail_unless_equals_int(lines_with(GST_LEVEL_LOG, "undistorts frames of 640x480 px"), 4);
  logged.clear();
}
GST_END_TEST;

static Suite* calibundistort_suite() {
  Suite* suite = suite_create("calibundistort");
  TCase* tc = tcase_create("general");
  tcase_add_loop_test(tc, test_without_a_calibration_the_buffer_passes_through, 0, 2);
  tcase_add_test(tc, test_an_event_undistorts_and_goes_on_as_a_pinhole);
  tcase_add_test(tc, test_an_event_before_the_caps_waits_for_them);
  tcase_add_test(tc, test_a_second_one_does_not_undo_twice);
  tcase_add_loop_test(tc, test_undistorting_twice_is_told_once, 0,
                      static_cast<int>(std::size(kChains)));
  tcase_add_test(tc, test_the_event_of_cameracalibrate_is_understood);
  tcase_add_test(tc, test_the_property_beats_the_event);
  tcase_add_test(tc, test_both_names_of_a_property_are_notified);
  tcase_add_test(tc, test_disabled_it_forwards_the_event_untouched);
  tcase_add_test(tc, test_a_change_is_exact_to_the_frame_where_nothing_is_live);
  tcase_add_loop_test(tc, test_a_board_is_where_the_announced_camera_sees_it, 0, 3);
  tcase_add_loop_test(tc, test_a_state_change_does_not_wait_for_a_map, 0, 2);
  tcase_add_test(tc, test_states_come_and_go);
  tcase_add_test(tc, test_decisions_are_logged_once_and_frames_each);
  suite_add_tcase(suite, tc);
  return suite;
}

GST_CHECK_MAIN(calibundistort)
