// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// caliboverlay draws where the metas say, nowhere else, and never into a buffer of somebody else.

// Ours first: check.h defines the macro `fail`.
#include "calvin_config.h"
#include "common/metas.hpp"
#include "guarded_memory.hpp"
#include "support.hpp"

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "overlay_fixture.hpp"

#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>
#include <gst/video/video.h>

using namespace calvin;
using check::Box;
using check::Changes;
using check::changes;
using check::kGround;
using Harness = check::OverlayHarness;

namespace {

constexpr const char* kSmall = "GRAY8, width=320, height=240";

#if CALVIN_HAVE_CAIRO
// Four corners in two rows, the first at (u, v), `pitch` px apart.
Observation board_at(const GstVideoInfo& info, double u, double v, double pitch) {
  Observation o;
  o.board = "checkerboard:3x2:25mm";
  o.image_size = {GST_VIDEO_INFO_WIDTH(&info), GST_VIDEO_INFO_HEIGHT(&info)};
  o.ids = {0, 1, 3, 4};
  o.uv = {{u, v}, {u + pitch, v}, {u, v + pitch}, {u + pitch, v + pitch}};
  o.sigma = {0.1, 0.1, 0.1, 0.1};
  return o;
}
#endif

}  // namespace

GST_START_TEST(test_without_metas_the_buffer_itself_passes) {
  Harness harness(kSmall);
  GstBuffer* in = gst_buffer_ref(harness.frame());
  GstBuffer* out = gst_harness_push_and_pull(harness.h, in);
  fail_unless(out == in);
  fail_unless_equals_int(changes(harness.info, out, {}).outside, 0);
  gst_buffer_unref(out);
  gst_buffer_unref(in);
}
GST_END_TEST;

GST_START_TEST(test_a_board_that_was_not_found_draws_nothing) {
  Harness harness(kSmall);
  GstBuffer* in = harness.frame();
  gst::attach_observations(in, std::vector{Observation{}});
  gst_buffer_ref(in);
  GstBuffer* out = gst_harness_push_and_pull(harness.h, in);
  fail_unless(out == in);
  gst_buffer_unref(out);
  gst_buffer_unref(in);
}
GST_END_TEST;

#if CALVIN_HAVE_CAIRO

static const char* const kFormats[] = {
    "I420, width=320, height=240",  "NV12, width=320, height=240",  "YUY2, width=320, height=240",
    "BGRx, width=320, height=240",  "GRAY8, width=320, height=240", "I420, width=321, height=239",
    "NV12, width=319, height=241",  "YUY2, width=321, height=239",  "GRAY8, width=323, height=241",
    "UYVY, width=320, height=240",  "RGB, width=319, height=240",   "Y42B, width=320, height=240",
    "NV21, width=1281, height=719", "YV12, width=320, height=240"};

GST_START_TEST(test_draws_near_the_corners_only) {
  Harness harness(kFormats[__i__]);
  GstBuffer* in = harness.frame();
  gst::attach_observations(in, std::vector{board_at(harness.info, 101, 81, 41)});
  g_autoptr(GstBuffer) out = gst_harness_push_and_pull(harness.h, in);
  const Changes all = changes(harness.info, out, {80, 60, 165, 145});
  fail_unless(all.inside > 100, "%s: %d samples drawn", kFormats[__i__], all.inside);
  fail_unless_equals_int(all.outside, 0);
  const Changes first = changes(harness.info, out, {96, 76, 106, 86});
  fail_unless(first.inside > 20, "%s: nothing at corner 0", kFormats[__i__]);
  const Changes middle = changes(harness.info, out, {114, 92, 130, 112});
  fail_unless_equals_int(middle.inside, 0);
}
GST_END_TEST;

GST_START_TEST(test_somebody_elses_buffer_stays_as_it_is) {
  Harness harness("NV12, width=320, height=240");
  GstBuffer* in = harness.frame();
  gst::attach_observations(in, std::vector{board_at(harness.info, 100, 80, 40)});
  gst_buffer_ref(in);
  g_autoptr(GstBuffer) out = gst_harness_push_and_pull(harness.h, in);
  fail_unless(out != in);
  fail_unless_equals_int(changes(harness.info, in, {}).outside, 0);
  fail_unless(changes(harness.info, out, {}).outside > 100);
  fail_unless_equals_uint64(GST_BUFFER_PTS(out), GST_BUFFER_PTS(in));
  fail_unless_equals_int(gst::read_observations(out).size(), 1);
  gst_buffer_unref(in);
}
GST_END_TEST;

// A buffer that is ours over memory that is not, as behind a tee.
GST_START_TEST(test_memory_that_cannot_be_written_is_told_once) {
  const Harness harness(kSmall);
  check::Bus bus(harness.h->element);
  g_autoptr(GstAllocator) allocator = check::new_read_only_allocator();
  for (GstClockTime n = 0; n < 3; ++n) {
    GstBuffer* in = gst_buffer_new_allocate(allocator, harness.info.size, nullptr);
    GST_BUFFER_PTS(in) = n * GST_MSECOND;
    gst::attach_observations(in, std::vector{board_at(harness.info, 100, 80, 30)});
    g_autoptr(GstBuffer) out = gst_harness_push_and_pull(harness.h, in);
    fail_unless(out == in);
  }
  const auto warnings = bus.texts(GST_MESSAGE_WARNING);
  fail_unless_equals_int(warnings.size(), 1);
  fail_unless(warnings[0].find("neither written nor copied") != std::string::npos, "%s",
              warnings[0].c_str());
  bus.detach();
}
GST_END_TEST;

// Its copy, which is written in its place, has less than a frame.
GST_START_TEST(test_what_is_wrong_with_the_memory_is_told) {
  const Harness harness(kSmall);
  check::Bus bus(harness.h->element);
  g_autoptr(GstAllocator) allocator = check::new_halving_allocator();
  GstBuffer* in = gst_buffer_new_allocate(allocator, harness.info.size, nullptr);
  GST_BUFFER_PTS(in) = 0;
  gst::attach_observations(in, std::vector{board_at(harness.info, 100, 80, 30)});
  gst_buffer_unref(gst_harness_push_and_pull(harness.h, in));
  const auto warnings = bus.texts(GST_MESSAGE_WARNING);
  fail_unless_equals_int(warnings.size(), 1);
  fail_unless(warnings[0].find("needs") != std::string::npos, "%s", warnings[0].c_str());
  bus.detach();
}
GST_END_TEST;

GST_START_TEST(test_shared_memory_stays_as_it_is) {
  Harness harness(kSmall);
  GstBuffer* original = harness.frame();
  GstBuffer* in = gst_buffer_copy(original);
  gst::attach_observations(in, std::vector{board_at(harness.info, 100, 80, 40)});
  g_autoptr(GstBuffer) out = gst_harness_push_and_pull(harness.h, in);
  fail_unless_equals_int(changes(harness.info, original, {}).outside, 0);
  fail_unless(changes(harness.info, out, {}).outside > 100);
  gst_buffer_unref(original);
}
GST_END_TEST;

GST_START_TEST(test_guidance_draws_bars_and_words) {
  Harness harness("I420, width=640, height=480");
  GstBuffer* in = harness.frame();
  Progress guidance;
  guidance.hint = "tilt the board left";
  guidance.views = 12;
  guidance.x = 0.5;
  gst::attach_guidance(in, guidance);
  g_autoptr(GstBuffer) out = gst_harness_push_and_pull(harness.h, in);
  fail_unless(changes(harness.info, out, {0, 0, 150, 110}).inside > 1000);
  const Changes bottom = changes(harness.info, out, {100, 440, 540, 479});
#if CALVIN_HAVE_PANGO
  fail_unless(bottom.inside > 1000);
#else
  fail_unless_equals_int(bottom.inside, 0);
#endif
  fail_unless_equals_int(changes(harness.info, out, {160, 120, 639, 430}).inside, 0);
}
GST_END_TEST;

GST_START_TEST(test_parts_are_left_out) {
  for (const char* part : {"", "ghost", "coverage", "caption"}) {
    Harness harness("I420, width=640, height=480");
    if (*part != '\0') g_object_set(harness.h->element, part, FALSE, nullptr);
    GstBuffer* in = harness.frame();
    Progress guidance;
    guidance.hint = "tilt the board left";
    guidance.views = 12;
    guidance.x = 0.5;
    guidance.ghost = {{0.4, 0.4}, {0.6, 0.4}, {0.6, 0.6}, {0.4, 0.6}};
    gst::attach_guidance(in, guidance);
    g_autoptr(GstBuffer) out = gst_harness_push_and_pull(harness.h, in);
    const auto is_drawn = [&](int left, int top, int right, int bottom) {
      return changes(harness.info, out, {left, top, right, bottom}).inside > 100;
    };
    const std::string_view off(part);
    fail_unless_equals_int(is_drawn(0, 0, 150, 110), off != "coverage");
    fail_unless_equals_int(is_drawn(240, 180, 400, 300), off != "ghost");
    fail_unless_equals_int(is_drawn(100, 440, 540, 479), CALVIN_HAVE_PANGO && off != "caption");
  }
}
GST_END_TEST;

#if CALVIN_HAVE_PANGO
// The words go where the board is not, and stay there until it comes.
GST_START_TEST(test_words_make_room_for_the_board) {
  Harness harness("I420, width=640, height=480");
  const auto are_at_top = [&](double v) {
    GstBuffer* in = harness.frame();
    Progress guidance;
    guidance.hint = "tilt the board left";
    Observation board;
    board.board = "checkerboard:3x2:25mm";
    board.image_size = {640, 480};
    board.timestamp = GST_BUFFER_PTS(in);
    board.ids = {0, 1, 2, 3, 4, 5};
    for (int i = 0; i < 6; ++i) board.uv.push_back({310 + 20.0 * (i % 3), v + 20.0 * (i / 3)});
    board.sigma.assign(6, 0.1);
    gst::attach_observations(in, std::vector{board});
    gst::attach_guidance(in, guidance);
    g_autoptr(GstBuffer) out = gst_harness_push_and_pull(harness.h, in);
    // Beside the corners, where only words can be.
    const bool top = changes(harness.info, out, {380, 4, 560, 40}).inside > 300;
    const bool bottom = changes(harness.info, out, {380, 440, 440, 476}).inside > 100;
    fail_unless(top != bottom);
    return top;
  };
  fail_if(are_at_top(200));
  fail_unless(are_at_top(440));
  fail_unless(are_at_top(200), "they do not jump back");
  fail_if(are_at_top(10));
  fail_if(are_at_top(200));
}
GST_END_TEST;

// The last word of a long hint is what is to be done.
GST_START_TEST(test_a_long_hint_is_read_to_its_end) {
  Harness harness("I420, width=640, height=480");
  const auto drawn = [&](const std::string& last) {
    GstBuffer* in = harness.frame();
    Progress guidance;
    guidance.hint =
        "This looks like checkerboard:9x6:25mm, its picture is mirrored and in this frame half of "
        "it is hidden behind something: checkerboard:10x7:25mm is looked for. Give the one that is "
        "there, or show "
        "the one that was given, whichever is meant, " +
        last;
    gst::attach_guidance(in, guidance);
    return gst_harness_push_and_pull(harness.h, in);
  };
  g_autoptr(GstBuffer) one = drawn("now");
  g_autoptr(GstBuffer) other = drawn("mwm");
  GstMapInfo map;
  fail_unless(gst_buffer_map(one, &map, GST_MAP_READ));
  fail_unless(gst_buffer_memcmp(other, 0, map.data, map.size) != 0);
  gst_buffer_unmap(one, &map);
}
GST_END_TEST;
#endif

// 100 ms after the observation its marks are still there, 400 ms after no more; a new observation
// replaces it at once, a flush forgets it.
GST_START_TEST(test_marks_are_held_for_a_moment) {
  Harness harness(kSmall);
  const auto drawn = [&](GstClockTime pts, const Observation* observation) {
    GstBuffer* in = harness.frame(pts);
    if (observation != nullptr) gst::attach_observations(in, std::vector{*observation});
    g_autoptr(GstBuffer) out = gst_harness_push_and_pull(harness.h, in);
    return changes(harness.info, out, {}).outside > 0;
  };
  const Observation board = board_at(harness.info, 100, 80, 40);
  const Observation none;
  fail_unless(drawn(0, &board));
  fail_unless(drawn(100 * GST_MSECOND, nullptr));
  fail_if(drawn(400 * GST_MSECOND, nullptr));
  fail_unless(drawn(500 * GST_MSECOND, &board));
  fail_if(drawn(550 * GST_MSECOND, &none));
  fail_unless(drawn(600 * GST_MSECOND, &board));
  fail_unless(gst_harness_push_event(harness.h, gst_event_new_flush_start()));
  fail_unless(gst_harness_push_event(harness.h, gst_event_new_flush_stop(TRUE)));
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  fail_unless(gst_harness_push_event(harness.h, gst_event_new_segment(&segment)));
  fail_if(drawn(610 * GST_MSECOND, nullptr));
  fail_unless(drawn(GST_CLOCK_TIME_NONE, &board));
  fail_if(drawn(GST_CLOCK_TIME_NONE, nullptr));
}
GST_END_TEST;

GST_START_TEST(test_a_new_size_forgets_the_marks) {
  Harness harness(kSmall);
  GstBuffer* in = harness.frame();
  gst::attach_observations(in, std::vector{board_at(harness.info, 100, 80, 40)});
  gst_buffer_unref(gst_harness_push_and_pull(harness.h, in));
  const char* caps = "video/x-raw, format=GRAY8, width=160, height=120, framerate=30/1";
  gst_harness_set_src_caps_str(harness.h, caps);
  g_autoptr(GstCaps) parsed = gst_caps_from_string(caps);
  fail_unless(gst_video_info_from_caps(&harness.info, parsed));
  g_autoptr(GstBuffer) out = gst_harness_push_and_pull(harness.h, harness.frame(10));
  fail_unless_equals_int(changes(harness.info, out, {}).outside, 0);
}
GST_END_TEST;

#else

GST_START_TEST(test_warns_that_it_draws_nothing) {
  GstElement* element = gst_check_setup_element("caliboverlay");
  GstBus* bus = gst_bus_new();
  gst_element_set_bus(element, bus);
  fail_unless(gst_element_set_state(element, GST_STATE_PAUSED) != GST_STATE_CHANGE_FAILURE);
  for (const bool expected : {true, false}) {
    g_autoptr(GstMessage) message = gst_bus_pop_filtered(bus, GST_MESSAGE_WARNING);
    fail_unless(expected == (message != nullptr));
  }
  fail_unless(gst_element_set_state(element, GST_STATE_NULL) == GST_STATE_CHANGE_SUCCESS);
  gst_bus_set_flushing(bus, TRUE);
  gst_element_set_bus(element, nullptr);
  gst_object_unref(bus);
  gst_check_teardown_element(element);
}
GST_END_TEST;

#endif

static Suite* caliboverlay_suite() {
  Suite* suite = suite_create("caliboverlay");
  TCase* tc = tcase_create("general");
  tcase_add_checked_fixture(tc, gst::register_metas, nullptr);
  tcase_add_test(tc, test_without_metas_the_buffer_itself_passes);
  tcase_add_test(tc, test_a_board_that_was_not_found_draws_nothing);
#if CALVIN_HAVE_CAIRO
  tcase_add_loop_test(tc, test_draws_near_the_corners_only, 0, G_N_ELEMENTS(kFormats));
  tcase_add_test(tc, test_somebody_elses_buffer_stays_as_it_is);
  tcase_add_test(tc, test_memory_that_cannot_be_written_is_told_once);
  tcase_add_test(tc, test_what_is_wrong_with_the_memory_is_told);
  tcase_add_test(tc, test_shared_memory_stays_as_it_is);
  tcase_add_test(tc, test_guidance_draws_bars_and_words);
  tcase_add_test(tc, test_parts_are_left_out);
#if CALVIN_HAVE_PANGO
  tcase_add_test(tc, test_words_make_room_for_the_board);
  tcase_add_test(tc, test_a_long_hint_is_read_to_its_end);
#endif
  tcase_add_test(tc, test_marks_are_held_for_a_moment);
  tcase_add_test(tc, test_a_new_size_forgets_the_marks);
#else
  tcase_add_test(tc, test_warns_that_it_draws_nothing);
#endif
  suite_add_tcase(suite, tc);
  return suite;
}

GST_CHECK_MAIN(caliboverlay)
