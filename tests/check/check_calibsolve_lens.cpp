// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibsolve device=NODE: where the lens stands is in the file; autofocus, a lens that is moved and
// a node that cannot be read are told, once, and stop nothing.

#include "calvin/io/calibration_io.hpp"
#include "calvin_config.h"
#include "fake_lens.hpp"
#include "solve_fixture.hpp"

#include <gst/check/gstcheck.h>

using namespace calvin;
using check::SolveFixture;

static constexpr const char* kDevice = "device=/dev/lens0 ";

static void set_up() {
  gst::register_metas();
  fake_lens::hangs = false;
  fake_lens::change([](fake_lens::Node& node) { node = {}; });
  fake_lens::set(V4L2_CID_FOCUS_AUTO, 0);
  fake_lens::set(V4L2_CID_FOCUS_ABSOLUTE, 30);
  fake_lens::set(V4L2_CID_ZOOM_ABSOLUTE, 120);
}

static void wait_for(SolveFixture& f, GstMessageType type, const char* part) {
  for (int i = 0; i < 3000 && !f.bus.says(type, part); ++i) g_usleep(10000);
  fail_unless(f.bus.says(type, part), "nobody says '%s'", part);
}

#if CALVIN_HAVE_V4L2

// Until the session knows of what was set before: the last of these readings begins when the one
// before it has been heard of.
static void wait_for_readings(int count = 2) {
  const int before = fake_lens::opened;
  for (int i = 0; i < 3000 && fake_lens::opened < before + count; ++i) g_usleep(10000);
  fail_unless(fake_lens::opened >= before + count, "the lens is not read");
}

// A harness is live, and its silence is told too.
static std::size_t count(check::Bus& bus, GstMessageType type, const char* part) {
  std::size_t found = 0;
  for (const std::string& text : bus.texts(type)) found += text.find(part) != std::string::npos;
  return found;
}

GST_START_TEST(test_the_file_and_the_message_hold_where_the_lens_stood) {
  check::TemporaryFolder folder;
  const std::string path = folder / "cam.json";
  SolveFixture f(kDevice + ("location=" + path));
  wait_for_readings();
  f.push_views(5);
  f.eos();
  const auto file = read_calibration(path);
  fail_unless(file.has_value());
  const auto message =
      parse_calibration(gst_structure_get_string(f.result("final"), "json")).value();
  for (const Calibration* c : {&*file, &message}) {
    fail_unless(c->focus == 30);
    fail_unless(c->zoom == 120);
    fail_unless(c->device.has_value());
    fail_unless_equals_string(c->device->node.c_str(), "/dev/lens0");
    fail_unless_equals_string(c->device->name.c_str(), "Fake camera");
    fail_unless(c->device->autofocus == false);
  }
  fail_unless(f.bus.texts(GST_MESSAGE_WARNING).empty());
}
GST_END_TEST;

GST_START_TEST(test_autofocus_is_told_once) {
  check::TemporaryFolder folder;
  const std::string path = folder / "cam.json";
  fake_lens::set(V4L2_CID_FOCUS_AUTO, 1);
  SolveFixture f(kDevice + ("location=" + path));
  wait_for(f, GST_MESSAGE_WARNING, "focus_automatic_continuous=0");
  f.push_views(5);
  wait_for_readings(3);
  fail_unless_equals_int(count(f.bus, GST_MESSAGE_WARNING, "Autofocus"), 1);
  fake_lens::set(V4L2_CID_FOCUS_AUTO, 0);
  wait_for(f, GST_MESSAGE_INFO, "is off");
  f.eos();
  const auto file = read_calibration(path);
  fail_unless(file.has_value() && !file->focus && file->zoom == 120);
  fail_unless_equals_int(count(f.bus, GST_MESSAGE_WARNING, "Autofocus"), 1);
}
GST_END_TEST;

// The calibration is of one place of the lens alone, or of none.
GST_START_TEST(test_a_lens_that_is_moved_is_told_once) {
  check::TemporaryFolder folder;
  const std::string path = folder / "cam.json";
  SolveFixture f(kDevice + ("location=" + path));
  wait_for_readings();
  f.push_views(5);
  wait_for_readings();
  fake_lens::set(V4L2_CID_FOCUS_ABSOLUTE, 80);
  wait_for(f, GST_MESSAGE_WARNING, "focus from 30 to 80");
  const bool with_view = __i__ == 1;
  if (with_view) gst_buffer_unref(f.push(5));
  wait_for_readings(3);
  fail_unless_equals_int(count(f.bus, GST_MESSAGE_WARNING, "focus from"), 1);
  fake_lens::set(V4L2_CID_FOCUS_ABSOLUTE, 30);
  wait_for(f, GST_MESSAGE_INFO, "is where it was");
  f.eos();
  const auto file = read_calibration(path);
  fail_unless(file.has_value() && file->zoom == 120);
  fail_unless(file->focus.has_value() != with_view);
}
GST_END_TEST;

// What a session before was told of does not silence the next run.
GST_START_TEST(test_the_next_run_begins_anew) {
  fake_lens::set(V4L2_CID_FOCUS_AUTO, 1);
  SolveFixture f(kDevice);
  for (std::size_t run = 1; run <= 3; ++run) {
    for (int i = 0; i < 3000 && count(f.bus, GST_MESSAGE_WARNING, "Autofocus") < run; ++i) {
      g_usleep(10000);
    }
    fail_unless_equals_int(count(f.bus, GST_MESSAGE_WARNING, "Autofocus"), run);
    gst_element_set_state(f.element, GST_STATE_READY);
    gst_element_set_state(f.element, GST_STATE_PLAYING);
  }
}
GST_END_TEST;

// A flush does not end the watch.
GST_START_TEST(test_a_flush_goes_on_watching) {
  SolveFixture f(kDevice);
  f.push_views(3);
  wait_for_readings();
  gst_harness_push_event(f.h, gst_event_new_flush_start());
  gst_harness_push_event(f.h, gst_event_new_flush_stop(TRUE));
  fake_lens::set(V4L2_CID_ZOOM_ABSOLUTE, 200);
  wait_for(f, GST_MESSAGE_WARNING, "zoom from 120 to 200");
}
GST_END_TEST;

GST_START_TEST(test_a_node_that_cannot_be_read_is_told_once_and_read_later) {
  check::TemporaryFolder folder;
  const std::string path = folder / "cam.json";
  fake_lens::change([](fake_lens::Node& node) { node.open_error = ENOENT; });
  SolveFixture f(kDevice + ("location=" + path));
  wait_for(f, GST_MESSAGE_WARNING, "'/dev/lens0' cannot be read");
  f.push_views(5);
  wait_for_readings(3);
  fail_unless_equals_int(count(f.bus, GST_MESSAGE_WARNING, "cannot be read"), 1);
  fake_lens::change([](fake_lens::Node& node) { node.open_error = 0; });
  wait_for(f, GST_MESSAGE_INFO, "is read again");
  f.eos();
  const auto file = read_calibration(path);
  fail_unless(file.has_value() && !file->focus, "nobody knows where it stood");
  fail_unless(f.bus.texts(GST_MESSAGE_ERROR).empty());
}
GST_END_TEST;

// Neither frames nor EOS nor a change of state wait for a driver.
GST_START_TEST(test_a_driver_that_does_not_answer_stops_nothing) {
  check::TemporaryFolder folder;
  const std::string path = folder / "cam.json";
  fake_lens::hangs = true;
  SolveFixture f(kDevice + ("location=" + path));
  while (fake_lens::hanging == 0) g_usleep(1000);
  f.push_views(5);
  if (__i__ == 0) wait_for(f, GST_MESSAGE_WARNING, "has not told its focus");
  f.eos();
  fail_unless(read_calibration(path).has_value());
  fail_unless(gst_element_set_state(f.element, GST_STATE_NULL) == GST_STATE_CHANGE_SUCCESS);
  fail_unless(gst_element_set_state(f.element, GST_STATE_PAUSED) == GST_STATE_CHANGE_SUCCESS);
  fail_unless(gst_element_set_state(f.element, GST_STATE_NULL) == GST_STATE_CHANGE_SUCCESS);
  fake_lens::hangs = false;
}
GST_END_TEST;

#else

GST_START_TEST(test_a_build_without_v4l2_says_so) {
  SolveFixture f(kDevice);
  wait_for(f, GST_MESSAGE_WARNING, "-Dv4l2=enabled");
  f.push_views(5);
  f.eos();
  fail_unless(f.result("final") != nullptr);
}
GST_END_TEST;

#endif

GST_START_TEST(test_without_a_device_nothing_is_read) {
  const int before = fake_lens::opened;
  SolveFixture f;
  f.push_views(5);
  g_usleep(1500000);
  f.eos();
  fail_unless_equals_int(fake_lens::opened, before);
}
GST_END_TEST;

GST_START_TEST(test_another_device_counts_from_the_next_start_on) {
  SolveFixture f;
  g_object_set(f.element, "device", "/dev/lens0", nullptr);
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "next start"));
  const int before = fake_lens::opened;
  f.push_views(5);
  g_usleep(1500000);
  fail_unless_equals_int(fake_lens::opened, before);
}
GST_END_TEST;

static Suite* calibsolve_lens_suite() {
  Suite* suite = suite_create("calibsolve_lens");
  TCase* tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_checked_fixture(tc, set_up, nullptr);
#if CALVIN_HAVE_V4L2
  tcase_add_test(tc, test_the_file_and_the_message_hold_where_the_lens_stood);
  tcase_add_test(tc, test_autofocus_is_told_once);
  tcase_add_loop_test(tc, test_a_lens_that_is_moved_is_told_once, 0, 2);
  tcase_add_test(tc, test_the_next_run_begins_anew);
  tcase_add_test(tc, test_a_flush_goes_on_watching);
  tcase_add_test(tc, test_a_node_that_cannot_be_read_is_told_once_and_read_later);
  tcase_add_loop_test(tc, test_a_driver_that_does_not_answer_stops_nothing, 0, 2);
#else
  tcase_add_test(tc, test_a_build_without_v4l2_says_so);
#endif
  tcase_add_test(tc, test_without_a_device_nothing_is_read);
  tcase_add_test(tc, test_another_device_counts_from_the_next_start_on);
  return suite;
}

GST_CHECK_MAIN(calibsolve_lens)
