// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Unpacks each row, turns it and packs it again, which GStreamer can do for any format. Rows that
// share their chroma are no trouble: it is written with the first of them alone.

#include "overlay/mirror_frame.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <vector>

namespace calvin::gst {

namespace {

template <typename PixelType>
void reverse(std::vector<std::uint8_t>& row, int left, int width) {
  auto* pixels = reinterpret_cast<PixelType*>(row.data());
  std::reverse(pixels + left, pixels + left + width);
}

// Of a palette the pixels are bytes, and no function packs them.
void mirror_bytes(GstVideoFrame& frame, int left, int width, int top, int height) {
  for (int y = top; y < top + height; ++y) {
    auto* row = static_cast<std::uint8_t*>(GST_VIDEO_FRAME_PLANE_DATA(&frame, 0)) +
                static_cast<std::ptrdiff_t>(y) * GST_VIDEO_FRAME_PLANE_STRIDE(&frame, 0);
    std::reverse(row + left, row + left + width);
  }
}

}  // namespace

void mirror_frame(GstVideoFrame& frame, const std::optional<FramePart>& part) {
  const GstVideoFormatInfo* format = frame.info.finfo;
  const int all = GST_VIDEO_FRAME_WIDTH(&frame);
  const int left = part ? part->x : 0;
  const int width = part ? part->size.width : all;
  const int top = part ? part->y : 0;
  const int height = part ? part->size.height : GST_VIDEO_FRAME_HEIGHT(&frame);
  if (GST_VIDEO_FORMAT_INFO_HAS_PALETTE(format)) {
    mirror_bytes(frame, left, width, top, height);
    return;
  }
  constexpr int kSpare = 64;  // pixels: functions of packed formats go on to the end of a group
  const GstVideoFormatInfo* unpacked = gst_video_format_get_info(format->unpack_format);
  const int step = GST_VIDEO_FORMAT_INFO_PSTRIDE(unpacked, 0);
  std::vector<std::uint8_t> row(static_cast<std::size_t>(all + kSpare) *
                                static_cast<std::size_t>(step));
  for (int y = top; y < top + height; ++y) {
    format->unpack_func(format, GST_VIDEO_PACK_FLAG_NONE, row.data(), frame.data, frame.info.stride,
                        0, y, all);
    if (step == 8) {
      reverse<std::uint64_t>(row, left, width);
    } else {
      reverse<std::uint32_t>(row, left, width);
    }
    format->pack_func(format, GST_VIDEO_PACK_FLAG_NONE, row.data(), 0, frame.data,
                      frame.info.stride, frame.info.chroma_site, y, all);
  }
}

}  // namespace calvin::gst
