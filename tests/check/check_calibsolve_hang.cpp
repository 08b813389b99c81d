// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibsolve: an `initial` on a disk or a network that does not answer stops no frame. What would
// hang does not end by itself: whoever waits for it ends with the time limit of the test.

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

static Suite* calibsolve_hang_suite() {
  Suite* suite = suite_create("calibsolve_hang");
  TCase* tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_checked_fixture(tc, gst::register_metas, nullptr);
  tcase_add_loop_test(tc, test_a_file_that_is_named_and_does_not_answer_stops_nothing, 0, 3);
  tcase_add_test(tc, test_what_is_set_meanwhile_is_not_overtaken);
  return suite;
}

GST_CHECK_MAIN(calibsolve_hang)
