// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibdetect: a `recheck` or a file of boards on a disk or a network that does not answer stops
// neither frames nor checks. What would hang does not end by itself: whoever waits for it ends with
// the time limit of the test.

#include "calvin/io/board_names.hpp"
#include "calvin/io/calibration_io.hpp"
#include "hung_files.hpp"
#include "support.hpp"

#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>

using namespace calvin;

// Holds the board on every frame against a calibration.
struct Checker {
  explicit Checker(const std::string& recheck)
      : element(check::make_element("calibdetect mode=sync recheck=" + recheck)),
        bus(element),
        h(check::harness_of(element)) {
    gst_harness_set_src_caps(h, check::caps_of("GRAY8", scene.size));
  }
  ~Checker() {
    bus.detach();
    gst_harness_teardown(h);
  }

  // How far the camera has moved, in px, after another frame.
  double look() {
    gst_harness_push(h, check::frame_of(scene.picture(n), "GRAY8", n));
    const auto checks = bus.named("calib-check");
    fail_unless_equals_int(checks.size(), ++n);
    double moved = -1;
    fail_unless(gst_structure_get_double(checks.back(), "moved", &moved));
    return moved;
  }

  check::Scene scene;
  GstElement* element;
  check::Bus bus;
  GstHarness* h;
  int n = 0;
};

struct Files {
  Files() {
    write(here, 1);
    write(hung, 1);
  }
  // The camera's own calibration, with the focal length times `factor`.
  static void write(const std::string& path, double factor) {
    Calibration calibration = check::Scene().camera.to_calibration();
    calibration.parameters[0].value *= factor;
    calibration.parameters[1].value *= factor;
    fail_unless(write_calibration(path, calibration).has_value());
  }

  check::TemporaryFolder folder;
  std::string here = folder / "here.json";
  std::string hung = folder / "hung.json";
};

// 2 % of the focal length are 8 px in the corners of the picture.
static constexpr double kFar = 4;

static void goes_on(Checker& checker) {
  while (!check::is_waiting()) fail_unless(checker.look() < kFar);
  for (int i = 0; i < 5; ++i) fail_unless(checker.look() < kFar);
}

GST_START_TEST(test_a_file_that_is_named_and_does_not_answer_stops_nothing) {
  Files files;
  Files::write(files.hung, 1.02);
  Checker checker(files.here);
  checker.look();
  check::down = true;
  g_object_set(checker.element, "recheck", files.hung.c_str(), nullptr);
  goes_on(checker);
  if (__i__ == 0) {
    fail_unless(gst_element_set_state(checker.element, GST_STATE_NULL) == GST_STATE_CHANGE_SUCCESS);
    check::down = false;
  } else {
    check::down = false;
    while (checker.look() < kFar) g_usleep(1000);
  }
}
GST_END_TEST;

GST_START_TEST(test_a_server_that_goes_down_later_stops_nothing) {
  Files files;
  Checker checker(files.hung);
  checker.look();
  Files::write(files.hung, 1.02);
  check::down = true;
  goes_on(checker);
  check::down = false;
  while (checker.look() < kFar) g_usleep(1000);
}
GST_END_TEST;

// Which board was looked for on the newest frame.
static std::string board_of_next(Checker& checker) {
  checker.look();
  return gst_structure_get_string(checker.bus.named("calib-check").back(), "board");
}

// The boards before are looked for until the names are known.
GST_START_TEST(test_a_file_of_boards_that_does_not_answer_stops_nothing) {
  Files files;
  const std::string names = files.folder / "hung_boards.json";
  fail_unless(add_board(names, "floor", "checkerboard:9x6:50mm").has_value());
  Checker checker(files.here);
  const std::string before = board_of_next(checker);
  check::down = true;
  g_object_set(checker.element, "board", (names + "#floor").c_str(), nullptr);
  goes_on(checker);
  fail_unless(board_of_next(checker) == before);
  if (__i__ == 0) {
    fail_unless(gst_element_set_state(checker.element, GST_STATE_NULL) == GST_STATE_CHANGE_SUCCESS);
    check::down = false;
  } else if (__i__ == 1) {
    check::down = false;
    while (board_of_next(checker) == before) g_usleep(1000);
  } else {
    // What is set later is not overtaken.
    const std::string other = "checkerboard:9x6:30mm";
    g_object_set(checker.element, "board", other.c_str(), nullptr);
    fail_unless(board_of_next(checker) == other);
    check::down = false;
    while (check::is_waiting()) g_usleep(1000);
    for (int i = 0; i < 20; ++i) {
      g_usleep(1000);
      fail_unless(board_of_next(checker) == other);
    }
  }
}
GST_END_TEST;

GST_START_TEST(test_a_name_that_is_wrong_is_said_later) {
  Files files;
  Checker checker(files.here);
  const std::string before = board_of_next(checker);
  g_object_set(checker.element, "board", (files.folder / "none.json#floor").c_str(), nullptr);
  while (!checker.bus.says(GST_MESSAGE_WARNING, "none.json")) {
    fail_unless(board_of_next(checker) == before);
    g_usleep(1000);
  }
}
GST_END_TEST;

static Suite* calibdetect_hang_suite() {
  Suite* suite = suite_create("calibdetect_hang");
  TCase* tc = tcase_create("general");
  tcase_add_loop_test(tc, test_a_file_that_is_named_and_does_not_answer_stops_nothing, 0, 2);
  tcase_add_test(tc, test_a_server_that_goes_down_later_stops_nothing);
  tcase_add_loop_test(tc, test_a_file_of_boards_that_does_not_answer_stops_nothing, 0, 3);
  tcase_add_test(tc, test_a_name_that_is_wrong_is_said_later);
  suite_add_tcase(suite, tc);
  return suite;
}

GST_CHECK_MAIN(calibdetect_hang)
