// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibundistort device=NODE with a zoom table: frames follow the lens of the camera; a driver that
// does not answer, and a camera that does not tell, stop nothing.

#include <string>

#include "calvin_config.h"
#include "fake_lens.hpp"
#include "zoom_fixture.hpp"

#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>

using namespace calvin;
using namespace calvin::check;

static void set_up() {
  fake_lens::hangs = false;
  fake_lens::change([](fake_lens::Node& node) { node = {}; });
}

struct Viewer {
  explicit Viewer(const char* more = "") : f((std::string("calibundistort ") + more).c_str()) {
    g_object_set(f.element, "calibration", text_of(table).c_str(), nullptr);
    f.set_caps("GRAY8", kSize);
  }
  std::vector<guint8> look() {
    g_autoptr(GstBuffer) out = f.push(kSize, n++);
    return gray_of(out, kSize);
  }
  // Until a frame looks as with the lens there; the time limit of the test ends what never comes.
  void wait_for(double zoom) {
    while (look() != gray_at(table, zoom)) g_usleep(10000);
  }
  ZoomTable table = zoom_table();
  Fixture f;
  int n = 0;
};

static std::vector<guint8> untouched() {
  g_autoptr(GstBuffer) noise = Fixture::noise("GRAY8", kSize, 0);
  return gray_of(noise, kSize);
}

#if CALVIN_HAVE_V4L2

GST_START_TEST(test_frames_follow_the_lens) {
  fake_lens::set(V4L2_CID_ZOOM_ABSOLUTE, 150);
  Viewer v("device=/dev/lens0");
  for (const int zoom : {150, 420, 200}) {
    fake_lens::set(V4L2_CID_ZOOM_ABSOLUTE, zoom);
    v.wait_for(zoom);
  }
  fail_unless(v.f.bus.texts(GST_MESSAGE_WARNING).empty());
  // Who sets the position knows better.
  g_object_set(v.f.element, "zoom-position", 333.0, nullptr);
  fail_unless(v.look() == gray_at(v.table, 333));
  fake_lens::set(V4L2_CID_ZOOM_ABSOLUTE, 500);
  g_usleep(300000);
  fail_unless(v.look() == gray_at(v.table, 333));
}
GST_END_TEST;

GST_START_TEST(test_a_camera_without_a_zoom_is_told_once) {
  fake_lens::set(V4L2_CID_FOCUS_ABSOLUTE, 30);
  Viewer v("device=/dev/lens0");
  while (!v.f.bus.says(GST_MESSAGE_WARNING, "Set zoom-position")) {
    fail_unless(v.look() == untouched());
    g_usleep(10000);
  }
  g_usleep(300000);
  fail_unless(v.look() == untouched());
  fail_unless_equals_int(v.f.bus.texts(GST_MESSAGE_WARNING).size(), 1);
}
GST_END_TEST;

GST_START_TEST(test_a_node_that_cannot_be_read_is_told_once_and_read_later) {
  fake_lens::set(V4L2_CID_ZOOM_ABSOLUTE, 150);
  fake_lens::change([](fake_lens::Node& node) { node.open_error = ENOENT; });
  Viewer v("device=/dev/lens0");
  while (!v.f.bus.says(GST_MESSAGE_WARNING, "'/dev/lens0' cannot be read")) {
    fail_unless(v.look() == untouched());
    g_usleep(10000);
  }
  fake_lens::change([](fake_lens::Node& node) { node.open_error = 0; });
  v.wait_for(150);
  // Where it stood counts on while it cannot be read.
  fake_lens::change([](fake_lens::Node& node) { node.open_error = ENODEV; });
  while (!v.f.bus.says(GST_MESSAGE_WARNING, "as the lens stood")) {
    fail_unless(v.look() == gray_at(v.table, 150));
    g_usleep(10000);
  }
  fail_unless(v.look() == gray_at(v.table, 150));
}
GST_END_TEST;

// Neither frames nor a change of state wait for a driver.
GST_START_TEST(test_a_driver_that_does_not_answer_stops_nothing) {
  fake_lens::set(V4L2_CID_ZOOM_ABSOLUTE, 150);
  fake_lens::hangs = true;
  {
    Viewer v("device=/dev/lens0");
    while (fake_lens::hanging == 0) g_usleep(1000);
    for (int n = 0; n < 20; ++n) fail_unless(v.look() == untouched());
    fail_unless(v.f.bus.texts(GST_MESSAGE_WARNING).empty());
    if (__i__ == 0) {
      while (!v.f.bus.says(GST_MESSAGE_WARNING, "does not tell where its lens stands")) {
        v.look();
        g_usleep(20000);
      }
    }
    fail_unless(gst_element_set_state(v.f.element, GST_STATE_NULL) == GST_STATE_CHANGE_SUCCESS);
    fail_unless(gst_element_set_state(v.f.element, GST_STATE_PAUSED) == GST_STATE_CHANGE_SUCCESS);
    fail_unless(gst_element_set_state(v.f.element, GST_STATE_NULL) == GST_STATE_CHANGE_SUCCESS);
    fake_lens::hangs = false;
  }
}
GST_END_TEST;

#else

GST_START_TEST(test_a_build_without_v4l2_says_so) {
  Viewer v("device=/dev/lens0");
  while (!v.f.bus.says(GST_MESSAGE_WARNING, "-Dv4l2=enabled")) {
    fail_unless(v.look() == untouched());
    g_usleep(10000);
  }
}
GST_END_TEST;

#endif

GST_START_TEST(test_without_a_device_nothing_is_read) {
  const int before = fake_lens::opened;
  Viewer v("zoom-position=250");
  for (int n = 0; n < 5; ++n) {
    fail_unless(v.look() == gray_at(v.table, 250));
    g_usleep(50000);
  }
  fail_unless_equals_int(fake_lens::opened, before);
}
GST_END_TEST;

static Suite* calibundistort_zoom_device_suite() {
  Suite* suite = suite_create("calibundistort_zoom_device");
  TCase* tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_checked_fixture(tc, set_up, nullptr);
#if CALVIN_HAVE_V4L2
  tcase_add_test(tc, test_frames_follow_the_lens);
  tcase_add_test(tc, test_a_camera_without_a_zoom_is_told_once);
  tcase_add_test(tc, test_a_node_that_cannot_be_read_is_told_once_and_read_later);
  tcase_add_loop_test(tc, test_a_driver_that_does_not_answer_stops_nothing, 0, 2);
#else
  tcase_add_test(tc, test_a_build_without_v4l2_says_so);
#endif
  tcase_add_test(tc, test_without_a_device_nothing_is_read);
  return suite;
}

GST_CHECK_MAIN(calibundistort_zoom_device)
