// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The mirror of caliboverlay: each format is turned left to right, and what is drawn with it.

// Ours first: check.h defines the macro `fail`.
#include "calvin_config.h"
#include "common/metas.hpp"
#include "support.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>
#include <gst/video/navigation.h>
#include <gst/video/video.h>

using namespace calvin;

namespace {

// A multiple of what any format groups.
constexpr int kWidth = 96;
constexpr int kHeight = 48;

GstHarness* overlay(const char* format, const char* properties) {
  GstHarness* h = check::harness_of(check::make_element(std::string("caliboverlay ") + properties));
  gst_harness_set_src_caps(h, check::caps_of(format, {kWidth, kHeight}));
  return h;
}

GstVideoInfo info_of(const char* format) {
  GstVideoInfo info;
  gst_video_info_set_format(&info, gst_video_format_from_string(format), kWidth, kHeight);
  return info;
}

// The bits of an unpacked pixel that a format has: GStreamer fills the others of Y210 in some
// pixels.
std::uint64_t bits_of(const GstVideoFormatInfo* format) {
  const auto channel =
      (0xffffU << (16 - std::min(16U, GST_VIDEO_FORMAT_INFO_DEPTH(format, 0)))) & 0xffffU;
  return 0x0001000100010001U * channel;
}

// The rows of a frame as GStreamer unpacks them, and packs them again where that is wanted.
std::vector<std::vector<std::uint64_t>> pixels_of(GstBuffer* buffer, const char* format,
                                                  bool repack = false) {
  const GstVideoInfo info = info_of(format);
  const GstVideoFormatInfo* f = info.finfo;
  GstVideoFrame frame;
  const GstMapFlags flags = repack ? GST_MAP_READWRITE : GST_MAP_READ;
  fail_unless(gst_video_frame_map(&frame, const_cast<GstVideoInfo*>(&info), buffer, flags));
  const GstVideoFormatInfo* unpacked = gst_video_format_get_info(f->unpack_format);
  const auto step = static_cast<std::size_t>(GST_VIDEO_FORMAT_INFO_PSTRIDE(unpacked, 0));
  std::vector<std::vector<std::uint64_t>> rows;
  std::vector<std::uint8_t> line((kWidth + 64) * step);
  for (int y = 0; y < kHeight; ++y) {
    f->unpack_func(f, GST_VIDEO_PACK_FLAG_NONE, line.data(), frame.data, frame.info.stride, 0, y,
                   kWidth);
    if (repack) {
      f->pack_func(f, GST_VIDEO_PACK_FLAG_NONE, line.data(), 0, frame.data, frame.info.stride,
                   frame.info.chroma_site, y, kWidth);
    }
    std::vector<std::uint64_t> row(kWidth);
    for (std::size_t x = 0; x < kWidth; ++x) {
      std::memcpy(&row[x], line.data() + x * step, step);
      if (step == 8) row[x] &= bits_of(f);
    }
    rows.push_back(row);
  }
  gst_video_frame_unmap(&frame);
  return rows;
}

// Packed once: bits that a format does not use are what GStreamer makes of them.
GstBuffer* random_frame(const char* format) {
  const GstVideoInfo info = info_of(format);
  GstBuffer* buffer = gst_buffer_new_allocate(nullptr, info.size, nullptr);
  std::mt19937 random(5);
  GstMapInfo map;
  gst_buffer_map(buffer, &map, GST_MAP_WRITE);
  for (gsize i = 0; i < map.size; ++i) map.data[i] = static_cast<guint8>(random());
  gst_buffer_unmap(buffer, &map);
  if (!GST_VIDEO_FORMAT_INFO_HAS_PALETTE(info.finfo)) pixels_of(buffer, format, true);
  return buffer;
}

}  // namespace

GST_START_TEST(test_every_format_is_mirrored) {
  auto formats = check::formats_without_palette();
  formats.emplace_back("RGB8P");
  for (const std::string& name : formats) {
    const char* format = name.c_str();
    GstHarness* h = overlay(format, "mirror=true");
    GstBuffer* in = random_frame(format);
    // One that another owns stays as it is.
    gst_buffer_ref(in);
    g_autoptr(GstBuffer) out = gst_harness_push_and_pull(h, in);
    auto before = pixels_of(in, format);
    fail_unless(out != in);
    fail_unless(before != pixels_of(out, format), "%s", format);
    for (auto& row : before) std::reverse(row.begin(), row.end());
    fail_unless(before == pixels_of(out, format), "%s", format);
    gst_buffer_unref(in);
    gst_harness_teardown(h);
  }
}
GST_END_TEST;

GST_START_TEST(test_without_it_the_buffer_itself_passes) {
  GstHarness* h = overlay("I420", "mirror=false");
  GstBuffer* in = random_frame("I420");
  g_autoptr(GstBuffer) out = gst_harness_push_and_pull(h, in);
  fail_unless(out == in);
  // It may change at any time.
  g_object_set(h->element, "mirror", TRUE, nullptr);
  g_autoptr(GstBuffer) kept = random_frame("I420");
  g_autoptr(GstBuffer) turned = gst_harness_push_and_pull(h, gst_buffer_ref(kept));
  fail_unless(turned != kept);
  gst_harness_teardown(h);
}
GST_END_TEST;

// A pointer over the left edge of the mirror is over the right edge of the picture.
GST_START_TEST(test_a_pointer_is_moved_back) {
  for (const bool mirror : {false, true}) {
    GstHarness* h = overlay("I420", mirror ? "mirror=true" : "mirror=false");
    while (GstEvent* event = gst_harness_try_pull_upstream_event(h)) gst_event_unref(event);
    gst_harness_push_upstream_event(
        h, gst_event_new_navigation(
               gst_structure_new("application/x-gst-navigation", "event", G_TYPE_STRING,
                                 "mouse-button-press", "button", G_TYPE_INT, 1, "pointer_x",
                                 G_TYPE_DOUBLE, 3.0, "pointer_y", G_TYPE_DOUBLE, 4.0, nullptr)));
    g_autoptr(GstEvent) event = gst_harness_pull_upstream_event(h);
    int button = 0;
    double x = 0;
    double y = 0;
    fail_unless(gst_navigation_event_parse_mouse_button_event(event, &button, &x, &y));
    fail_unless_equals_float(x, mirror ? kWidth - 1 - 3.0 : 3.0);
    fail_unless_equals_float(y, 4);
    gst_harness_teardown(h);
  }
}
GST_END_TEST;

#if CALVIN_HAVE_CAIRO
// The corner of a board on the left of the picture is drawn on the right of the mirror.
GST_START_TEST(test_what_is_drawn_is_mirrored_too) {
  GstHarness* h = check::harness_of(
      check::make_element("caliboverlay mirror=true coverage=false caption=false"));
  gst_harness_set_src_caps(h, check::caps_of("GRAY8", {320, 240}));
  GstBuffer* in = gst_buffer_new_allocate(nullptr, 320 * 240, nullptr);
  gst_buffer_memset(in, 0, 100, 320 * 240);
  Observation board;
  board.board = "checkerboard:3x2:25mm";
  board.image_size = {320, 240};
  board.ids = {0, 1, 3, 4};
  board.uv = {{20, 100}, {60, 100}, {20, 140}, {60, 140}};
  board.sigma = {0.1, 0.1, 0.1, 0.1};
  gst::attach_observations(in, std::vector{board});
  g_autoptr(GstBuffer) out = gst_harness_push_and_pull(h, in);
  GstMapInfo map;
  gst_buffer_map(out, &map, GST_MAP_READ);
  int left = 0;
  int right = 0;
  for (int i = 0; i < 320 * 240; ++i) {
    if (map.data[i] != 100) ++(i % 320 < 160 ? left : right);
  }
  gst_buffer_unmap(out, &map);
  fail_unless_equals_int(left, 0);
  fail_unless(right > 100);
  gst_harness_teardown(h);
}
GST_END_TEST;
#endif

static Suite* caliboverlay_mirror_suite() {
  Suite* suite = suite_create("caliboverlay_mirror");
  TCase* tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_checked_fixture(tc, gst::register_metas, nullptr);
  tcase_add_test(tc, test_every_format_is_mirrored);
  tcase_add_test(tc, test_without_it_the_buffer_itself_passes);
  tcase_add_test(tc, test_a_pointer_is_moved_back);
#if CALVIN_HAVE_CAIRO
  tcase_add_test(tc, test_what_is_drawn_is_mirrored_too);
#endif
  return suite;
}

GST_CHECK_MAIN(caliboverlay_mirror)
