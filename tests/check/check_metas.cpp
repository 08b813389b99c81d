// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The metas keep their content, scale with the picture, and are dropped rather than left stale.

// Ours first: check.h defines the macro `fail`.
#include "common/metas.hpp"
#include "common/values.hpp"

#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>

using namespace calvin;

static Observation example() {
  Observation o;
  o.camera = "left";
  o.board = "checkerboard:3x2:25mm";
  o.timestamp = 42;
  o.image_size = {320, 240};
  o.ids = {0, 5};
  o.uv = {{10, 20}, {30.5, 40.25}};
  o.sigma = {0.1, 0.2};
  o.blur = 0.8;
  o.ambiguous = {{2}, {1, 0, -3}};
  o.patches = std::make_shared<CornerPatches>(
      CornerPatches{3, {{9, 19}, {29, 39}}, std::make_shared<std::uint8_t[]>(18, std::uint8_t{7})});
  return o;
}

GST_START_TEST(test_observation_round_trip) {
  g_autoptr(GstBuffer) buffer = gst_buffer_new();
  gst::attach_observations(buffer, std::vector{example(), Observation{}});
  g_autoptr(GstBuffer) copy = gst_buffer_copy(buffer);
  const auto all = gst::read_observations(copy);
  fail_unless_equals_int(all.size(), 2);
  fail_unless_equals_string(all[0].camera.c_str(), "left");
  fail_unless_equals_string(all[0].board.c_str(), "checkerboard:3x2:25mm");
  fail_unless_equals_uint64(all[0].timestamp, 42);
  fail_unless_equals_int(all[0].ids[1], 5);
  fail_unless_equals_float(all[0].uv[1].u, 30.5);
  fail_unless_equals_float(all[0].uv[1].v, 40.25);
  fail_unless_equals_float(all[0].sigma[1], 0.2);
  fail_unless(all[0].image_size == (ImageSize{320, 240}));
  fail_unless_equals_float(all[0].blur, 0.8);
  fail_unless(all[0].ambiguous == example().ambiguous);
  fail_unless(all[0].found() && !all[1].found());
  fail_unless(all[0].patches && !all[1].patches);
  fail_unless_equals_int(all[0].patches->side, 3);
  fail_unless_equals_int(all[0].patches->origin[1][1], 39);
  fail_unless_equals_int(all[0].patches->pixels[17], 7);
}
GST_END_TEST;

GST_START_TEST(test_lists_of_different_lengths_are_no_observation) {
  g_autoptr(GstStructure) s = gst::observations_to_structure(std::vector{example()});
  GstStructure* item = gst_structure_copy(gst::get_structures(s, "observations")[0]);
  gst::set_ints(item, "ids", std::vector<int>{1, 2, 3});
  gst::take_structures(s, "observations", std::vector{item});
  fail_unless(gst::observations_from_structure(s).empty());
}
GST_END_TEST;

GST_START_TEST(test_patches_without_pixels_are_none) {
  g_autoptr(GstStructure) s = gst::observations_to_structure(std::vector{example()});
  GstStructure* item = gst_structure_copy(gst::get_structures(s, "observations")[0]);
  gst_structure_set(item, "patches", G_TYPE_BYTES, nullptr, nullptr);
  gst::take_structures(s, "observations", std::vector{item});
  const auto all = gst::observations_from_structure(s);
  fail_unless_equals_int(all.size(), 1);
  fail_unless(all[0].patches == nullptr);
}
GST_END_TEST;

// Pushes one 320x240 frame with the meta through an element; the buffer that comes out.
static GstBuffer* through(const char* launch, const char* out_caps) {
  GstHarness* h = gst_harness_new_parse(launch);
  gst_harness_set_caps_str(h, "video/x-raw,format=GRAY8,width=320,height=240,framerate=30/1",
                           out_caps);
  GstBuffer* buffer = gst_harness_create_buffer(h, 320 * 240);
  gst::attach_observations(buffer, std::vector{example()});
  GstBuffer* out = gst_harness_push_and_pull(h, buffer);
  gst_harness_teardown(h);
  return out;
}

GST_START_TEST(test_scaling_scales_the_corners) {
  g_autoptr(GstBuffer) out =
      through("videoscale", "video/x-raw,format=GRAY8,width=160,height=480,framerate=30/1");
  const auto all = gst::read_observations(out);
  fail_unless_equals_int(all.size(), 1);
  fail_unless_equals_int(all[0].image_size.width, 160);
  fail_unless_equals_int(all[0].image_size.height, 480);
  fail_unless_equals_float(all[0].uv[0].u, 0.5 * 10.5 - 0.5);
  fail_unless_equals_float(all[0].uv[0].v, 2 * 20.5 - 0.5);
  fail_unless_equals_float(all[0].uv[1].u, 0.5 * 31 - 0.5);
  fail_unless_equals_float(all[0].uv[1].v, 2 * 40.75 - 0.5);
  // A length has the mean of both scales: 0.5 and 2.
  fail_unless_equals_float(all[0].blur, 1.25 * 0.8);
  fail_unless_equals_float(all[0].sigma[0], 1.25 * 0.1);
  fail_unless_equals_float(all[0].sigma[1], 1.25 * 0.2);
  // They are of the picture as it was.
  fail_unless(all[0].patches == nullptr);
}
GST_END_TEST;

GST_START_TEST(test_cropping_drops_the_corners) {
  g_autoptr(GstBuffer) out =
      through("videocrop left=100", "video/x-raw,format=GRAY8,width=220,height=240,framerate=30/1");
  fail_unless(gst::read_observations(out).empty());
}
GST_END_TEST;

GST_START_TEST(test_guidance_and_ground_truth_round_trip) {
  g_autoptr(GstBuffer) buffer = gst_buffer_new();
  Progress guidance;
  guidance.hint = "tilt it";
  guidance.views = 7;
  guidance.expected_error = 0.25;
  guidance.expected_error_anywhere = 2.5;
  guidance.wanted_error_anywhere = 0.75;
  guidance.coverage = 0.1;
  guidance.x = 0.2;
  guidance.y = 0.3;
  guidance.size = 0.4;
  guidance.tilt = 0.5;
  guidance.captured = true;
  guidance.coverage_map = {3, {true, false, false, false, true, true}};
  guidance.parameters = {{"focal length", 0.25}, {"distortion", 1}};
  guidance.points = {{4, {0.25, 0.5}}, {9, {0.75, 0.125}}};
  guidance.done = true;
  guidance.summary = {"fx 1", "fy 2 \u00b1 3"};
  gst::attach_guidance(buffer, guidance);
  gst::GroundTruth truth;
  truth.calibration = "{}";
  truth.boards.push_back({example(), {{0.1, 0.2, 0.3}, {1, 2, 3}}});
  gst::attach_ground_truth(buffer, truth);

  const auto g = gst::read_guidance(buffer);
  fail_unless(g.has_value());
  fail_unless_equals_string(g->hint.c_str(), "tilt it");
  fail_unless_equals_int(g->views, 7);
  fail_unless(g->expected_error == 0.25 && g->expected_error_anywhere == 2.5 && !g->rms);
  fail_unless(g->coverage == 0.1 && g->x == 0.2 && g->y == 0.3 && g->size == 0.4);
  fail_unless(g->tilt == 0.5 && g->captured && g->done);
  fail_unless(g->summary == guidance.summary && g->wanted_error_anywhere == 0.75);
  fail_unless_equals_int(g->points.size(), 2);
  fail_unless_equals_int(g->points[1].id, 9);
  fail_unless(g->points[1].at.u == 0.75 && g->points[1].at.v == 0.125);
  fail_unless_equals_int(g->parameters.size(), 2);
  fail_unless_equals_string(g->parameters[1].name.c_str(), "distortion");
  fail_unless(g->parameters[0].known == 0.25 && g->parameters[1].known == 1);
  fail_unless(g->coverage_map.columns == 3 && g->coverage_map.rows() == 2);
  fail_unless(g->coverage_map.covered == guidance.coverage_map.covered);
  guidance.rms = 0.6;
  guidance.expected_error.reset();
  guidance.captured = false;
  gst::attach_guidance(buffer, guidance);
  const auto again = gst::read_guidance(buffer);
  fail_unless(again->rms == 0.6 && !again->expected_error && !again->captured);
  const auto t = gst::read_ground_truth(buffer);
  fail_unless(t.has_value() && t->boards.size() == 1);
  for (std::size_t i = 0; i < 3; ++i) {
    fail_unless_equals_float(t->boards[0].camera_from_board.rotation[i],
                             0.1 * static_cast<double>(i + 1));
    fail_unless_equals_float(t->boards[0].camera_from_board.translation[i],
                             static_cast<double>(i + 1));
  }
  fail_unless_equals_float(t->boards[0].observation.uv[0].v, 20);
  g_autoptr(GstBuffer) bare = gst_buffer_new();
  fail_if(gst::read_guidance(bare).has_value());
}
GST_END_TEST;

// Anybody may write a map: what is none is as if it were not there.
GST_START_TEST(test_a_map_is_rows_of_equal_length) {
  const std::string wide(65, '1');
  const char* const kNone[] = {"", " ", "11 1", "1  1", "11 ", wide.c_str()};
  g_autoptr(GstBuffer) buffer = gst_buffer_new();
  gst::attach_guidance(buffer, {});
  const auto columns = [&](const char* text) {
    GstCustomMeta* meta = gst_buffer_get_custom_meta(buffer, gst::kGuidanceName);
    gst_structure_set(gst_custom_meta_get_structure(meta), "coverage-map", G_TYPE_STRING, text,
                      nullptr);
    return gst::read_guidance(buffer)->coverage_map.columns;
  };
  for (const char* text : kNone) fail_unless_equals_int(columns(text), 0);
  fail_unless_equals_int(columns("x"), 1);
  fail_unless_equals_int(columns("10 01 11"), 2);
}
GST_END_TEST;

// Programs that know the name of ROS alone write and read that one.
GST_START_TEST(test_tilt_is_skew_too) {
  g_autoptr(GstBuffer) buffer = gst_buffer_new();
  Progress progress;
  progress.tilt = 0.5;
  gst::attach_guidance(buffer, progress);
  GstStructure* s =
      gst_custom_meta_get_structure(gst_buffer_get_custom_meta(buffer, gst::kGuidanceName));
  for (const char* field : {"skew", "tilt"}) {
    double value = 0;
    fail_unless(gst_structure_get_double(s, field, &value));
    fail_unless_equals_float(value, 0.5);
  }
  gst_structure_remove_field(s, "tilt");
  gst_structure_set(s, "skew", G_TYPE_DOUBLE, 0.25, nullptr);
  fail_unless_equals_float(gst::read_guidance(buffer)->tilt, 0.25);
}
GST_END_TEST;

static Suite* metas_suite() {
  Suite* suite = suite_create("metas");
  TCase* tc = tcase_create("general");
  tcase_add_checked_fixture(tc, gst::register_metas, nullptr);
  tcase_add_test(tc, test_observation_round_trip);
  tcase_add_test(tc, test_lists_of_different_lengths_are_no_observation);
  tcase_add_test(tc, test_patches_without_pixels_are_none);
  tcase_add_test(tc, test_scaling_scales_the_corners);
  tcase_add_test(tc, test_cropping_drops_the_corners);
  tcase_add_test(tc, test_guidance_and_ground_truth_round_trip);
  tcase_add_test(tc, test_a_map_is_rows_of_equal_length);
  tcase_add_test(tc, test_tilt_is_skew_too);
  suite_add_tcase(suite, tc);
  return suite;
}

GST_CHECK_MAIN(metas)
