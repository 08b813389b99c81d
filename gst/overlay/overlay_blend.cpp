// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The library's overlay tiles onto frames: by the library where it knows the format, else by
// libgstvideo.

// Before GStreamer's headers.
#include "overlay/video_blend.hpp"

#include "overlay/overlay_blend.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <vector>

#include <gst/video/video-overlay-composition.h>

#include "calvin/draw/raster/tile_yuv.hpp"

namespace calvin::gst {

namespace {

// Chroma is shared by up to this many luma samples in any format with simple pixels.
constexpr int kAlignment = 4;

bool has_simple_pixels(const GstVideoFormatInfo* format) {
  return !GST_VIDEO_FORMAT_INFO_IS_COMPLEX(format) && !GST_VIDEO_FORMAT_INFO_IS_TILED(format) &&
         !GST_VIDEO_FORMAT_INFO_HAS_PALETTE(format);
}

// Whose samples libgstvideo's own functions do not read and write where the description of the
// format says, in all columns or in the last one of odd widths.
bool is_misdescribed(GstVideoFormat format) {
  constexpr GstVideoFormat kFormats[] = {GST_VIDEO_FORMAT_IYU1, GST_VIDEO_FORMAT_NV61,
                                         GST_VIDEO_FORMAT_VYUY};
  return std::ranges::find(kFormats, format) != std::end(kFormats);
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

bool blend_by_libgstvideo(GstVideoFrame* frame, const OverlayTile& drawn, int left, int top) {
  const OverlayTile tile = whole_tile(drawn);
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

}  // namespace

std::optional<PixelLayout> layout_of(const GstVideoInfo& info) {
  const GstVideoFormatInfo* format = info.finfo;
  const bool known = GST_VIDEO_FORMAT_INFO_IS_YUV(format) || GST_VIDEO_FORMAT_INFO_IS_RGB(format) ||
                     GST_VIDEO_FORMAT_INFO_IS_GRAY(format);
  if (!known || !has_simple_pixels(format) || GST_VIDEO_FORMAT_INFO_HAS_ALPHA(format) ||
      is_misdescribed(GST_VIDEO_INFO_FORMAT(&info))) {
    return {};
  }
  PixelLayout layout;
  layout.count = static_cast<int>(GST_VIDEO_FORMAT_INFO_N_COMPONENTS(format));
  layout.is_rgb = GST_VIDEO_FORMAT_INFO_IS_RGB(format);
  layout.size = {GST_VIDEO_INFO_WIDTH(&info), GST_VIDEO_INFO_HEIGHT(&info)};
  if (layout.count > 3) return {};
  for (int c = 0; c < layout.count; ++c) {
    if (GST_VIDEO_FORMAT_INFO_DEPTH(format, c) != 8 || GST_VIDEO_FORMAT_INFO_SHIFT(format, c) != 0)
      return {};
    layout.components.at(static_cast<std::size_t>(c)) = {
        static_cast<int>(GST_VIDEO_FORMAT_INFO_PLANE(format, c)),
        static_cast<int>(GST_VIDEO_FORMAT_INFO_POFFSET(format, c)),
        GST_VIDEO_FORMAT_INFO_PSTRIDE(format, c),
        static_cast<int>(GST_VIDEO_FORMAT_INFO_W_SUB(format, c)),
        static_cast<int>(GST_VIDEO_FORMAT_INFO_H_SUB(format, c))};
  }
  return layout;
}

void TileBlender::begin_frame(GstVideoFrame* frame, const std::optional<FramePart>& part) {
  frame_ = frame;
  left_ = part ? part->x : 0;
  top_ = part ? part->y : 0;
  const auto layout = layout_of(frame->info);
  has_layout_ = layout.has_value();
  if (!layout) return;
  stamps_.begin_frame(*layout);
  for (std::size_t plane = 0; plane < GST_VIDEO_FRAME_N_PLANES(frame); ++plane) {
    planes_.data.at(plane) = static_cast<std::uint8_t*>(GST_VIDEO_FRAME_PLANE_DATA(frame, plane));
    planes_.stride.at(plane) = GST_VIDEO_FRAME_PLANE_STRIDE(frame, plane);
  }
}

bool TileBlender::blend(const OverlayTile& tile) {
  const int left = left_ + tile.x;
  const int top = top_ + tile.y;
  if (!has_layout_) return blend_by_libgstvideo(frame_, tile, left, top);
  stamps_.blend(tile, left, top, planes_);
  return true;
}

}  // namespace calvin::gst
