// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Room behind a frame for what GStreamer's functions read and write beyond it.

#include "common/frames/padded_frame.hpp"

#include <cstring>

namespace calvin::gst {

namespace {

std::size_t bytes_of(const GstVideoInfo& info, guint plane) {
  GstVideoInfo plain;
  gst_video_info_set_interlaced_format(&plain, GST_VIDEO_INFO_FORMAT(&info),
                                       GST_VIDEO_INFO_INTERLACE_MODE(&info),
                                       static_cast<guint>(GST_VIDEO_INFO_WIDTH(&info)),
                                       static_cast<guint>(GST_VIDEO_INFO_HEIGHT(&info)));
  return static_cast<std::size_t>(plane_bytes(info, plain, plane).value_or(0));
}

}  // namespace

bool needs_padding(const GstVideoInfo& info) {
  const GstVideoFormatInfo* f = info.finfo;
  const int shared = 1 << GST_VIDEO_FORMAT_INFO_W_SUB(f, 1);
  return GST_VIDEO_FORMAT_INFO_N_COMPONENTS(f) > 1 && GST_VIDEO_FORMAT_INFO_PSTRIDE(f, 0) == 0 &&
         GST_VIDEO_INFO_WIDTH(&info) % shared != 0;
}

std::optional<std::int64_t> plane_bytes(const GstVideoInfo& info, const GstVideoInfo& plain,
                                        guint plane) {
  const std::int64_t stride = GST_VIDEO_INFO_PLANE_STRIDE(&info, plane);
  const std::int64_t least = GST_VIDEO_INFO_PLANE_STRIDE(&plain, plane);
  if (!GST_VIDEO_FORMAT_INFO_IS_TILED(info.finfo)) {
    if (stride < least) return std::nullopt;
    return stride * (GST_VIDEO_INFO_COMP_HEIGHT(&info, plane) - 1) + least;
  }
  if (GST_VIDEO_TILE_X_TILES(stride) < GST_VIDEO_TILE_X_TILES(least) ||
      GST_VIDEO_TILE_Y_TILES(stride) < GST_VIDEO_TILE_Y_TILES(least)) {
    return std::nullopt;
  }
  const auto tiles = [](std::int64_t s) {
    return GST_VIDEO_TILE_X_TILES(s) * GST_VIDEO_TILE_Y_TILES(s);
  };
  const bool is_last = plane + 1 == GST_VIDEO_INFO_N_PLANES(&plain);
  const gsize end = is_last ? plain.size : plain.offset[plane + 1];
  return static_cast<std::int64_t>(end - plain.offset[plane]) / tiles(least) * tiles(stride);
}

PaddedFrame::PaddedFrame(const GstVideoFrame& frame) : frame_(frame) {
  std::size_t begins[GST_VIDEO_MAX_PLANES] = {};
  std::size_t size = 0;
  for (guint p = 0; p < GST_VIDEO_FRAME_N_PLANES(&frame); ++p) {
    begins[p] = size;
    // Whole words, as the rows of some formats are.
    size += (bytes_of(frame.info, p) / kPadding + 2) * kPadding;
  }
  memory_.resize(size);
  for (guint p = 0; p < GST_VIDEO_FRAME_N_PLANES(&frame); ++p) {
    frame_.data[p] = memory_.data() + begins[p];
    std::memcpy(frame_.data[p], frame.data[p], bytes_of(frame.info, p));
  }
}

void PaddedFrame::copy_to(const GstVideoFrame& frame) const {
  for (guint p = 0; p < GST_VIDEO_FRAME_N_PLANES(&frame); ++p) {
    std::memcpy(frame.data[p], frame_.data[p], bytes_of(frame.info, p));
  }
}

}  // namespace calvin::gst
