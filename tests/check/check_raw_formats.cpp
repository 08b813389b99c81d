// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibdetect and caliboverlay take every raw format there is, without a conversion before them.

#include <cmath>
#include <string>
#include <string_view>

#include "support.hpp"

#include <gst/check/gstcheck.h>

using namespace calvin;

static std::vector<std::string> raw_formats() {
  guint count = 0;
  const GstVideoFormat* formats = gst_video_formats_raw(&count);
  std::vector<std::string> names;
  for (guint i = 0; i < count; ++i) {
    // DMA_DRM and its like are no pixels in memory.
    const GstVideoFormatInfo* info = gst_video_format_get_info(formats[i]);
    if (info->unpack_func != nullptr) names.emplace_back(GST_VIDEO_FORMAT_INFO_NAME(info));
  }
  return names;
}

// Of the frame as GStreamer unpacks it, so that padding does not count.
static std::vector<guint8> pixels_of(GstBuffer* buffer, const char* format, ImageSize size) {
  GstVideoInfo info;
  gst_video_info_set_format(&info, gst_video_format_from_string(format),
                            static_cast<guint>(size.width), static_cast<guint>(size.height));
  GstVideoFrame frame;
  fail_unless(gst_video_frame_map(&frame, &info, buffer, GST_MAP_READ));
  const GstVideoFormatInfo* unpacked = gst_video_format_get_info(info.finfo->unpack_format);
  const auto line = static_cast<std::size_t>(size.width) *
                    static_cast<std::size_t>(GST_VIDEO_FORMAT_INFO_PSTRIDE(unpacked, 0));
  std::vector<guint8> pixels(line * static_cast<std::size_t>(size.height));
  for (int y = 0; y < size.height; ++y) {
    info.finfo->unpack_func(info.finfo, GST_VIDEO_PACK_FLAG_NONE,
                            pixels.data() + line * static_cast<std::size_t>(y), frame.data,
                            frame.info.stride, 0, y, size.width);
  }
  gst_video_frame_unmap(&frame);
  return pixels;
}

GST_START_TEST(test_every_raw_format) {
  const std::string format = raw_formats()[static_cast<std::size_t>(__i__)];
  const check::Scene scene;
  GstBuffer* in = check::frame_of(scene.picture(3), format.c_str(), 0);
  const auto before = pixels_of(in, format.c_str(), scene.size);
  GstMemory* memory = gst_buffer_peek_memory(in, 0);

  GstHarness* detect = check::harness_of(check::make_element("calibdetect mode=sync"));
  gst_harness_set_src_caps(detect, check::caps_of(format.c_str(), scene.size));
  GstBuffer* found = gst_harness_push_and_pull(detect, in);
  fail_unless(gst_buffer_peek_memory(found, 0) == memory, "%s was copied", format.c_str());
  fail_unless(pixels_of(found, format.c_str(), scene.size) == before, "%s", format.c_str());
  const auto observations = gst::read_observations(found);
  fail_unless_equals_int(observations.size(), 1);
  const Observation truth = scene.truth(3);
  fail_unless(observations[0].ids == truth.ids, "%s: no board", format.c_str());
  for (std::size_t i = 0; i < truth.uv.size(); ++i) {
    const Pixel seen = observations[0].uv[i];
    fail_unless(std::hypot(seen.u - truth.uv[i].u, seen.v - truth.uv[i].v) < 0.3, "%s",
                format.c_str());
  }

  GstHarness* overlay = check::harness_of(check::make_element("caliboverlay"));
  gst_harness_set_src_caps(overlay, check::caps_of(format.c_str(), scene.size));
  g_autoptr(GstBuffer) drawn = gst_harness_push_and_pull(overlay, found);
  fail_unless(gst_buffer_peek_memory(drawn, 0) == memory, "%s was copied", format.c_str());
  fail_unless(pixels_of(drawn, format.c_str(), scene.size) != before, "nothing was drawn on %s",
              format.c_str());
  gst_harness_teardown(overlay);
  gst_harness_teardown(detect);
}
GST_END_TEST;

static Suite* raw_formats_suite() {
  gst::register_metas();
  Suite* suite = suite_create("raw_formats");
  TCase* tc = tcase_create("general");
  tcase_add_loop_test(tc, test_every_raw_format, 0, static_cast<int>(raw_formats().size()));
  suite_add_tcase(suite, tc);
  return suite;
}

GST_CHECK_MAIN(raw_formats)
