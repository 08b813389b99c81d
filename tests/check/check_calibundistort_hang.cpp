// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibundistort: a calibration on a disk or a network that does not answer. Frames go on, and so
// do changes of state and of the property. What would hang does not end by itself: whoever waits
// for it ends with the time limit of the test.

#include <sys/stat.h>

#include "hung_files.hpp"
#include "undistort_fixture.hpp"

#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>

using namespace calvin;
using namespace calvin::check;

// Looks at a frame every 10 ms: each looks as `now`, until something is done, or one looks as
// `later`.
struct Viewer {
  // The first frame has that calibration.
  Viewer(Fixture& fixture, const char* calibration) : f(fixture) {
    g_object_set(f.element, "calibration", calibration, nullptr);
    f.set_caps("GRAY8", kSize);
    fail_unless(look() == expected_gray(calibration, kSize));
  }

  std::vector<guint8> look() {
    g_autoptr(GstBuffer) out = f.push(kSize, n++);
    g_usleep(10000);
    return gray_of(out, kSize);
  }
  template <typename Done>
  void watch_until(const std::vector<guint8>& now, Done done) {
    while (!done()) fail_unless(look() == now);
  }
  void watch_change(const std::vector<guint8>& now, const std::vector<guint8>& later) {
    for (;;) {
      const auto picture = look();
      if (picture == later) return;
      fail_unless(picture == now);
    }
  }

  Fixture& f;
  int n = 0;
};

struct Pictures {
  std::vector<guint8> barrel = expected_gray(kBarrel, kSize);
  std::vector<guint8> pincushion = expected_gray(kPincushion, kSize);
};

GST_START_TEST(test_a_file_that_is_named_and_does_not_answer_stops_nothing) {
  const Pictures pictures;
  check::TemporaryFolder folder;
  const std::string path = folder / "hung.json";
  fail_unless(write_calibration(path, calibration_of(kPincushion)).has_value());
  Fixture f("calibundistort");
  Viewer viewer(f, kBarrel);
  down = true;
  g_object_set(f.element, "calibration", path.c_str(), nullptr);
  viewer.watch_until(pictures.barrel, is_waiting);
  for (int i = 0; i < 20; ++i) fail_unless(viewer.look() == pictures.barrel);
  if (__i__ == 0) {
    fail_unless(gst_element_set_state(f.element, GST_STATE_NULL) == GST_STATE_CHANGE_SUCCESS);
    down = false;
  } else {
    down = false;
    viewer.watch_change(pictures.barrel, pictures.pincushion);
  }
}
GST_END_TEST;

GST_START_TEST(test_another_calibration_is_taken_in_meanwhile) {
  const Pictures pictures;
  check::TemporaryFolder folder;
  const std::string here = folder / "here.json";
  fail_unless(write_calibration(here, calibration_of(kPincushion)).has_value());
  Fixture f("calibundistort");
  Viewer viewer(f, kBarrel);
  down = true;
  g_object_set(f.element, "calibration", (folder / "hung.json").c_str(), nullptr);
  viewer.watch_until(pictures.barrel, is_waiting);
  const char* next = __i__ == 0 ? kPincushion : here.c_str();
  g_object_set(f.element, "calibration", next, nullptr);
  viewer.watch_change(pictures.barrel, pictures.pincushion);
  down = false;
}
GST_END_TEST;

GST_START_TEST(test_a_server_that_goes_down_later_stops_nothing) {
  const Pictures pictures;
  check::TemporaryFolder folder;
  const std::string path = folder / "hung.json";
  fail_unless(write_calibration(path, calibration_of(kBarrel)).has_value());
  Fixture f("calibundistort");
  Viewer viewer(f, kPincushion);
  g_object_set(f.element, "calibration", path.c_str(), nullptr);
  viewer.watch_change(pictures.pincushion, pictures.barrel);
  fail_unless(write_calibration(path, calibration_of(kPincushion)).has_value());
  down = true;
  viewer.watch_until(pictures.barrel, is_waiting);
  for (int i = 0; i < 20; ++i) fail_unless(viewer.look() == pictures.barrel);
  down = false;
  viewer.watch_change(pictures.barrel, pictures.pincushion);
}
GST_END_TEST;

// What is no regular file is not waited for at all.
GST_START_TEST(test_a_pipe_is_refused) {
  check::TemporaryFolder folder;
  const std::string path = folder / "pipe";
  fail_unless_equals_int(mkfifo(path.c_str(), 0600), 0);
  const auto texts = errors_at_start("calibundistort", "calibration", path.c_str());
  fail_unless(texts.size() == 1 && texts[0].find("not a regular file") != std::string::npos);
  Fixture f("calibundistort");
  Viewer viewer(f, kBarrel);
  g_object_set(f.element, "calibration", path.c_str(), nullptr);
  viewer.watch_until(expected_gray(kBarrel, kSize),
                     [&] { return f.bus.says(GST_MESSAGE_WARNING, "not a regular file"); });
}
GST_END_TEST;

// The one that is named before the start is read before the first frame, however long that takes.
GST_START_TEST(test_the_first_frame_has_the_file_that_was_named_before) {
  check::TemporaryFolder folder;
  const std::string path = folder / "cam.json";
  fail_unless(write_calibration(path, calibration_of(kBarrel)).has_value());
  Fixture f("calibundistort");
  gst_element_set_state(f.element, GST_STATE_NULL);
  g_object_set(f.element, "calibration", path.c_str(), nullptr);
  gst_element_set_state(f.element, GST_STATE_PLAYING);
  f.set_caps("GRAY8", kSize);
  g_autoptr(GstBuffer) out = f.push(kSize);
  fail_unless(gray_of(out, kSize) == expected_gray(kBarrel, kSize));
}
GST_END_TEST;

static Suite* calibundistort_hang_suite() {
  Suite* suite = suite_create("calibundistort_hang");
  TCase* tc = tcase_create("general");
  tcase_add_loop_test(tc, test_a_file_that_is_named_and_does_not_answer_stops_nothing, 0, 2);
  tcase_add_loop_test(tc, test_another_calibration_is_taken_in_meanwhile, 0, 2);
  tcase_add_test(tc, test_a_server_that_goes_down_later_stops_nothing);
  tcase_add_test(tc, test_a_pipe_is_refused);
  tcase_add_test(tc, test_the_first_frame_has_the_file_that_was_named_before);
  suite_add_tcase(suite, tc);
  return suite;
}

GST_CHECK_MAIN(calibundistort_hang)
