// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The library's overlay tiles, blended by libgstvideo.

// Before GStreamer's headers.
#include "overlay/video_blend.hpp"

#include "overlay/overlay_blend.hpp"

#include <cstdint>
#include <vector>

#include <gst/video/video-overlay-composition.h>

#include "calvin/draw/tile_yuv.hpp"

namespace calvin::gst {

namespace {

// Chroma is shared by up to this many luma samples in any format with simple pixels.
constexpr int kAlignment = 4;

bool has_simple_pixels(const GstVideoFormatInfo* format) {
  return !GST_VIDEO_FORMAT_INFO_IS_COMPLEX(format) && !GST_VIDEO_FORMAT_INFO_IS_TILED(format) &&
         !GST_VIDEO_FORMAT_INFO_HAS_PALETTE(format);
}

// The part of a mapped frame that a tile at (left, top) covers, as a frame: gst_video_blend()
// converts whole lines, and lines of the tile's length are much cheaper. Borrows the map.
GstVideoFrame covered(const GstVideoFrame& frame, const OverlayTile& tile, int left, int top) {
  GstVideoFrame part = frame;
  const GstVideoFormatInfo* format = frame.info.finfo;
  part.info.width = tile.width;
  part.info.height = tile.height;
  for (guint plane = 0; plane < GST_VIDEO_FRAME_N_PLANES(&frame); ++plane) {
    gint components[GST_VIDEO_MAX_COMPONENTS];
    gst_video_format_info_component(format, plane, components);
    const gint c = components[0];
    const int x = left >> GST_VIDEO_FORMAT_INFO_W_SUB(format, c);
    const int y = top >> GST_VIDEO_FORMAT_INFO_H_SUB(format, c);
    part.data[plane] = static_cast<guint8*>(frame.data[plane]) +
                       static_cast<gssize>(y) * GST_VIDEO_FRAME_PLANE_STRIDE(&frame, plane) +
                       static_cast<gssize>(x) * GST_VIDEO_FORMAT_INFO_PSTRIDE(format, c);
  }
  return part;
}

}  // namespace

bool blend_tile(GstVideoFrame* frame, const OverlayTile& tile,
                const std::optional<FramePart>& part) {
  const int left = tile.x + (part ? part->x : 0);
  const int top = tile.y + (part ? part->y : 0);
  const bool is_rgb = GST_VIDEO_INFO_IS_RGB(&frame->info);
  const std::vector<std::uint8_t> ayuv = is_rgb ? std::vector<std::uint8_t>() : ayuv_of(tile);
  const std::vector<std::uint8_t>& bytes = is_rgb ? tile.pixels : ayuv;
  GstVideoInfo info;
  gst_video_info_set_format(
      &info,
      is_rgb ? GST_VIDEO_OVERLAY_COMPOSITION_FORMAT_RGB : GST_VIDEO_OVERLAY_COMPOSITION_FORMAT_YUV,
      static_cast<guint>(tile.width), static_cast<guint>(tile.height));
  if (is_rgb) {
    info.flags = static_cast<GstVideoFlags>(info.flags | GST_VIDEO_FLAG_PREMULTIPLIED_ALPHA);
  }
  g_autoptr(GstBuffer) pixels =
      gst_buffer_new_wrapped_full(GST_MEMORY_FLAG_READONLY, const_cast<std::uint8_t*>(bytes.data()),
                                  bytes.size(), 0, bytes.size(), nullptr, nullptr);
  GstVideoFrame source;
  if (!gst_video_frame_map(&source, &info, pixels, GST_MAP_READ)) return false;
  gboolean blended = FALSE;
  if (has_simple_pixels(frame->info.finfo) && left % kAlignment == 0 && top % kAlignment == 0) {
    GstVideoFrame under = covered(*frame, tile, left, top);
    blended = gst_video_blend(&under, &source, 0, 0, 1);
  } else {
    blended = gst_video_blend(frame, &source, left, top, 1);
  }
  gst_video_frame_unmap(&source);
  return blended != FALSE;
}

}  // namespace calvin::gst
