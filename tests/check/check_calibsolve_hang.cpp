// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibsolve: files on a disk or a network that does not answer stop no frame, no signal and nobody
// who sets a property. What would hang does not end by itself: whoever waits for it ends with the
// time limit of the test.

#include "calvin/io/calibration_io.hpp"
#include "hung_files.hpp"
#include "solve_fixture.hpp"

#include <gst/check/gstcheck.h>

using namespace calvin;
using check::SolveFixture;

GST_START_TEST(test_a_file_that_is_named_and_does_not_answer_stops_nothing) {
  check::TemporaryFolder folder;
  const std::string path = folder / "hung.json";
  SolveFixture f;
  Calibration initial = f.scene.camera.to_calibration();
  initial.parameters[0].value *= 1.01;
  initial.parameters[1].value *= 1.01;
  fail_unless(write_calibration(path, initial).has_value());
  f.push_views(5);
  check::down = true;
  g_object_set(f.element, "initial", path.c_str(), "fix", "fx,fy", nullptr);
  int n = 5;
  while (!check::is_waiting()) {
    gst_buffer_unref(f.push(n++));
    g_usleep(10000);
  }
  for (const int end = n + 10; n < end; ++n) gst_buffer_unref(f.push(n));
  if (__i__ == 0) {
    fail_unless(gst_element_set_state(f.element, GST_STATE_NULL) == GST_STATE_CHANGE_SUCCESS);
    check::down = false;
    return;
  }
  check::down = false;
  if (__i__ == 1) f.eos();
  if (__i__ == 2) g_signal_emit_by_name(f.element, "solve");
  const double held = initial.parameters[0].value;
  for (;;) {
    const GstStructure* result = f.result("final");
    if (result != nullptr && check::get(result, "fx") == held) break;
    fail_unless(__i__ != 1, "the end does not wait for what was set before");
    g_usleep(10000);
  }
}
GST_END_TEST;

GST_START_TEST(test_what_is_set_meanwhile_is_not_overtaken) {
  check::TemporaryFolder folder;
  const std::string path = folder / "hung.json";
  SolveFixture f;
  fail_unless(write_calibration(path, f.scene.camera.to_calibration()).has_value());
  f.push_views(5);
  check::down = true;
  g_object_set(f.element, "initial", path.c_str(), "fix", "fx,fy", nullptr);
  int n = 5;
  while (!check::is_waiting()) {
    gst_buffer_unref(f.push(n++));
    g_usleep(10000);
  }
  g_object_set(f.element, "initial", "", "fix", "", "model", "brown4", nullptr);
  gst_buffer_unref(f.push(n++));
  check::down = false;
  f.eos();
  fail_unless_equals_string(gst_structure_get_string(f.result("final"), "model"), "brown4");
  fail_unless(f.bus.texts(GST_MESSAGE_WARNING).empty());
}
GST_END_TEST;

// Where the result is to go: named while frames flow, by whoever.
static constexpr const char* kPlaces[] = {"location", "export"};

static std::string place(const char* property, const std::string& path) {
  return (g_str_equal(property, "export") ? "calvin:" : "") + path;
}

static void wait_for_final(SolveFixture& f) {
  for (int i = 0; i < 3000 && f.result("final") == nullptr; ++i) g_usleep(10000);
  fail_unless(f.result("final") != nullptr);
}

GST_START_TEST(test_a_place_that_does_not_answer_stops_no_frame) {
  const char* property = kPlaces[__i__];
  check::TemporaryFolder folder;
  const std::string path = folder / "hung.json";
  SolveFixture f("min-views=4 location=" + folder / "first.json");
  f.push_views(3);
  check::down = true;
  g_object_set(f.element, property, place(property, path).c_str(), nullptr);
  int n = 3;
  while (!check::is_waiting()) {
    gst_buffer_unref(f.push(n++));
    g_usleep(10000);
  }
  for (const int end = n + 10; n < end; ++n) gst_buffer_unref(f.push(n));
  check::down = false;
  f.eos();
  const auto read = read_calibration(path);
  fail_unless(read.has_value() && static_cast<int>(read->views.size()) == n);
  fail_unless(f.bus.texts(GST_MESSAGE_WARNING).empty());
}
GST_END_TEST;

// What was set before the signal counts, though no frame comes any more.
GST_START_TEST(test_the_signal_solve_waits_for_no_place) {
  const char* property = kPlaces[__i__];
  check::TemporaryFolder folder;
  const std::string path = folder / "hung.json";
  SolveFixture f("location=" + folder / "first.json");
  f.push_views(5);
  check::down = true;
  g_object_set(f.element, property, place(property, path).c_str(), nullptr);
  g_signal_emit_by_name(f.element, "solve");
  while (!check::is_waiting()) g_usleep(1000);
  fail_unless(f.result("final") == nullptr);
  check::down = false;
  wait_for_final(f);
  fail_unless(read_calibration(path).has_value());
}
GST_END_TEST;

// Of what was named before nothing is asked again, whatever else is set.
GST_START_TEST(test_other_settings_do_not_wait_for_the_places) {
  check::TemporaryFolder folder;
  SolveFixture f(
      "min-views=100 location=" + folder / "hung.json export=ros:" + folder / "hung.yaml");
  f.push_views(3);
  check::down = true;
  g_object_set(f.element, "model", "brown4", "camera", "other", "max-views", 500, nullptr);
  for (int n = 3; n < 10; ++n) gst_buffer_unref(f.push(n));
  g_object_set(f.element, "export", "nonsense", nullptr);
  gst_buffer_unref(f.push(10));
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "'nonsense' is wrong"));
  fail_if(check::is_waiting());
  check::down = false;
}
GST_END_TEST;

// What is wrong is said once it is known.
GST_START_TEST(test_a_place_that_is_wrong_is_said_later) {
  check::TemporaryFolder folder;
  SolveFixture f("min-views=4");
  f.push_views(3);
  g_object_set(f.element, "location", (folder / "nothing/cam.json").c_str(), nullptr);
  gst_buffer_unref(f.push(3));
  for (int i = 0; i < 3000 && f.bus.texts(GST_MESSAGE_WARNING).empty(); ++i) g_usleep(10000);
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "Cannot write"));
  g_object_set(f.element, "location", (folder / "a.json").c_str(), "export",
               ("ros:" + folder / "./a.json").c_str(), nullptr);
  gst_buffer_unref(f.push(4));
  for (int i = 0; i < 3000 && !f.bus.says(GST_MESSAGE_WARNING, "twice"); ++i) g_usleep(10000);
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "twice"));
}
GST_END_TEST;

// What comes of settings while a flush keeps everybody silent is said after it.
GST_START_TEST(test_a_flush_loses_no_word_of_a_setting) {
  check::TemporaryFolder folder;
  SolveFixture f("min-views=100");
  f.push_views(3);
  check::down = true;
  g_object_set(f.element, "location", (folder / "hung/cam.json").c_str(), nullptr);
  int n = 3;
  while (!check::is_waiting()) {
    gst_buffer_unref(f.push(n++));
    g_usleep(10000);
  }
  gst_harness_push_event(f.h, gst_event_new_flush_start());
  check::down = false;
  g_usleep(200000);
  fail_unless(f.bus.texts(GST_MESSAGE_WARNING).empty());
  gst_harness_push_event(f.h, gst_event_new_flush_stop(TRUE));
  for (int i = 0; i < 1000 && f.bus.texts(GST_MESSAGE_WARNING).empty(); ++i) g_usleep(10000);
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "Cannot write"));
}
GST_END_TEST;

static Suite* calibsolve_hang_suite() {
  Suite* suite = suite_create("calibsolve_hang");
  TCase* tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_checked_fixture(tc, gst::register_metas, nullptr);
  tcase_add_loop_test(tc, test_a_file_that_is_named_and_does_not_answer_stops_nothing, 0, 3);
  tcase_add_test(tc, test_what_is_set_meanwhile_is_not_overtaken);
  tcase_add_loop_test(tc, test_a_place_that_does_not_answer_stops_no_frame, 0, 2);
  tcase_add_loop_test(tc, test_the_signal_solve_waits_for_no_place, 0, 2);
  tcase_add_test(tc, test_other_settings_do_not_wait_for_the_places);
  tcase_add_test(tc, test_a_place_that_is_wrong_is_said_later);
  tcase_add_test(tc, test_a_flush_loses_no_word_of_a_setting);
  return suite;
}

GST_CHECK_MAIN(calibsolve_hang)
