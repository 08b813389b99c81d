// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The luma of a frame of any raw format.

#include "frame_luma.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace calvin::gst {

namespace {

bool has_luma_in_place(const GstVideoInfo& info) {
  const GstVideoFormatInfo* f = info.finfo;
  return (GST_VIDEO_FORMAT_INFO_IS_YUV(f) || GST_VIDEO_FORMAT_INFO_IS_GRAY(f)) &&
         !GST_VIDEO_FORMAT_INFO_IS_COMPLEX(f) && !GST_VIDEO_FORMAT_INFO_IS_TILED(f) &&
         // IYU1 has no place per pixel, and does not say that it is complex.
         GST_VIDEO_FORMAT_INFO_PSTRIDE(f, 0) > 0 && GST_VIDEO_FORMAT_INFO_DEPTH(f, 0) == 8 &&
         GST_VIDEO_FORMAT_INFO_W_SUB(f, 0) == 0 && GST_VIDEO_FORMAT_INFO_H_SUB(f, 0) == 0;
}

ImageView luma_in_place(const GstVideoFrame& frame) {
  return {static_cast<const std::uint8_t*>(GST_VIDEO_FRAME_COMP_DATA(&frame, 0)),
          GST_VIDEO_FRAME_WIDTH(&frame), GST_VIDEO_FRAME_HEIGHT(&frame),
          GST_VIDEO_FRAME_COMP_STRIDE(&frame, 0), GST_VIDEO_FRAME_COMP_PSTRIDE(&frame, 0)};
}

GrayImage copy_of(const ImageView& image) {
  GrayImage copy(image.width, image.height);
  for (int y = 0; y < image.height; ++y) {
    std::uint8_t* row = copy.row(y);
    const std::uint8_t* from = image.data + y * image.stride;
    if (image.step == 1) {
      std::copy_n(from, image.width, row);
    } else {
      for (int x = 0; x < image.width; ++x) row[x] = from[x * image.step];
    }
  }
  return copy;
}

}  // namespace

std::optional<MappedFrame> MappedFrame::map(const GstVideoInfo& info, GstBuffer* buffer) {
  auto frame = std::make_unique<GstVideoFrame>();
  if (!gst_video_frame_map(frame.get(), &info, buffer, GST_MAP_READ)) return std::nullopt;
  MappedFrame mapped;
  mapped.frame_.reset(frame.release());
  return mapped;
}

Result<std::shared_ptr<LumaReader>> LumaReader::make(const GstVideoInfo& info) {
  auto reader = std::make_shared<LumaReader>();
  reader->info_ = info;
  if (Status set = reader->set_format(); !set) return tl::unexpected<Error>(set.error());
  return reader;
}

Status LumaReader::set_format() {
  if (has_luma_in_place(info_)) return {};
  gst_video_info_set_format(&gray_info_, GST_VIDEO_FORMAT_GRAY8,
                            static_cast<guint>(GST_VIDEO_INFO_WIDTH(&info_)),
                            static_cast<guint>(GST_VIDEO_INFO_HEIGHT(&info_)));
  // The converter changes neither of these, and insists on it.
  gray_info_.fps_n = info_.fps_n;
  gray_info_.fps_d = info_.fps_d;
  gray_info_.interlace_mode = info_.interlace_mode;
  converter_.reset(gst_video_converter_new(&info_, &gray_info_, nullptr));
  gray_.reset(gst_buffer_new_allocate(nullptr, GST_VIDEO_INFO_SIZE(&gray_info_), nullptr));
  if (!converter_ || !gray_) {
    return make_error(
        ErrorCode::kUnsupported,
        fmt::format("No grey picture can be made of the format {}: insert videoconvert "
                    "before this element.",
                    GST_VIDEO_INFO_NAME(&info_)));
  }
  return {};
}

Picture LumaReader::borrow(GstBuffer* buffer) const {
  return {std::nullopt, MappedFrame::map(info_, buffer)};
}

Picture LumaReader::copy(GstBuffer* buffer) const {
  const auto mapped = MappedFrame::map(info_, buffer);
  if (!mapped) return {};
  if (!converter_) return {copy_of(luma_in_place(**mapped)), std::nullopt};
  const std::unique_ptr<GstBuffer, Unref> own(
      gst_buffer_new_allocate(nullptr, GST_VIDEO_INFO_SIZE(&info_), nullptr));
  GstVideoFrame to;
  if (!own || !gst_video_frame_map(&to, &info_, own.get(), GST_MAP_WRITE)) return {};
  gst_video_frame_copy(&to, &**mapped);
  gst_video_frame_unmap(&to);
  return {std::nullopt, MappedFrame::map(info_, own.get())};
}

ImageView LumaReader::view(const Picture& picture) {
  if (picture.gray) return picture.gray->view();
  if (!picture.frame) return {};
  return converter_ ? converted(**picture.frame) : luma_in_place(**picture.frame);
}

ImageView LumaReader::converted(GstVideoFrame& frame) {
  GstVideoFrame gray;
  if (!gst_video_frame_map(&gray, &gray_info_, gray_.get(), GST_MAP_WRITE)) return {};
  gst_video_converter_frame(converter_.get(), &frame, &gray);
  pixels_ = copy_of(luma_in_place(gray));
  gst_video_frame_unmap(&gray);
  return pixels_.view();
}

}  // namespace calvin::gst
