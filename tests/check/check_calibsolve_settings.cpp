// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibsolve: where it starts from, what it holds, and settings that change while it runs.

#include <array>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <string>
#include <thread>

#include "calvin/io/board_names.hpp"
#include "calvin/io/calibration_io.hpp"
#include "solve_fixture.hpp"

#include <gst/check/gstcheck.h>

using namespace calvin;
using check::get;
using check::SolveFixture;

// The camera of the scene as text, its focal lengths times `factor`.
static std::string calibration_of(const Camera& camera, double factor = 1) {
  Calibration calibration = camera.to_calibration();
  calibration.parameters[0].value *= factor;
  calibration.parameters[1].value *= factor;
  return print_calibration(calibration).value();
}

static int views_of(const GstStructure* result) {
  int views = 0;
  gst_structure_get_int(result, "views", &views);
  return views;
}

GST_START_TEST(test_fix_holds_what_initial_says) {
  SolveFixture f;
  g_object_set(f.element, "initial", calibration_of(f.scene.camera, 1.01).c_str(), "fix",
               "fx,k1,aspect", nullptr);
  f.push_views(12);
  f.eos();
  const GstStructure* r = f.result("final");
  fail_unless(r != nullptr);
  const auto& truth = f.scene.camera.parameters();
  fail_unless_equals_float(get(r, "fx"), 1.01 * truth[0]);
  fail_unless_equals_float(get(r, "fy"), 1.01 * truth[1]);
  fail_unless_equals_float(get(r, "k1"), truth[4]);
  fail_if(std::abs(get(r, "k2") - truth[5]) < 1e-12);
}
GST_END_TEST;

GST_START_TEST(test_an_initial_calibration_is_scaled_to_the_frames) {
  SolveFixture f;
  const Camera half = f.scene.camera.scaled({320, 240});
  g_object_set(f.element, "initial", calibration_of(half).c_str(), "fix", "fx,fy,cx,cy", nullptr);
  f.push_views(12);
  f.eos();
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "(initial) is for 320x240"));
  const GstStructure* r = f.result("final");
  fail_unless(r != nullptr);
  fail_unless(std::abs(get(r, "fx") - f.scene.camera.fx()) < 1e-9);
  fail_unless(std::abs(get(r, "cx") - f.scene.camera.cx()) < 1e-9);
}
GST_END_TEST;

GST_START_TEST(test_an_initial_calibration_that_does_not_fit_is_left_out) {
  SolveFixture f("initial=fx=900,fy=900,cx=639.5,cy=359.5,width=1280,height=720");
  f.push_views(12);
  f.eos();
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "(initial) is not used"));
  fail_unless(f.result("final") != nullptr);
  for (const char* text : {"/no/such/file", "{"}) {
    const auto texts = check::errors_at_start("calibsolve", "initial", text);
    fail_unless(texts.size() == 1 && texts[0].find("(initial)") != std::string::npos, "%s", text);
  }
}
GST_END_TEST;

GST_START_TEST(test_another_model_solves_the_views_again) {
  SolveFixture f;
  f.push_views(10);
  g_object_set(f.element, "model", "brown4", "fix", "p1,p2", nullptr);
  gst_buffer_unref(f.push(10));
  f.eos();
  const GstStructure* r = f.result("final");
  fail_unless(r != nullptr);
  fail_unless_equals_string(gst_structure_get_string(r, "model"), "brown4");
  fail_unless_equals_float(get(r, "p1"), 0);
  fail_unless_equals_int(views_of(r), 11);
}
GST_END_TEST;

// Whether the board's curvature and the lens' skew are estimated is what the properties say, from
// the start and in the midst.
GST_START_TEST(test_warp_and_skew_are_estimated_where_they_are_asked_for) {
  const bool warp = __i__ % 2 == 1;
  const bool skew = __i__ / 2 % 2 == 1;
  // Which of them is set late.
  const bool late_warp = __i__ / 4 == 1;
  const bool late_skew = __i__ / 4 == 2;
  SolveFixture f(std::string("warp=") + (warp != late_warp ? "true" : "false") +
                 " skew=" + (skew != late_skew ? "true" : "false"));
  f.push_views(12);
  if (late_warp) g_object_set(f.element, "warp", warp, nullptr);
  if (late_skew) g_object_set(f.element, "skew", skew, nullptr);
  f.eos();
  const GstStructure* r = f.result("final");
  fail_unless(r != nullptr);
  fail_unless_equals_int(gst_structure_has_field(r, "skew"), skew);
  const auto c = parse_calibration(gst_structure_get_string(r, "json")).value();
  fail_unless_equals_int(c.warp.has_value(), warp);
  fail_unless_equals_int(c.find("skew") != nullptr, skew);
  fail_unless(!skew || c.find("skew")->sigma.value_or(0) > 0);
}
GST_END_TEST;

// A named board that was measured is where it was measured; what else is asked for of it is done.
GST_START_TEST(test_a_named_board_is_taken_as_it_was_measured) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "calvin-measured";
  std::filesystem::create_directories(folder);
  const std::string file = (folder / "boards.json").string();
  const bool late = __i__ % 2 == 1;
  const char* shape = std::array{"auto", "warp", "none"}[static_cast<std::size_t>(__i__ / 2)];
  SolveFixture f(std::string("board-shape=") + (late ? "points" : shape));
  BoardMeasurement measured = unmeasured(f.scene.board).value();
  measured.covariance *= 1e-6;
  fail_unless(add_board(file, "desk", f.scene.board.text()).has_value());
  fail_unless(store_measurement(file + "#desk", measured).has_value());
  g_object_set(f.element, "board", (file + "#desk").c_str(), nullptr);
  f.push_views(12);
  if (late) gst_util_set_object_arg(G_OBJECT(f.element), "board-shape", shape);
  f.eos();
  std::filesystem::remove_all(folder);
  const GstStructure* r = f.result("final");
  fail_unless(r != nullptr);
  const auto c = parse_calibration(gst_structure_get_string(r, "json")).value();
  fail_unless_equals_int(c.warp.has_value(), __i__ / 2 != 2);
  // What was measured is flat, and what is estimated is not.
  if (c.warp) fail_unless_equals_int(std::abs(c.warp->kx) < 1e-9, __i__ / 2 == 0);
}
GST_END_TEST;

GST_START_TEST(test_what_is_wrong_holds_up_nothing_else) {
  SolveFixture f;
  f.push_views(10);
  g_object_set(f.element, "model", "brown99", nullptr);
  gst_buffer_unref(f.push(10));
  g_object_set(f.element, "export", "pdf:a.pdf", nullptr);
  gst_buffer_unref(f.push(11));
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "'brown99' is not known"));
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "'pdf:a.pdf' is wrong"));
  g_object_set(f.element, "max-views", 12, nullptr);
  gst_buffer_unref(f.push(12));
  f.eos();
  const GstStructure* r = f.result("final");
  fail_unless(r != nullptr);
  fail_unless_equals_string(gst_structure_get_string(r, "model"), "brown5");
  fail_unless_equals_int(views_of(r), 12);
  // Each is said once.
  int said = 0;
  for (const auto& text : f.bus.texts(GST_MESSAGE_WARNING)) {
    said += text.find("brown99") != std::string::npos ? 1 : 0;
  }
  fail_unless_equals_int(said, 1);
}
GST_END_TEST;

// The signal comes from the application's thread; what was set just before it counts.
GST_START_TEST(test_solve_takes_what_was_set_just_before) {
  SolveFixture f;
  f.push_views(10);
  g_object_set(f.element, "model", "pinhole", nullptr);
  g_signal_emit_by_name(f.element, "solve");
  f.eos();
  const GstStructure* r = f.result("final");
  fail_unless(r != nullptr);
  fail_unless_equals_string(gst_structure_get_string(r, "model"), "pinhole");
}
GST_END_TEST;

GST_START_TEST(test_another_location_gets_the_result) {
  check::TemporaryFolder folder;
  SolveFixture f("location=" + (folder / "a.json"));
  f.push_views(10);
  g_object_set(f.element, "location", (folder / "b.json").c_str(), "export",
               ("ros:" + (folder / "b.yaml")).c_str(), nullptr);
  gst_buffer_unref(f.push(10));
  f.eos();
  fail_unless(f.bus.texts(GST_MESSAGE_ERROR).empty());
  const auto read = read_calibration(folder / "b.json");
  fail_unless(read.has_value());
  fail_unless_equals_int(read->views.size(), 11);
  fail_unless(std::filesystem::exists(folder / "b.yaml"));
}
GST_END_TEST;

// A view that comes while a final solve is under way belongs into the result at EOS.
GST_START_TEST(test_a_view_behind_a_final_solve_is_solved_at_eos) {
  for (int round = 0; round < 10; ++round) {
    SolveFixture f("capture-mode=all");
    f.push_views(12);
    g_signal_emit_by_name(f.element, "solve");
    gst_buffer_unref(f.push(12));
    f.eos();
    fail_unless_equals_int(views_of(f.result("final")), 13);
  }
}
GST_END_TEST;

// Every property, over and over, while frames flow and the worker solves.
GST_START_TEST(test_settings_change_under_way_from_another_thread) {
  check::TemporaryFolder folder;
  SolveFixture f;
  const std::string truth = calibration_of(f.scene.camera);
  const std::string files[] = {folder / "a.json", folder / "b.json"};
  std::atomic<bool> stop = false;
  std::thread other([&] {
    for (int i = 0; !stop; ++i) {
      const bool odd = i % 2 != 0;
      g_object_set(f.element, "model", odd ? "brown4" : "brown5", "fix", odd ? "aspect" : "k1=k2",
                   "initial", odd ? truth.c_str() : nullptr, "location", files[i % 2].c_str(),
                   "min-views", odd ? 3 : 4, "max-views", odd ? 0 : 500, "camera",
                   odd ? "one" : "two", nullptr);
      g_autofree char* json = nullptr;
      g_autoptr(GstStructure) stats = nullptr;
      g_object_get(f.element, "calibration", &json, "stats", &stats, nullptr);
      if (i % 16 == 0) g_signal_emit_by_name(f.element, "solve");
    }
  });
  f.push_views(40);
  stop = true;
  other.join();
  g_object_set(f.element, "model", "brown5", "fix", "", "initial", "", "location", files[0].c_str(),
               nullptr);
  f.eos();
  const GstStructure* r = f.result("final");
  fail_unless(r != nullptr);
  fail_unless_equals_string(gst_structure_get_string(r, "model"), "brown5");
  fail_unless_equals_int(views_of(r), 40);
  fail_unless_equals_int(read_calibration(files[0])->views.size(), 40);
}
GST_END_TEST;

static Suite* calibsolve_settings_suite() {
  Suite* suite = suite_create("calibsolve_settings");
  TCase* tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_checked_fixture(tc, gst::register_metas, nullptr);
  tcase_add_test(tc, test_fix_holds_what_initial_says);
  tcase_add_test(tc, test_an_initial_calibration_is_scaled_to_the_frames);
  tcase_add_test(tc, test_an_initial_calibration_that_does_not_fit_is_left_out);
  tcase_add_test(tc, test_another_model_solves_the_views_again);
  tcase_add_loop_test(tc, test_warp_and_skew_are_estimated_where_they_are_asked_for, 0, 12);
  tcase_add_loop_test(tc, test_a_named_board_is_taken_as_it_was_measured, 0, 6);
  tcase_add_test(tc, test_what_is_wrong_holds_up_nothing_else);
  tcase_add_test(tc, test_solve_takes_what_was_set_just_before);
  tcase_add_test(tc, test_another_location_gets_the_result);
  tcase_add_test(tc, test_a_view_behind_a_final_solve_is_solved_at_eos);
  tcase_add_test(tc, test_settings_change_under_way_from_another_thread);
  return suite;
}

GST_CHECK_MAIN(calibsolve_settings)
