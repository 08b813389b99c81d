// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The controls of the emulated camera, as a program sees them and as its picture shows them; and
// calibrate device=NODE beside a v4l2src that streams from the same node.

#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "calvin/io/calibration_io.hpp"
#include "calvin_config.h"
#include "film.hpp"

#include <gst/check/gstcheck.h>

using namespace calvin;

// One open() of the camera.
class OpenCamera {
 public:
  OpenCamera() : fd_(::open("/dev/video0", O_RDONLY | O_NONBLOCK | O_CLOEXEC)) {
    fail_unless(fd_ >= 0);
  }
  OpenCamera(const OpenCamera&) = delete;
  OpenCamera& operator=(const OpenCamera&) = delete;
  ~OpenCamera() { ::close(fd_); }

  // 0 or errno.
  template <typename T>
  int ask(unsigned long request, T& argument) const {
    return ::ioctl(fd_, request, &argument) == 0 ? 0 : errno;
  }
  int set(std::uint32_t id, int value) const {
    v4l2_control control{id, value};
    return ask(VIDIOC_S_CTRL, control);
  }
  int get(std::uint32_t id) const {
    v4l2_control control{id, -1};
    fail_unless_equals_int(ask(VIDIOC_G_CTRL, control), 0);
    return control.value;
  }
  std::uint32_t flags(std::uint32_t id) const {
    v4l2_queryctrl query{};
    query.id = id;
    fail_unless_equals_int(ask(VIDIOC_QUERYCTRL, query), 0);
    return query.flags;
  }

 private:
  int fd_;
};

GST_START_TEST(test_controls_are_enumerated_by_their_ids) {
  const OpenCamera camera;
  std::vector<std::string> names;
  v4l2_queryctrl query{};
  std::uint32_t last = 0;
  for (query.id = V4L2_CTRL_FLAG_NEXT_CTRL; camera.ask(VIDIOC_QUERYCTRL, query) == 0;
       query.id |= V4L2_CTRL_FLAG_NEXT_CTRL) {
    fail_unless(query.id > last);
    last = query.id;
    names.emplace_back(reinterpret_cast<const char*>(query.name));
  }
  const std::vector<std::string> all = {"Auto Exposure", "Exposure Time, Absolute",
                                        "Focus, Absolute", "Focus, Automatic Continuous",
                                        "Zoom, Absolute"};
  fail_unless(names == all);
  v4l2_query_ext_ctrl extended{};
  extended.id = V4L2_CID_ZOOM_ABSOLUTE;
  fail_unless_equals_int(camera.ask(VIDIOC_QUERY_EXT_CTRL, extended), 0);
  fail_unless(extended.minimum == 100 && extended.maximum == 500);
  query.id = V4L2_CID_BRIGHTNESS;
  fail_unless_equals_int(camera.ask(VIDIOC_QUERYCTRL, query), EINVAL);
  v4l2_querymenu menu{};
  menu.id = V4L2_CID_EXPOSURE_AUTO;
  menu.index = V4L2_EXPOSURE_APERTURE_PRIORITY;
  fail_unless_equals_int(camera.ask(VIDIOC_QUERYMENU, menu), 0);
  fail_unless_equals_string(reinterpret_cast<const char*>(menu.name), "Aperture Priority Mode");
  menu.index = V4L2_EXPOSURE_SHUTTER_PRIORITY;
  fail_unless_equals_int(camera.ask(VIDIOC_QUERYMENU, menu), EINVAL);
}
GST_END_TEST;

GST_START_TEST(test_all_that_have_it_open_share_its_controls) {
  const OpenCamera one;
  const OpenCamera other;
  fail_unless_equals_int(one.set(V4L2_CID_ZOOM_ABSOLUTE, 140), 0);
  fail_unless_equals_int(other.get(V4L2_CID_ZOOM_ABSOLUTE), 140);
  fail_unless_equals_int(one.set(V4L2_CID_ZOOM_ABSOLUTE, 9999), 0);
  fail_unless_equals_int(other.get(V4L2_CID_ZOOM_ABSOLUTE), 500);
  v4l2_ext_control values[2] = {};
  values[0].id = V4L2_CID_FOCUS_AUTO;
  values[1].id = V4L2_CID_FOCUS_ABSOLUTE;
  values[1].value = 77;
  v4l2_ext_controls all{};
  all.which = V4L2_CTRL_CLASS_CAMERA;
  all.count = 2;
  all.controls = values;
  fail_unless_equals_int(one.ask(VIDIOC_S_EXT_CTRLS, all), 0);
  fail_unless_equals_int(other.get(V4L2_CID_FOCUS_ABSOLUTE), 77);
  values[1].value = 0;
  fail_unless_equals_int(other.ask(VIDIOC_G_EXT_CTRLS, all), 0);
  fail_unless_equals_int(values[1].value, 77);
}
GST_END_TEST;

GST_START_TEST(test_a_position_is_inactive_while_it_is_automatic) {
  const OpenCamera camera;
  fail_unless_equals_int(camera.get(V4L2_CID_FOCUS_AUTO), 1);
  fail_unless(camera.flags(V4L2_CID_FOCUS_ABSOLUTE) == V4L2_CTRL_FLAG_INACTIVE);
  fail_unless_equals_int(camera.set(V4L2_CID_FOCUS_ABSOLUTE, 77), EACCES);
  fail_unless_equals_int(camera.set(V4L2_CID_FOCUS_AUTO, 0), 0);
  fail_unless(camera.flags(V4L2_CID_FOCUS_ABSOLUTE) == 0);
  fail_unless_equals_int(camera.set(V4L2_CID_FOCUS_ABSOLUTE, 77), 0);
}
GST_END_TEST;

GST_START_TEST(test_the_environment_says_where_they_stand_at_first) {
  g_setenv("CALVIN_V4L2_CONTROLS", "focus_automatic_continuous=0,focus_absolute=55", TRUE);
  const OpenCamera camera;
  fail_unless_equals_int(camera.get(V4L2_CID_FOCUS_AUTO), 0);
  fail_unless_equals_int(camera.get(V4L2_CID_FOCUS_ABSOLUTE), 55);
  fail_unless_equals_int(camera.get(V4L2_CID_ZOOM_ABSOLUTE), 100);
}
GST_END_TEST;

GST_START_TEST(test_a_camera_may_have_none) {
  g_setenv("CALVIN_V4L2_CONTROLS", "none", TRUE);
  const OpenCamera camera;
  v4l2_queryctrl query{};
  query.id = V4L2_CTRL_FLAG_NEXT_CTRL;
  fail_unless_equals_int(camera.ask(VIDIOC_QUERYCTRL, query), EINVAL);
}
GST_END_TEST;

// ---- calibrate device=/dev/video0 ---------------------------------------------------------------

#if CALVIN_HAVE_V4L2

// A pipeline that plays, and the words of its elements of one type.
class Playing {
 public:
  explicit Playing(const std::string& line)
      : pipeline_(gst_parse_launch(line.c_str(), nullptr)), bus_(gst_element_get_bus(pipeline_)) {
    gst_element_set_state(pipeline_, GST_STATE_PLAYING);
  }
  Playing(const Playing&) = delete;
  Playing& operator=(const Playing&) = delete;
  ~Playing() {
    gst_element_set_state(pipeline_, GST_STATE_NULL);
    gst_object_unref(bus_);
    gst_object_unref(pipeline_);
  }

  // The text of the next warning; "the end" at EOS.
  std::string next_warning() {
    g_autoptr(GstMessage) message = gst_bus_timed_pop_filtered(
        bus_, 60 * GST_SECOND,
        static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR | GST_MESSAGE_WARNING));
    fail_unless(message != nullptr);
    fail_if(GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR);
    if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS) return "the end";
    g_autoptr(GError) error = nullptr;
    gst_message_parse_warning(message, &error, nullptr);
    return error->message;
  }
  // Until one says so.
  void wait_for(const char* part) {
    for (std::string words; words.find(part) == std::string::npos;) {
      words = next_warning();
      fail_if(words == "the end", "nobody said '%s'", part);
    }
  }
  // Until a view was taken.
  void wait_for_view() {
    for (;;) {
      g_autoptr(GstMessage) message =
          gst_bus_timed_pop_filtered(bus_, 60 * GST_SECOND, GST_MESSAGE_ELEMENT);
      fail_unless(message != nullptr);
      const GstStructure* s = gst_message_get_structure(message);
      gboolean accepted = FALSE;
      if (gst_structure_has_name(s, "calib-view") &&
          gst_structure_get_boolean(s, "accepted", &accepted) && accepted) {
        return;
      }
    }
  }

 private:
  GstElement* pipeline_;
  GstBus* bus_;
};

// A zoom of 150 is half as much focal length again, in the calibration as in the picture.
GST_START_TEST(test_a_zoomed_camera_is_calibrated_and_its_lens_is_in_the_file) {
  g_autofree char* folder = g_dir_make_tmp("calvin-XXXXXX", nullptr);
  const std::string path = std::string(folder) + "/cam.json";
  {
    Playing p(
        "v4l2src num-buffers=500 extra-controls=\"c,focus_automatic_continuous=0,"
        "focus_absolute=30,zoom_absolute=150\" ! video/x-raw,width=640,height=480 ! calibrate "
        "overlay=false capture-mode=auto device=/dev/video0 location=" +
        path + " ! fakesink sync=false");
    fail_unless_equals_string(p.next_warning().c_str(), "the end");
  }
  const auto file = read_calibration(path);
  std::filesystem::remove_all(folder);
  fail_unless(file.has_value(), "%s", file ? "" : file.error().message.c_str());
  fail_unless(file->zoom == 150);
  fail_unless(file->focus == 30);
  fail_unless(file->device.has_value());
  fail_unless_equals_string(file->device->name.c_str(), "Emulated camera");
  const double truth = 1.5 * v4l2::film_camera({640, 480}).fx();
  const Parameter* focal_length = file->find("fx");
  fail_unless(focal_length != nullptr);
  const double fx = focal_length->value;
  fail_unless(std::abs(fx - truth) < 0.01 * truth, "fx is %g, not %g", fx, truth);
}
GST_END_TEST;

GST_START_TEST(test_autofocus_and_a_moved_zoom_are_told_while_it_streams) {
  Playing p(
      "v4l2src ! video/x-raw,width=640,height=480 ! calibrate overlay=false device=/dev/video0 ! "
      "fakesink sync=false");
  p.wait_for("Autofocus is on");
  p.wait_for_view();
  // So that the reading of the first view is heard of before the zoom moves.
  g_usleep(2 * G_USEC_PER_SEC);
  fail_unless_equals_int(OpenCamera().set(V4L2_CID_ZOOM_ABSOLUTE, 130), 0);
  p.wait_for("zoom from 100 to 130");
}
GST_END_TEST;

#endif

static Suite* v4l2_controls_suite() {
  Suite* suite = suite_create("v4l2_controls");
  TCase* tc = tcase_create("general");
  tcase_add_test(tc, test_controls_are_enumerated_by_their_ids);
  tcase_add_test(tc, test_all_that_have_it_open_share_its_controls);
  tcase_add_test(tc, test_a_position_is_inactive_while_it_is_automatic);
  tcase_add_test(tc, test_the_environment_says_where_they_stand_at_first);
  tcase_add_test(tc, test_a_camera_may_have_none);
#if CALVIN_HAVE_V4L2
  tcase_add_test(tc, test_a_zoomed_camera_is_calibrated_and_its_lens_is_in_the_file);
  tcase_add_test(tc, test_autofocus_and_a_moved_zoom_are_told_while_it_streams);
#endif
  suite_add_tcase(suite, tc);
  return suite;
}

GST_CHECK_MAIN(v4l2_controls)
