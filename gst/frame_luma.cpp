// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The luma of a frame of any raw format.

#include "frame_luma.hpp"

#include <cstring>

#include <fmt/format.h>

namespace calvin::gst {

namespace {

bool has_luma_in_place(const GstVideoInfo& info) {
  const GstVideoFormatInfo* f = info.finfo;
  return (GST_VIDEO_FORMAT_INFO_IS_YUV(f) || GST_VIDEO_FORMAT_INFO_IS_GRAY(f)) &&
         !GST_VIDEO_FORMAT_INFO_IS_COMPLEX(f) && !GST_VIDEO_FORMAT_INFO_IS_TILED(f) &&
         GST_VIDEO_FORMAT_INFO_DEPTH(f, 0) == 8 && GST_VIDEO_FORMAT_INFO_W_SUB(f, 0) == 0 &&
         GST_VIDEO_FORMAT_INFO_H_SUB(f, 0) == 0;
}

}  // namespace

Status LumaReader::set_format(const GstVideoInfo& info) {
  converter_.reset();
  gray_.reset();
  if (has_luma_in_place(info)) return {};
  gst_video_info_set_format(&gray_info_, GST_VIDEO_FORMAT_GRAY8,
                            static_cast<guint>(GST_VIDEO_INFO_WIDTH(&info)),
                            static_cast<guint>(GST_VIDEO_INFO_HEIGHT(&info)));
  // The converter changes neither of these, and insists on it.
  gray_info_.fps_n = info.fps_n;
  gray_info_.fps_d = info.fps_d;
  gray_info_.interlace_mode = info.interlace_mode;
  GstVideoInfo from = info;
  converter_.reset(gst_video_converter_new(&from, &gray_info_, nullptr));
  gray_.reset(gst_buffer_new_allocate(nullptr, GST_VIDEO_INFO_SIZE(&gray_info_), nullptr));
  if (!converter_ || !gray_) {
    return make_error(
        ErrorCode::kUnsupported,
        fmt::format("No grey picture can be made of the format {}: insert videoconvert "
                    "before this element.",
                    GST_VIDEO_INFO_NAME(&info)));
  }
  return {};
}

ImageView LumaReader::view(GstVideoFrame& frame) {
  const int width = GST_VIDEO_FRAME_WIDTH(&frame);
  const int height = GST_VIDEO_FRAME_HEIGHT(&frame);
  if (!converter_) {
    return {static_cast<const std::uint8_t*>(GST_VIDEO_FRAME_COMP_DATA(&frame, 0)), width, height,
            GST_VIDEO_FRAME_COMP_STRIDE(&frame, 0), GST_VIDEO_FRAME_COMP_PSTRIDE(&frame, 0)};
  }
  GstVideoFrame gray;
  if (!gst_video_frame_map(&gray, &gray_info_, gray_.get(), GST_MAP_WRITE)) return {};
  gst_video_converter_frame(converter_.get(), &frame, &gray);
  pixels_ = GrayImage(width, height);
  for (int y = 0; y < height; ++y) {
    std::memcpy(pixels_.row(y),
                static_cast<const std::uint8_t*>(GST_VIDEO_FRAME_PLANE_DATA(&gray, 0)) +
                    static_cast<std::ptrdiff_t>(y) * GST_VIDEO_FRAME_PLANE_STRIDE(&gray, 0),
                static_cast<std::size_t>(width));
  }
  gst_video_frame_unmap(&gray);
  return pixels_.view();
}

}  // namespace calvin::gst
