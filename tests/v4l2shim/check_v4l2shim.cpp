// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The emulated camera, through the real v4l2src: formats, frames, timestamps, state changes, and
// that the picture shows the board where the film says.

#include "calvin_config.h"
#include "film.hpp"

#if CALVIN_HAVE_OPENCV
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#endif

#include <linux/videodev2.h>

#include <gst/check/gstcheck.h>
#include <gst/video/video.h>

using namespace calvin;

static constexpr int kBuffers = 8;

struct Seen {
  int buffers = 0;
  bool in_order = true;
  GstClockTime last = GST_CLOCK_TIME_NONE;
  GstSample* sample = nullptr;  // the first
};

static GstPadProbeReturn look(GstPad* pad, GstPadProbeInfo* info, gpointer data) {
  auto* seen = static_cast<Seen*>(data);
  GstBuffer* buffer = GST_PAD_PROBE_INFO_BUFFER(info);
  if (seen->buffers++ == 0) {
    g_autoptr(GstCaps) caps = gst_pad_get_current_caps(pad);
    seen->sample = gst_sample_new(buffer, caps, nullptr, nullptr);
  } else {
    seen->in_order = seen->in_order && GST_BUFFER_PTS(buffer) > seen->last;
  }
  seen->last = GST_BUFFER_PTS(buffer);
  return GST_PAD_PROBE_OK;
}

// Plays to the end `times` times, back to READY in between; what arrived the last time.
static Seen play(const char* caps, const char* decoder, int times = 1) {
  g_autofree char* line = g_strdup_printf(
      "v4l2src num-buffers=%d ! %s %s ! fakesink name=sink sync=false", kBuffers, caps, decoder);
  GstElement* pipeline = gst_parse_launch(line, nullptr);
  fail_unless(pipeline != nullptr);
  g_autoptr(GstElement) sink = gst_bin_get_by_name(GST_BIN(pipeline), "sink");
  g_autoptr(GstPad) pad = gst_element_get_static_pad(sink, "sink");
  g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
  Seen seen;
  gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_BUFFER, look, &seen, nullptr);
  for (int i = 0; i < times; ++i) {
    g_clear_pointer(&seen.sample, gst_sample_unref);
    seen = {};
    gst_element_set_state(pipeline, GST_STATE_PLAYING);
    g_autoptr(GstMessage) message = gst_bus_timed_pop_filtered(
        bus, 30 * GST_SECOND, static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR));
    fail_unless(message != nullptr);
    fail_unless_equals_int(GST_MESSAGE_TYPE(message), GST_MESSAGE_EOS);
    fail_unless_equals_int(gst_element_set_state(pipeline, GST_STATE_READY),
                           GST_STATE_CHANGE_SUCCESS);
    fail_unless_equals_int(seen.buffers, kBuffers);
    fail_unless(seen.in_order);
  }
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(pipeline);
  return seen;
}

// The luma of a frame, taken out of its buffer.
static GrayImage luma(GstSample* sample) {
  GstVideoInfo info;
  fail_unless(gst_video_info_from_caps(&info, gst_sample_get_caps(sample)));
  GstVideoFrame frame;
  fail_unless(gst_video_frame_map(&frame, &info, gst_sample_get_buffer(sample), GST_MAP_READ));
  GrayImage image(GST_VIDEO_INFO_WIDTH(&info), GST_VIDEO_INFO_HEIGHT(&info));
  const auto* data = static_cast<const std::uint8_t*>(GST_VIDEO_FRAME_COMP_DATA(&frame, 0));
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      image.row(y)[x] = data[y * GST_VIDEO_FRAME_COMP_STRIDE(&frame, 0) +
                             x * GST_VIDEO_FRAME_COMP_PSTRIDE(&frame, 0)];
    }
  }
  gst_video_frame_unmap(&frame);
  return image;
}

// Where OpenCV finds the corners in the first frame, against where the film puts them.
static void check_picture(Seen& seen, ImageSize size, [[maybe_unused]] double tolerance) {
  const GrayImage image = luma(seen.sample);
  g_clear_pointer(&seen.sample, gst_sample_unref);
  fail_unless_equals_int(image.width, size.width);
  fail_unless_equals_int(image.height, size.height);
#if CALVIN_HAVE_OPENCV
  const v4l2::Film film(v4l2::pixel_formats().front(), size);
  const auto truth =
      true_observation(v4l2::film_camera(size), v4l2::film_board(), film.camera_from_board(0));
  const cv::Mat mat(image.height, image.width, CV_8U, const_cast<std::uint8_t*>(&image.pixels[0]));
  std::vector<cv::Point2f> corners;
  fail_unless(cv::findChessboardCornersSB(mat, {9, 6}, corners, cv::CALIB_CB_EXHAUSTIVE));
  fail_unless_equals_int(corners.size(), truth.uv.size());
  double worst = 0;
  for (const Pixel& uv : truth.uv) {
    double nearest = 1e9;
    for (const auto& c : corners) nearest = std::min(nearest, std::hypot(c.x - uv.u, c.y - uv.v));
    worst = std::max(worst, nearest);
  }
  fail_unless(worst < tolerance, "a corner is %.3f px off", worst);
#endif
}

GST_START_TEST(test_yuyv) {
  Seen seen = play("video/x-raw,format=YUY2,width=640,height=480", "");
  check_picture(seen, {640, 480}, 0.3);
}
GST_END_TEST;

GST_START_TEST(test_smaller) {
  Seen seen = play("video/x-raw,format=YUY2,width=320,height=240", "");
  check_picture(seen, {320, 240}, 0.3);
}
GST_END_TEST;

GST_START_TEST(test_other_formats) {
  g_setenv("CALVIN_V4L2_SIZES", "640x480,1920x1080", TRUE);
  g_setenv("CALVIN_V4L2_FORMATS", "NV12,GREY", TRUE);
  Seen seen = play("video/x-raw,format=NV12,width=1920,height=1080", "");
  check_picture(seen, {1920, 1080}, 0.3);
  seen = play("video/x-raw,format=GRAY8,width=640,height=480", "");
  check_picture(seen, {640, 480}, 0.3);
  g_unsetenv("CALVIN_V4L2_SIZES");
  g_unsetenv("CALVIN_V4L2_FORMATS");
}
GST_END_TEST;

GST_START_TEST(test_mjpg) {
  Seen seen = play("image/jpeg,width=640,height=480", "! jpegdec");
  check_picture(seen, {640, 480}, 0.4);
}
GST_END_TEST;

GST_START_TEST(test_state_cycles) {
  Seen seen = play("video/x-raw,width=640", "", 3);
  g_clear_pointer(&seen.sample, gst_sample_unref);
}
GST_END_TEST;

// A real file at another path stays what it is.
GST_START_TEST(test_no_other_device) {
  g_autoptr(GstElement) pipeline =
      gst_parse_launch("v4l2src device=/dev/video77 ! fakesink", nullptr);
  fail_unless_equals_int(gst_element_set_state(pipeline, GST_STATE_PLAYING),
                         GST_STATE_CHANGE_FAILURE);
  gst_element_set_state(pipeline, GST_STATE_NULL);
}
GST_END_TEST;

static Suite* v4l2shim_suite() {
  Suite* suite = suite_create("v4l2shim");
  TCase* tc = tcase_create("general");
  tcase_add_test(tc, test_yuyv);
  tcase_add_test(tc, test_smaller);
  tcase_add_test(tc, test_other_formats);
  tcase_add_test(tc, test_mjpg);
  tcase_add_test(tc, test_state_cycles);
  tcase_add_test(tc, test_no_other_device);
  suite_add_tcase(suite, tc);
  return suite;
}

GST_CHECK_MAIN(v4l2shim)
