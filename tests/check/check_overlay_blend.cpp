// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Tiles on every raw format, beside GStreamer's own blending of the same pixels.

// Before GStreamer's headers.
#include "overlay/video_blend.hpp"

#include "overlay/overlay_blend.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include <gst/check/gstcheck.h>
#include <gst/video/video-overlay-composition.h>
#include <gst/video/video.h>

using namespace calvin;

namespace {

constexpr int kSpare = 64;  // bytes more in each row than the format needs

// libgstvideo takes the byte of RGBx that means nothing for alpha; 255 makes the two agree.
void fill_unused(const GstVideoInfo& info, std::vector<std::uint8_t>& bytes) {
  if (!GST_VIDEO_INFO_IS_RGB(&info) || GST_VIDEO_INFO_COMP_PSTRIDE(&info, 0) != 4) return;
  const int used = GST_VIDEO_INFO_COMP_POFFSET(&info, 0) + GST_VIDEO_INFO_COMP_POFFSET(&info, 1) +
                   GST_VIDEO_INFO_COMP_POFFSET(&info, 2);
  for (auto i = static_cast<std::size_t>(6 - used); i < bytes.size(); i += 4) bytes[i] = 255;
}

// Noise, in a buffer whose rows are longer than they need to be.
GstBuffer* noise(const GstVideoInfo& info, unsigned seed) {
  std::mt19937 random(seed);
  gsize offset[GST_VIDEO_MAX_PLANES] = {};
  gint stride[GST_VIDEO_MAX_PLANES] = {};
  gsize size = 0;
  for (guint p = 0; p < GST_VIDEO_INFO_N_PLANES(&info); ++p) {
    const gsize rows =
        (p + 1 < GST_VIDEO_INFO_N_PLANES(&info) ? info.offset[p + 1] : info.size) - info.offset[p];
    stride[p] = info.stride[p] + kSpare;
    offset[p] = size;
    size += rows / static_cast<gsize>(info.stride[p]) * static_cast<gsize>(stride[p]) + kSpare;
  }
  std::vector<std::uint8_t> bytes(size);
  for (auto& b : bytes) b = static_cast<std::uint8_t>(random());
  fill_unused(info, bytes);
  GstBuffer* buffer = gst_buffer_new_memdup(bytes.data(), bytes.size());
  gst_buffer_add_video_meta_full(buffer, GST_VIDEO_FRAME_FLAG_NONE, GST_VIDEO_INFO_FORMAT(&info),
                                 static_cast<guint>(info.width), static_cast<guint>(info.height),
                                 GST_VIDEO_INFO_N_PLANES(&info), offset, stride);
  return buffer;
}

// Colours of every alpha, with transparent and opaque stretches.
OverlayTile tile_at(int x, int y, int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  OverlayTile tile{x, y, width, height, {}};
  for (int i = 0; i < width * height; ++i) {
    const unsigned kind = static_cast<unsigned>(i / 23) % 3;
    const unsigned alpha = kind == 0 ? 0 : kind == 1 ? 255 : static_cast<unsigned>(random()) % 256;
    std::uint32_t argb = alpha << 24;
    for (const unsigned shift : {16U, 8U, 0U}) argb |= random() % 256 * alpha / 255 << shift;
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(&argb);
    tile.pixels.insert(tile.pixels.end(), bytes, bytes + 4);
  }
  return tile;
}

void blend_as_gstreamer(GstVideoFrame* frame, const OverlayTile& tile, int left, int top) {
  g_autoptr(GstBuffer) pixels = gst_buffer_new_memdup(tile.pixels.data(), tile.pixels.size());
  const auto width = static_cast<guint>(tile.width);
  const auto height = static_cast<guint>(tile.height);
  gst_buffer_add_video_meta(pixels, GST_VIDEO_FRAME_FLAG_NONE,
                            GST_VIDEO_OVERLAY_COMPOSITION_FORMAT_RGB, width, height);
  GstVideoOverlayRectangle* rectangle = gst_video_overlay_rectangle_new_raw(
      pixels, left, top, width, height, GST_VIDEO_OVERLAY_FORMAT_FLAG_PREMULTIPLIED_ALPHA);
  GstVideoOverlayComposition* composition = gst_video_overlay_composition_new(rectangle);
  gst_video_overlay_rectangle_unref(rectangle);
  fail_unless(gst_video_overlay_composition_blend(composition, frame));
  gst_video_overlay_composition_unref(composition);
}

// The largest difference of two frames' samples.
int difference(const GstVideoFrame& a, const GstVideoFrame& b) {
  int most = 0;
  for (guint c = 0; c < GST_VIDEO_FRAME_N_COMPONENTS(&a); ++c) {
    for (int y = 0; y < GST_VIDEO_FRAME_COMP_HEIGHT(&a, c); ++y) {
      for (int x = 0; x < GST_VIDEO_FRAME_COMP_WIDTH(&a, c); ++x) {
        const auto at = static_cast<std::ptrdiff_t>(y) * GST_VIDEO_FRAME_COMP_STRIDE(&a, c) +
                        static_cast<std::ptrdiff_t>(x) * GST_VIDEO_FRAME_COMP_PSTRIDE(&a, c);
        most = std::max(most, std::abs(GST_VIDEO_FRAME_COMP_DATA(&a, c)[at] -
                                       GST_VIDEO_FRAME_COMP_DATA(&b, c)[at]));
      }
    }
  }
  return most;
}

struct Place {
  int x, y, width, height;
};

// In the frame at even and odd places, over each of its edges, and beside it.
constexpr Place kPlaces[] = {{8, 4, 40, 24},   {9, 5, 37, 23},    {-7, -3, 40, 24},
                             {70, 40, 61, 37}, {-20, 11, 200, 5}, {3, -50, 1, 200},
                             {200, 8, 40, 24}, {16, -30, 40, 24}, {10, 7, 16, 1}};

void compare(GstVideoFormat format, int width, int height) {
  GstVideoInfo info;
  if (!gst_video_info_set_format(&info, format, static_cast<guint>(width),
                                 static_cast<guint>(height)) ||
      !gst::layout_of(info)) {
    return;
  }
  unsigned seed = 1;
  for (const Place& place : kPlaces) {
    ++seed;
    g_autoptr(GstBuffer) ours = noise(info, seed);
    g_autoptr(GstBuffer) theirs = noise(info, seed);
    const OverlayTile tile = tile_at(0, 0, place.width, place.height, seed);
    GstVideoFrame a;
    GstVideoFrame b;
    fail_unless(gst_video_frame_map(&a, &info, ours, GST_MAP_READWRITE));
    fail_unless(gst_video_frame_map(&b, &info, theirs, GST_MAP_READWRITE));
    gst::TileBlender blender;
    blender.begin_frame(&a, FramePart{{width, height}, place.x, place.y, {width, height}});
    fail_unless(blender.blend(tile));
    blend_as_gstreamer(&b, tile, place.x, place.y);
    const int most = difference(a, b);
    fail_unless(most <= 2, "%s %dx%d, tile at (%d, %d): %d", gst_video_format_to_string(format),
                width, height, place.x, place.y, most);
    gst_video_frame_unmap(&a);
    gst_video_frame_unmap(&b);
  }
}

}  // namespace

GST_START_TEST(test_every_format_is_as_gstreamer_has_it) {
  guint count = 0;
  const GstVideoFormat* formats = gst_video_formats_raw(&count);
  for (guint i = 0; i < count; ++i) {
    for (const int odd : {0, 1, 3}) compare(formats[i], 96 + odd, 64 + odd);
  }
}
GST_END_TEST;

// Those that cameras and decoders have, or the others would be tested in vain.
GST_START_TEST(test_usual_formats_are_blended_here) {
  for (const char* name : {"I420", "YV12", "Y42B", "Y444", "NV12", "NV21", "NV16", "YUY2", "UYVY",
                           "GRAY8", "RGB", "BGR", "RGBx", "BGRx", "xRGB", "xBGR"}) {
    GstVideoInfo info;
    fail_unless(gst_video_info_set_format(&info, gst_video_format_from_string(name), 64, 48));
    fail_unless(gst::layout_of(info).has_value(), "%s", name);
  }
}
GST_END_TEST;

// A tile that is known is converted once; it is where it is wanted all the same.
GST_START_TEST(test_a_known_tile_moves) {
  GstVideoInfo info;
  fail_unless(gst_video_info_set_format(&info, GST_VIDEO_FORMAT_NV12, 97, 65));
  OverlayTile tile = tile_at(0, 0, 40, 24, 5);
  tile.serial = next_tile_serial();
  gst::TileBlender blender;
  for (const Place& place : {kPlaces[0], kPlaces[0], kPlaces[1], kPlaces[2]}) {
    g_autoptr(GstBuffer) ours = noise(info, 3);
    g_autoptr(GstBuffer) theirs = noise(info, 3);
    GstVideoFrame a;
    GstVideoFrame b;
    fail_unless(gst_video_frame_map(&a, &info, ours, GST_MAP_READWRITE));
    fail_unless(gst_video_frame_map(&b, &info, theirs, GST_MAP_READWRITE));
    blender.begin_frame(&a, FramePart{{97, 65}, place.x, place.y, {97, 65}});
    fail_unless(blender.blend(tile));
    blend_as_gstreamer(&b, tile, place.x, place.y);
    fail_unless(difference(a, b) <= 2);
    gst_video_frame_unmap(&a);
    gst_video_frame_unmap(&b);
  }
}
GST_END_TEST;

static Suite* overlay_blend_suite() {
  Suite* suite = suite_create("overlay_blend");
  TCase* tc = tcase_create("general");
  tcase_add_test(tc, test_every_format_is_as_gstreamer_has_it);
  tcase_add_test(tc, test_usual_formats_are_blended_here);
  tcase_add_test(tc, test_a_known_tile_moves);
  suite_add_tcase(suite, tc);
  return suite;
}

GST_CHECK_MAIN(overlay_blend)
