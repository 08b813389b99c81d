// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibdetect: finds the board on the frame itself or on a worker, and never touches a pixel.

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <random>
#include <thread>

#include "common/values.hpp"
#include "detect_fixture.hpp"
#include "support.hpp"

#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>

using namespace calvin;

// Corners of all boards within `tolerance` px of the truth, every one of them there.
static void assert_corners(const std::vector<Observation>& found, const Observation& truth,
                           double tolerance) {
  fail_unless_equals_int(found.size(), 1);
  fail_unless_equals_int(found[0].ids.size(), truth.ids.size());
  for (std::size_t i = 0; i < truth.ids.size(); ++i) {
    fail_unless_equals_int(found[0].ids[i], truth.ids[i]);
    const double du = found[0].uv[i].u - truth.uv[i].u;
    const double dv = found[0].uv[i].v - truth.uv[i].v;
    fail_unless(std::hypot(du, dv) < tolerance, "corner %d is off by %f, %f", truth.ids[i], du, dv);
  }
}

static const char* const kFormats[] = {"GRAY8", "I420", "NV12",      "YUY2",     "BGRx",
                                       "RGB",   "UYVY", "GRAY16_LE", "I420_10LE"};

GST_START_TEST(test_finds_the_board_in_every_format) {
  check::DetectFixture f("calibdetect mode=sync", kFormats[__i__]);
  GstBuffer* in = check::frame_of(f.scene.picture(3), kFormats[__i__], 7);
  g_autoptr(GstBuffer) out = gst_harness_push_and_pull(f.h, in);
  const auto found = gst::read_observations(out);
  assert_corners(found, f.scene.truth(3), 0.25);
  fail_unless_equals_string(found[0].board.c_str(), "checkerboard:9x6:25mm");
  fail_unless_equals_string(found[0].camera.c_str(), "cam0");
  fail_unless_equals_uint64(found[0].timestamp, GST_BUFFER_PTS(out));
  fail_unless_equals_int(found[0].image_size.width, 640);
  fail_unless(found[0].ambiguous.empty());
}
GST_END_TEST;

GST_START_TEST(test_shares_the_memory_of_a_buffer_that_others_hold) {
  check::DetectFixture f;
  GstBuffer* in = check::frame_of(f.scene.picture(0), "GRAY8", 0);
  g_autoptr(GstBuffer) kept = gst_buffer_ref(in);
  g_autoptr(GstBuffer) out = gst_harness_push_and_pull(f.h, in);
  fail_unless(out != kept);
  fail_unless(gst_buffer_peek_memory(out, 0) == gst_buffer_peek_memory(kept, 0));
  fail_unless(gst::read_observations(kept).empty());
  fail_unless_equals_int(gst::read_observations(out).size(), 1);

  GstBuffer* own = check::frame_of(f.scene.picture(0), "GRAY8", 1);
  g_autoptr(GstBuffer) same = gst_harness_push_and_pull(f.h, own);
  fail_unless(same == own);
}
GST_END_TEST;

GST_START_TEST(test_no_board_is_said) {
  check::DetectFixture f("calibdetect mode=sync post-messages=true camera=left");
  g_autoptr(GstBuffer) out =
      gst_harness_push_and_pull(f.h, check::frame_of(GrayImage(640, 480, 90), "GRAY8", 2));
  const auto found = gst::read_observations(out);
  fail_unless_equals_int(found.size(), 1);
  fail_if(found[0].found());
  const auto messages = f.bus.named("calib-detection");
  fail_unless_equals_int(messages.size(), 1);
  fail_unless_equals_string(gst_structure_get_string(messages[0], "reason"), "not-found");
  fail_unless_equals_string(gst_structure_get_string(messages[0], "camera"), "left");
  gboolean is_found = TRUE;
  int total = 0;
  guint64 time = 0;
  fail_unless(gst_structure_get(messages[0], "found", G_TYPE_BOOLEAN, &is_found, "total",
                                G_TYPE_INT, &total, "timestamp", G_TYPE_UINT64, &time, nullptr));
  fail_if(is_found);
  fail_unless_equals_int(total, 54);
  fail_unless_equals_uint64(time, GST_BUFFER_PTS(out));
  for (const char* field : {"stream-time", "running-time", "duration", "latency-us"}) {
    fail_unless(gst_structure_has_field_typed(messages[0], field, G_TYPE_UINT64), "%s", field);
  }
}
GST_END_TEST;

GST_START_TEST(test_several_boards_are_listed_each) {
  check::DetectFixture f("calibdetect mode=sync board=checkerboard:9x6:25mm;checkerboard:5x4:10mm");
  g_autoptr(GstBuffer) out =
      gst_harness_push_and_pull(f.h, check::frame_of(f.scene.picture(1), "GRAY8", 0));
  const auto found = gst::read_observations(out);
  fail_unless_equals_int(found.size(), 2);
  fail_unless(found[0].found());
  fail_unless_equals_string(found[1].board.c_str(), "checkerboard:5x4:10mm");
}
GST_END_TEST;

// The place of a sheet in the meta is the `index` of its messages.
GST_START_TEST(test_two_sheets_of_a_board_are_two_observations) {
  check::DetectFixture f("calibdetect mode=sync post-messages=true");
  const Camera camera = default_camera(f.scene.size);
  const Board board = parse_board("checkerboard:9x6:25mm").value();
  const SE3 left = {exp_so3({0.1, 0.2, 0.05}), {-0.33, -0.06, 0.9}};
  const SE3 right = {exp_so3({-0.1, -0.2, 0.1}), {0.1, -0.08, 0.85}};
  GrayImage image = render_board(camera, board, left);
  GrayImage other = render_board(camera, board, right);
  for (int y = 0; y < image.height; ++y) {
    std::copy_n(other.row(y) + image.width / 2, image.width / 2, image.row(y) + image.width / 2);
  }
  g_autoptr(GstBuffer) out = gst_harness_push_and_pull(f.h, check::frame_of(image, "GRAY8", 0));
  const auto found = gst::read_observations(out);
  fail_unless_equals_int(found.size(), 2);
  fail_unless_equals_string(found[0].board.c_str(), found[1].board.c_str());
  assert_corners({found[0]}, true_observation(camera, board, left), 0.25);
  assert_corners({found[1]}, true_observation(camera, board, right), 0.25);
  const auto messages = f.bus.named("calib-detection");
  fail_unless_equals_int(messages.size(), 2);
  for (int i = 0; i < 2; ++i) {
    int index = -1;
    fail_unless(gst_structure_get_int(messages[static_cast<std::size_t>(i)], "index", &index));
    fail_unless_equals_int(index, i);
  }
}
GST_END_TEST;

// Frames of a stream that tells no times are as far apart as the caps say, those that nobody looks
// at included, from the last one on that has a time; where the caps do not tell, nobody knows.
GST_START_TEST(test_frames_without_times_follow_the_rate) {
  check::DetectFixture f("calibdetect mode=sync max-rate=15");
  const auto time_of = [&f](GstClockTime pts) {
    GstBuffer* in = check::frame_of(f.scene.picture(0), "GRAY8", 0);
    GST_BUFFER_PTS(in) = pts;
    g_autoptr(GstBuffer) out = gst_harness_push_and_pull(f.h, in);
    fail_unless_equals_uint64(GST_BUFFER_PTS(out), pts);
    const auto found = gst::read_observations(out);
    return found.empty() ? std::nullopt : std::optional(found[0].timestamp);
  };
  constexpr GstClockTime kFrame = GST_SECOND / 30;
  for (GstClockTime n = 0; n < 6; ++n) {
    const auto time = time_of(GST_CLOCK_TIME_NONE);
    fail_unless(time.has_value() == (n % 2 == 0));
    if (time) fail_unless_equals_uint64(*time, n * kFrame);
  }
  fail_unless_equals_uint64(time_of(5 * GST_SECOND).value(), 5 * GST_SECOND);
  fail_if(time_of(GST_CLOCK_TIME_NONE).has_value());
  fail_unless_equals_uint64(time_of(GST_CLOCK_TIME_NONE).value(), 5 * GST_SECOND + 2 * kFrame);

  GstCaps* pictures = check::caps_of("GRAY8", f.scene.size);
  gst_caps_set_simple(pictures, "framerate", GST_TYPE_FRACTION, 0, 1, nullptr);
  gst_harness_set_src_caps(f.h, pictures);
  fail_unless_equals_uint64(time_of(GST_CLOCK_TIME_NONE).value(), GST_CLOCK_TIME_NONE);
}
GST_END_TEST;

// The first frames of many cameras are black, and nobody needs to hear of it.
GST_START_TEST(test_the_dark_is_said_once_it_lasts) {
  check::DetectFixture f("calibdetect mode=sync");
  const GrayImage dark(640, 480, 18);
  const auto push = [&f](const GrayImage& image, int n) {
    g_autoptr(GstBuffer) out = gst_harness_push_and_pull(f.h, check::frame_of(image, "GRAY8", n));
    fail_if(gst::read_hint(out).wrong_board);
    return gst::read_hint(out).words;
  };
  for (int n = 0; n < 9; ++n) fail_unless(push(dark, n).empty());
  fail_unless(f.bus.named("calib-detection").empty());
  for (int n = 9; n < 15; ++n) {
    const std::string hint = push(dark, n);
    fail_unless_equals_string(hint.c_str(),
                              "The picture is too dark: more light, or a longer exposure");
  }
  fail_unless_equals_int(f.bus.named("calib-detection").size(), 1);
  // Light alone ends it, with a board or without.
  fail_unless(push(GrayImage(640, 480, 120), 15).empty());
  fail_unless(push(dark, 16).empty());
  fail_unless(push(f.scene.picture(3), 17).empty());
  for (int n = 18; n < 30; ++n) push(dark, n);
  fail_unless_equals_int(f.bus.named("calib-detection").size(), 2);
}
GST_END_TEST;

// Async: the streaming thread hands the frame over and goes on; at EOS every result has arrived.
GST_START_TEST(test_async_results_ride_on_later_buffers_and_are_complete_at_eos) {
  check::DetectFixture f("calibdetect mode=async post-messages=true");
  gst_harness_push(f.h, check::frame_of(f.scene.picture(5), "GRAY8", 0));
  gst_harness_push_event(f.h, gst_event_new_eos());
  g_autoptr(GstBuffer) first = gst_harness_pull(f.h);
  fail_unless(gst::read_observations(first).empty());

  std::vector<Observation> late;
  bool eos = false;
  while (GstEvent* event = gst_harness_try_pull_event(f.h)) {
    if (gst_event_has_name(event, gst::kObservationName)) {
      fail_if(eos, "the result came after EOS");
      late = gst::observations_from_structure(gst_event_get_structure(event));
    }
    eos |= GST_EVENT_TYPE(event) == GST_EVENT_EOS;
    gst_event_unref(event);
  }
  fail_unless(eos);
  assert_corners(late, f.scene.truth(5), 0.25);
  fail_unless_equals_int(f.bus.named("calib-detection").size(), 1);
}
GST_END_TEST;

GST_START_TEST(test_max_rate_skips_frames) {
  check::DetectFixture f("calibdetect mode=sync max-rate=10");
  for (int n = 0; n < 30; ++n) {
    gst_harness_push(f.h, check::frame_of(GrayImage(640, 480, 90), "GRAY8", n));
  }
  g_autoptr(GstStructure) stats = nullptr;
  g_object_get(f.h->element, "stats", &stats, nullptr);
  guint64 frames = 0;
  guint64 detections = 0;
  gst_structure_get(stats, "frames", G_TYPE_UINT64, &frames, "detections", G_TYPE_UINT64,
                    &detections, nullptr);
  fail_unless_equals_uint64(frames, 30);
  fail_unless(detections >= 9 && detections <= 11, "%" G_GUINT64_FORMAT, detections);
}
GST_END_TEST;

GST_START_TEST(test_a_wrong_board_text_is_an_error_that_shows_a_right_one) {
  static const char* const kWrong[] = {
      "checkers:9x6:25mm",      "checkerboard:9x6",  "", "9x6", "checkerboard:9x6:25",
      "checkerboard:-1x6:25mm", "missing.json#floor"};
  for (const char* text : kWrong) {
    const auto texts = check::errors_at_start("calibdetect", "board", text);
    fail_unless(texts.size() == 1 && texts[0].find("checkerboard:9x6:25mm") != std::string::npos,
                "for '%s'", text);
  }
}
GST_END_TEST;

GST_START_TEST(test_a_wrong_board_text_while_running_keeps_the_old_board) {
  check::DetectFixture f;
  g_object_set(f.h->element, "board", "nonsense", nullptr);
  g_autoptr(GstBuffer) out =
      gst_harness_push_and_pull(f.h, check::frame_of(f.scene.picture(1), "GRAY8", 0));
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "checkerboard:9x6:25mm"));
  assert_corners(gst::read_observations(out), f.scene.truth(1), 0.25);
  g_object_set(f.h->element, "board", "checkerboard:5x4:1cm", nullptr);
  g_autoptr(GstBuffer) next =
      gst_harness_push_and_pull(f.h, check::frame_of(f.scene.picture(1), "GRAY8", 1));
  const auto found = gst::read_observations(next);
  fail_unless_equals_string(found.at(0).board.c_str(), "checkerboard:5x4:10mm");
}
GST_END_TEST;

GST_START_TEST(test_a_board_that_is_set_again_is_not_read_again) {
  check::DetectFixture f;
  for (int i = 0; i < 3; ++i) {
    g_object_set(f.h->element, "board", "nonsense", nullptr);
    gst_buffer_unref(
        gst_harness_push_and_pull(f.h, check::frame_of(f.scene.picture(1), "GRAY8", i)));
  }
  fail_unless_equals_int(f.bus.texts(GST_MESSAGE_WARNING).size(), 1);
}
GST_END_TEST;

// What is still being computed when the size changes must not ride on a frame of the new one.
GST_START_TEST(test_no_result_crosses_a_caps_change) {
  check::DetectFixture f("calibdetect mode=async");
  for (int round = 0; round < 5; ++round) {
    gst_harness_set_src_caps(f.h, check::caps_of("GRAY8", f.scene.size));
    gst_buffer_unref(
        gst_harness_push_and_pull(f.h, check::frame_of(f.scene.picture(round), "GRAY8", 0)));
    gst_harness_set_src_caps(f.h, check::caps_of("GRAY8", {320, 240}));
    for (int n = 0; n < 20; ++n) {
      g_autoptr(GstBuffer) out =
          gst_harness_push_and_pull(f.h, check::frame_of(GrayImage(320, 240), "GRAY8", n));
      for (const Observation& o : gst::read_observations(out)) {
        fail_unless_equals_int(o.image_size.width, 320);
      }
      g_usleep(5000);
    }
  }
}
GST_END_TEST;

GST_START_TEST(test_flush_caps_change_and_state_cycles) {
  check::DetectFixture f("calibdetect mode=async");
  for (int round = 0; round < 3; ++round) {
    gst_harness_push(f.h, check::frame_of(f.scene.picture(round), "GRAY8", round));
    gst_harness_push_event(f.h, gst_event_new_flush_start());
    gst_harness_push_event(f.h, gst_event_new_flush_stop(TRUE));
    GstSegment segment;
    gst_segment_init(&segment, GST_FORMAT_TIME);
    gst_harness_push_event(f.h, gst_event_new_segment(&segment));
    gst_harness_set_src_caps(f.h, check::caps_of("GRAY8", {320 + 2 * round, 240}));
    fail_unless_equals_int(
        gst_harness_push(f.h, check::frame_of(GrayImage(320 + 2 * round, 240), "GRAY8", 9)),
        GST_FLOW_OK);
    gst_element_set_state(f.h->element, GST_STATE_READY);
    gst_element_set_state(f.h->element, GST_STATE_PLAYING);
    gst_harness_set_src_caps(f.h, check::caps_of("GRAY8", f.scene.size));
  }
}
GST_END_TEST;

// How long the change to READY takes while a frame is being looked at, us; absent where the
// detection was over before it.
static std::optional<gint64> stop_while_detecting(const char* launch, const GrayImage& picture) {
  check::DetectFixture f(launch);
  gst_harness_set_src_caps(f.h, check::caps_of("GRAY8", picture.size()));
  std::thread pusher([&] { gst_harness_push(f.h, check::frame_of(picture, "GRAY8", 0)); });
  g_usleep(30000);
  const gint64 begin = g_get_monotonic_time();
  gst_element_set_state(f.element, GST_STATE_READY);
  const gint64 taken = g_get_monotonic_time() - begin;
  g_autoptr(GstStructure) stats = nullptr;
  g_object_get(f.element, "stats", &stats, nullptr);
  guint64 detections = 0;
  gst_structure_get_uint64(stats, "detections", &detections);
  pusher.join();
  return detections == 0 ? std::optional(taken) : std::nullopt;
}

// A detection is interrupted between its steps only: neither the streaming thread nor the state
// change may wait for it. Twelve megapixels of noise and eight boards keep it busy for long.
GST_START_TEST(test_no_state_change_waits_for_a_detection) {
  GrayImage noise(4000, 3000);
  std::string boards = kDefaultBoard.data();
  for (int cols = 10; cols < 17; ++cols)
    boards += ";checkerboard:" + std::to_string(cols) + "x6:25mm";
  std::mt19937 random(1);
  for (std::uint8_t& pixel : noise.pixels) pixel = static_cast<std::uint8_t>(random());
  for (const char* mode : {"sync", "async"}) {
    const std::string launch = std::string("calibdetect mode=") + mode + " board=" + boards;
    // The least of three: another program may take the processor away, for so long that there is
    // nothing left to interrupt.
    std::optional<gint64> least;
    for (int round = 0; round < 3 || (!least && round < 30); ++round) {
      const auto taken = stop_while_detecting(launch.c_str(), noise);
      if (taken) least = std::min(least.value_or(*taken), *taken);
    }
    fail_unless(least.has_value(), "no detection was under way");
    fail_unless(*least < 50000, "%s: %" G_GINT64_FORMAT " us", mode, *least);
  }
}
GST_END_TEST;

static Suite* calibdetect_suite() {
  Suite* suite = suite_create("calibdetect");
  TCase* tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_checked_fixture(tc, gst::register_metas, nullptr);
  tcase_add_loop_test(tc, test_finds_the_board_in_every_format, 0, G_N_ELEMENTS(kFormats));
  tcase_add_test(tc, test_shares_the_memory_of_a_buffer_that_others_hold);
  tcase_add_test(tc, test_no_board_is_said);
  tcase_add_test(tc, test_several_boards_are_listed_each);
  tcase_add_test(tc, test_async_results_ride_on_later_buffers_and_are_complete_at_eos);
  tcase_add_test(tc, test_two_sheets_of_a_board_are_two_observations);
  tcase_add_test(tc, test_frames_without_times_follow_the_rate);
  tcase_add_test(tc, test_the_dark_is_said_once_it_lasts);
  tcase_add_test(tc, test_max_rate_skips_frames);
  tcase_add_test(tc, test_a_wrong_board_text_is_an_error_that_shows_a_right_one);
  tcase_add_test(tc, test_a_wrong_board_text_while_running_keeps_the_old_board);
  tcase_add_test(tc, test_a_board_that_is_set_again_is_not_read_again);
  tcase_add_test(tc, test_no_result_crosses_a_caps_change);
  tcase_add_test(tc, test_flush_caps_change_and_state_cycles);
  tcase_add_test(tc, test_no_state_change_waits_for_a_detection);
  return suite;
}

GST_CHECK_MAIN(calibdetect)
