// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What calibsolve tells: the guidance meta that it attaches, and its messages.

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "calvin/io/calibration_io.hpp"
#include "solve_fixture.hpp"

#include <gst/check/gstcheck.h>

using namespace calvin;
using check::SolveFixture;

// The same view of the board from the left border of the picture to the right one, or from the
// upper one to the lower one: the bar of that direction grows, and no other.
GST_START_TEST(test_each_bar_is_of_its_own_direction) {
  SolveFixture f;
  const bool down = __i__ == 1;
  Observation o = f.seen(0);
  const auto value = [&](Pixel& p) -> double& { return down ? p.v : p.u; };
  const auto less = [&](Pixel a, Pixel b) { return value(a) < value(b); };
  const auto [low, high] = std::minmax_element(o.uv.begin(), o.uv.end(), less);
  const double room = (down ? 479 : 639) - (value(*high) - value(*low));
  const double first = value(*low);
  std::array<double, 2> along{};
  std::array<double, 2> across{};
  for (int n = 0; n < 2; ++n) {
    Observation moved = o;
    for (Pixel& p : moved.uv) value(p) += n * room - first;
    g_autoptr(GstBuffer) out = f.push_observation(moved, n);
    const auto shown = gst::read_guidance(out);
    along[static_cast<std::size_t>(n)] = down ? shown->y : shown->x;
    across[static_cast<std::size_t>(n)] = down ? shown->x : shown->y;
  }
  fail_unless(along[1] > along[0] + 0.3, "%f %f", along[0], along[1]);
  fail_unless_equals_float(across[1], across[0]);
}
GST_END_TEST;

// What is drawn and what is posted is one and the same.
GST_START_TEST(test_progress_is_told_as_it_is_drawn) {
  SolveFixture f;
  for (int n = 0; n < 12; ++n) {
    g_autoptr(GstBuffer) out = f.push(n);
    const auto shown = gst::read_guidance(out);
    // The worker posts one more after each of its solves.
    const GstStructure* told = nullptr;
    for (const GstStructure* s : f.bus.named("calib-progress")) {
      int views = 0;
      gst_structure_get_int(s, "views", &views);
      if (views == shown->views) told = s;
    }
    fail_unless(told != nullptr, "%d", n);
    for (const auto& [field, value] : {std::pair("coverage", shown->coverage),
                                       {"x", shown->x},
                                       {"y", shown->y},
                                       {"size", shown->size},
                                       {"tilt", shown->tilt},
                                       {"skew", shown->tilt}}) {
      fail_unless_equals_float(check::get(told, field), value);
    }
    fail_unless_equals_string(gst_structure_get_string(told, "hint"), shown->hint.c_str());
  }
  // They were not all one number.
  const GstStructure* second = f.bus.named("calib-progress")[1];
  std::set<double> different;
  for (const char* field : {"coverage", "x", "y", "size", "skew"}) {
    different.insert(check::get(second, field));
  }
  fail_unless(different.size() >= 4, "%d", static_cast<int>(different.size()));
}
GST_END_TEST;

// The same view of the board, from half as far: it is twice as large, and no more tilted.
GST_START_TEST(test_size_is_not_tilt) {
  std::array<double, 2> size{};
  std::array<double, 2> skew{};
  for (int n = 0; n < 2; ++n) {
    SolveFixture f;
    Observation o = f.seen(1);
    const Pixel centre = f.scene.camera.project({0, 0, 1}).value();
    for (Pixel& p : o.uv) {
      const double factor = 0.15 * (n + 1);
      p = {centre.u + factor * (p.u - centre.u), centre.v + factor * (p.v - centre.v)};
    }
    g_autoptr(GstBuffer) out = f.push_observation(o, 0);
    const auto shown = gst::read_guidance(out);
    size[static_cast<std::size_t>(n)] = shown->size;
    skew[static_cast<std::size_t>(n)] = shown->tilt;
  }
  fail_unless(std::abs(size[1] / size[0] - 2) < 1e-6, "%f %f", size[0], size[1]);
  fail_unless(skew[0] > 0 && std::abs(skew[1] - skew[0]) < 1e-6, "%f %f", skew[0], skew[1]);
}
GST_END_TEST;

// A result is told field by field and whole, as JSON.
GST_START_TEST(test_a_result_tells_what_its_json_holds) {
  SolveFixture f;
  f.push_views(15);
  f.eos();
  const GstStructure* r = f.result("final");
  fail_unless(r != nullptr);
  const auto c = parse_calibration(gst_structure_get_string(r, "json")).value();
  for (const auto& [field, value] : {std::pair("rms", c.rms),
                                     {"held-out-rms", c.held_out_rms},
                                     {"chi", c.chi},
                                     {"split-half-ratio", c.split_half_ratio},
                                     {"expected-error", c.expected_error},
                                     {"expected-error-anywhere", c.expected_error_anywhere}}) {
    fail_unless(value.has_value());
    fail_unless(std::abs(check::get(r, field) / *value - 1) < 1e-9, "%s", field);
  }
  fail_if(check::get(r, "rms") == check::get(r, "held-out-rms"));
  g_autoptr(GstStructure) sigma = nullptr;
  gst_structure_get(r, "sigma", GST_TYPE_STRUCTURE, &sigma, nullptr);
  for (const Parameter& p : c.parameters) {
    fail_unless(std::abs(check::get(r, p.name.c_str()) - p.value) < 1e-9 * (1 + std::abs(p.value)));
    fail_unless(std::abs(check::get(sigma, p.name.c_str()) / *p.sigma - 1) < 1e-9);
  }
}
GST_END_TEST;

// The times of the frame, in each of the ways to count that GStreamer has.
GST_START_TEST(test_messages_have_the_times_of_their_frames) {
  SolveFixture f;
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  segment.time = 100 * GST_SECOND;
  segment.base = 5 * GST_SECOND;
  gst_harness_push_event(f.h, gst_event_new_segment(&segment));
  f.push_views(4);
  const auto views = f.bus.named("calib-view");
  fail_unless_equals_int(views.size(), 4);
  for (std::size_t n = 0; n < 4; ++n) {
    const GstClockTime pts = n * GST_SECOND / 30;
    for (const auto& [field, want] : {std::pair("timestamp", pts),
                                      {"stream-time", pts + 100 * GST_SECOND},
                                      {"running-time", pts + 5 * GST_SECOND},
                                      {"duration", GST_SECOND / 30}}) {
      guint64 found = 0;
      fail_unless(gst_structure_get_uint64(views[n], field, &found));
      fail_unless_equals_uint64(found, want);
    }
  }
}
GST_END_TEST;

static Suite* guidance_suite() {
  Suite* suite = suite_create("guidance");
  TCase* tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_checked_fixture(tc, gst::register_metas, nullptr);
  tcase_add_loop_test(tc, test_each_bar_is_of_its_own_direction, 0, 2);
  tcase_add_test(tc, test_size_is_not_tilt);
  tcase_add_test(tc, test_progress_is_told_as_it_is_drawn);
  tcase_add_test(tc, test_a_result_tells_what_its_json_holds);
  tcase_add_test(tc, test_messages_have_the_times_of_their_frames);
  return suite;
}

GST_CHECK_MAIN(guidance)
