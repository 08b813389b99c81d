// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibdetect and caliboverlay take every raw format there is, without a conversion before them,
// and calibtestsrc makes it.

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>

#include "calvin_config.h"
#include "support.hpp"

#include <gst/check/gstcheck.h>

using namespace calvin;

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

// Drawn before the tests, which are processes of their own: what is sent, and what the source
// makes.
static const GrayImage& picture() {
  static const GrayImage drawn = check::Scene().picture(3);
  return drawn;
}
static const GrayImage& made_picture() {
  static const GrayImage drawn = [] {
    const check::Scene scene;
    RenderOptions options = {.noise = 2, .blur = 1};
    options.seed = noise_seed(1, 0);
    return render_board(scene.camera, scene.board, scene.pose(0), options);
  }();
  return drawn;
}

GST_START_TEST(test_every_raw_format) {
  const std::string format = check::raw_formats()[static_cast<std::size_t>(__i__)];
  const check::Scene scene;
  GstBuffer* in = check::frame_of(picture(), format.c_str(), 0);
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
  const bool changed = pixels_of(drawn, format.c_str(), scene.size) != before;
  fail_unless(changed == (CALVIN_HAVE_CAIRO != 0), "%s was drawn on %s",
              changed ? "something" : "nothing", format.c_str());
  gst_harness_teardown(overlay);
  gst_harness_teardown(detect);
}
GST_END_TEST;

// Grey levels of as many bits as the format has, without colour and opaque, as GStreamer reads
// them.
template <typename Sample>
static void assert_gray(const GstVideoFrame& frame, const GrayImage& wanted) {
  const GstVideoFormatInfo* f = frame.info.finfo;
  const int bits = std::numeric_limits<Sample>::digits;
  const auto top = [&](Sample value, int depth) { return value >> (bits - std::min(depth, 8)); };
  std::vector<Sample> line(static_cast<std::size_t>(4 * (wanted.width + 64)));
  int wrong = 0;
  for (int y = 0; y < wanted.height; ++y) {
    f->unpack_func(f, GST_VIDEO_PACK_FLAG_TRUNCATE_RANGE, line.data(), frame.data,
                   frame.info.stride, 0, y, wanted.width);
    for (int x = 0; x < wanted.width; ++x) {
      const Sample* pixel = &line[static_cast<std::size_t>(4 * x)];
      const int level = wanted.pixels[static_cast<std::size_t>(y * wanted.width + x)];
      if (GST_VIDEO_FORMAT_INFO_N_COMPONENTS(f) > 3) {
        const int depth = static_cast<int>(GST_VIDEO_FORMAT_INFO_DEPTH(f, 3));
        wrong += top(pixel[0], depth) == (1 << std::min(depth, 8)) - 1 ? 0 : 1;
      }
      for (guint c = 0; c < std::min(GST_VIDEO_FORMAT_INFO_N_COMPONENTS(f), 3U); ++c) {
        const int depth = static_cast<int>(GST_VIDEO_FORMAT_INFO_DEPTH(f, c));
        const bool chroma = c > 0 && !GST_VIDEO_FORMAT_INFO_IS_RGB(f);
        const int want = (chroma ? 128 : level) >> (8 - std::min(depth, 8));
        wrong += top(pixel[c + 1], depth) == want ? 0 : 1;
      }
    }
  }
  fail_unless_equals_int(wrong, 0);
}

GST_START_TEST(test_the_source_makes_every_format) {
  const std::string format = check::formats_without_palette()[static_cast<std::size_t>(__i__)];
  const check::Scene scene;
  GstHarness* h = gst_harness_new_with_element(
      check::make_element("calibtestsrc seed=1 noise=2 blur=1"), nullptr, "src");
  gst_object_unref(h->element);
  g_autoptr(GstCaps) caps = check::caps_of(format.c_str(), scene.size);
  gst_harness_set_sink_caps(h, gst_caps_ref(caps));
  gst_harness_play(h);
  g_autoptr(GstBuffer) buffer = gst_harness_pull(h);
  GstVideoInfo info;
  fail_unless(gst_video_info_from_caps(&info, caps));
  GstVideoFrame frame;
  fail_unless(gst_video_frame_map(&frame, &info, buffer, GST_MAP_READ));
  const GrayImage& wanted = made_picture();
  const auto unpacked = info.finfo->unpack_format;
  if (unpacked == GST_VIDEO_FORMAT_AYUV64 || unpacked == GST_VIDEO_FORMAT_ARGB64) {
    assert_gray<std::uint16_t>(frame, wanted);
  } else {
    assert_gray<std::uint8_t>(frame, wanted);
  }
  gst_video_frame_unmap(&frame);
  gst_harness_teardown(h);
}
GST_END_TEST;

static Suite* raw_formats_suite() {
  gst::register_metas();
  (void)picture();
  (void)made_picture();
  Suite* suite = suite_create("raw_formats");
  TCase* tc = tcase_create("general");
  tcase_add_loop_test(tc, test_every_raw_format, 0, static_cast<int>(check::raw_formats().size()));
  tcase_add_loop_test(tc, test_the_source_makes_every_format, 0,
                      static_cast<int>(check::formats_without_palette().size()));
  suite_add_tcase(suite, tc);
  return suite;
}

GST_CHECK_MAIN(raw_formats)
