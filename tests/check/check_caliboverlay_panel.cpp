// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The panel of caliboverlay: its words, its place, and what it shows once a calibration is done.

// Ours first: check.h defines the macro `fail`.
#include "calvin_config.h"
#include "common/metas.hpp"

#include <string>
#include <vector>

#include "overlay_fixture.hpp"

using namespace calvin;
using check::changes;
using Harness = check::OverlayHarness;

namespace {

constexpr const char* kFrames = "I420, width=640, height=480";

Progress under_way() {
  Progress progress;
  progress.hint = "Tilt the board.";
  progress.views = 9;
  progress.x = 0.4;
  progress.parameters = {{"focal length", 0.2}, {"distortion", 1}};
  return progress;
}

Progress finished() {
  Progress progress = under_way();
  progress.done = true;
  progress.summary = {"fx 536.1 \u00b1 0.4", "fy 536.0 \u00b1 0.4"};
  return progress;
}

Observation board_at(double u, double v) {
  Observation board;
  board.board = "checkerboard:3x2:25mm";
  board.image_size = {640, 480};
  board.ids = {0, 1, 2, 3, 4, 5};
  for (int i = 0; i < 6; ++i) board.uv.push_back({u + 20.0 * (i % 3), v + 20.0 * (i / 3)});
  board.sigma.assign(6, 0.1);
  return board;
}

GstBuffer* drawn(Harness& harness, const Progress& progress, std::vector<Observation> seen = {}) {
  GstBuffer* in = harness.frame();
  gst::attach_guidance(in, progress);
  if (!seen.empty()) gst::attach_observations(in, seen);
  return gst_harness_push_and_pull(harness.h, in);
}

// How many samples of two frames differ in the box.
int differences(GstBuffer* a, GstBuffer* b, const GstVideoInfo& info, const check::Box& box) {
  GstMapInfo one;
  GstMapInfo other;
  gst_buffer_map(a, &one, GST_MAP_READ);
  gst_buffer_map(b, &other, GST_MAP_READ);
  int count = 0;
  for (int y = box.top; y <= box.bottom; ++y) {
    for (int x = box.left; x <= box.right; ++x) {
      const gsize at = static_cast<gsize>(y) * GST_VIDEO_INFO_PLANE_STRIDE(&info, 0) + x;
      count += one.data[at] != other.data[at] ? 1 : 0;
    }
  }
  gst_buffer_unmap(b, &other);
  gst_buffer_unmap(a, &one);
  return count;
}

}  // namespace

GST_START_TEST(test_bars_and_chips_have_words) {
  Harness harness(kFrames);
  Progress other = under_way();
  other.parameters[1].name = "skew";
  g_autoptr(GstBuffer) one = drawn(harness, under_way());
  g_autoptr(GstBuffer) two = drawn(harness, other);
  // The seventh line of the panel is the second chip.
  const check::Box chip = {16, 96, 130, 112};
  fail_unless(differences(one, two, harness.info, chip) > 50);
  fail_unless_equals_int(differences(one, two, harness.info, {16, 16, 130, 90}), 0);
}
GST_END_TEST;

GST_START_TEST(test_the_numbers_are_there_when_it_is_done) {
  Harness harness(kFrames);
  g_autoptr(GstBuffer) before = drawn(harness, under_way());
  g_autoptr(GstBuffer) after = drawn(harness, finished());
  Progress others = finished();
  others.summary[0] = "fx 999.9 \u00b1 0.4";
  g_autoptr(GstBuffer) other = drawn(harness, others);
  const check::Box first_line = {16, 14, 130, 28};
  fail_unless(differences(after, other, harness.info, first_line) > 20);
  fail_unless_equals_int(differences(after, other, harness.info, {16, 30, 130, 200}), 0);
  // A border, and words on another ground.
  fail_unless_equals_int(changes(harness.info, before, {0, 230, 1, 250}).inside, 0);
  fail_unless(changes(harness.info, after, {0, 230, 1, 250}).inside > 0);
  fail_unless(differences(before, after, harness.info, {100, 440, 540, 476}) > 1000);
}
GST_END_TEST;

GST_START_TEST(test_the_panel_makes_room_for_the_board) {
  Harness harness(kFrames);
  const auto is_left = [&](double u, double v) {
    g_autoptr(GstBuffer) out = drawn(harness, under_way(), {board_at(u, v)});
    const bool left = changes(harness.info, out, {12, 12, 40, 30}).inside > 300;
    const bool right = changes(harness.info, out, {600, 12, 626, 30}).inside > 300;
    fail_unless(left != right);
    return left;
  };
  fail_unless(is_left(300, 200));
  fail_if(is_left(60, 60));
  fail_if(is_left(300, 200), "it does not jump back");
  fail_unless(is_left(560, 60));
}
GST_END_TEST;

// Where the board is wanted has to be seen, too; where both cannot be, the board.
GST_START_TEST(test_the_panel_makes_room_for_the_ghost) {
  Harness harness(kFrames);
  const auto is_left = [&](double ghost, double u) {
    Progress progress = under_way();
    for (const double corner : {0.0, 0.1, 0.2, 0.3}) {
      progress.ghost.push_back({ghost + corner / 10, 0.1 + corner});
    }
    g_autoptr(GstBuffer) out = drawn(harness, progress, {board_at(u, 60)});
    return changes(harness.info, out, {12, 12, 40, 30}).inside > 300;
  };
  fail_unless(is_left(0.5, 300));
  fail_if(is_left(0.05, 300));
  fail_unless(is_left(0.05, 560), "the board counts more");
  fail_if(is_left(0.05, 300));
}
GST_END_TEST;

// A number is not drawn again for each point that comes.
GST_START_TEST(test_manual_points_have_numbers) {
  Harness harness(kFrames);
  Progress progress = under_way();
  progress.points = {{4, {300.5 / 640, 200.5 / 480}}};
  g_autoptr(GstBuffer) without = drawn(harness, under_way());
  g_autoptr(GstBuffer) one = drawn(harness, progress);
  const check::Box number = {310, 192, 330, 208};
  fail_unless(differences(without, one, harness.info, number) > 10);
  progress.points.push_back({17, {500.5 / 640, 300.5 / 480}});
  g_autoptr(GstBuffer) two = drawn(harness, progress);
  fail_unless_equals_int(differences(one, two, harness.info, number), 0);
  fail_unless(differences(one, two, harness.info, {510, 292, 540, 308}) > 20);
  // Anybody may write the same point twice.
  progress.points.push_back(progress.points.front());
  progress.points.push_back(progress.points.front());
  g_autoptr(GstBuffer) twice = drawn(harness, progress);
  fail_unless_equals_int(differences(two, twice, harness.info, number), 0);
}
GST_END_TEST;

static Suite* caliboverlay_panel_suite() {
  Suite* suite = suite_create("caliboverlay_panel");
  TCase* tc = tcase_create("general");
  tcase_add_checked_fixture(tc, gst::register_metas, nullptr);
#if CALVIN_HAVE_PANGO
  tcase_add_test(tc, test_bars_and_chips_have_words);
  tcase_add_test(tc, test_the_numbers_are_there_when_it_is_done);
  tcase_add_test(tc, test_the_panel_makes_room_for_the_board);
  tcase_add_test(tc, test_the_panel_makes_room_for_the_ghost);
  tcase_add_test(tc, test_manual_points_have_numbers);
#endif
  suite_add_tcase(suite, tc);
  return suite;
}

GST_CHECK_MAIN(caliboverlay_panel)
