// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which part of the picture in a buffer is the frame.

#include "common/frames/frame_part.hpp"

namespace calvin::gst {

std::optional<FramePart> part_of(GstBuffer* buffer, const GstVideoInfo& info) {
  const GstVideoCropMeta* crop = gst_buffer_get_video_crop_meta(buffer);
  if (crop == nullptr) return std::nullopt;
  guint width = static_cast<guint>(GST_VIDEO_INFO_WIDTH(&info));
  guint height = static_cast<guint>(GST_VIDEO_INFO_HEIGHT(&info));
  if (const GstVideoMeta* meta = gst_buffer_get_video_meta(buffer); meta != nullptr) {
    width = meta->width;
    height = meta->height;
  }
  // Of a picture smaller than the caps there is no part: MappedFrame::map() tells what is wrong.
  if (width < static_cast<guint>(GST_VIDEO_INFO_WIDTH(&info)) ||
      height < static_cast<guint>(GST_VIDEO_INFO_HEIGHT(&info))) {
    return std::nullopt;
  }
  // What does not lie in the picture says nothing; so does what is all of it.
  if (crop->width < 2 || crop->height < 2 || crop->width > width || crop->height > height ||
      crop->x > width - crop->width || crop->y > height - crop->height ||
      (crop->width == width && crop->height == height)) {
    return std::nullopt;
  }
  return FramePart{{static_cast<int>(width), static_cast<int>(height)},
                   static_cast<int>(crop->x),
                   static_cast<int>(crop->y),
                   {static_cast<int>(crop->width), static_cast<int>(crop->height)}};
}

ImageView frame_of(const ImageView& picture, const std::optional<FramePart>& part) {
  if (!part || picture.size() != part->whole) return picture;
  return {picture.data + part->y * picture.stride + part->x * picture.step, part->size.width,
          part->size.height, picture.stride, picture.step};
}

GstVideoInfo with_size(const GstVideoInfo& info, ImageSize size) {
  GstVideoInfo other;
  // Sizes that no memory can hold are found out when a frame is looked at.
  if (!gst_video_info_set_interlaced_format(
          &other, GST_VIDEO_INFO_FORMAT(&info), GST_VIDEO_INFO_INTERLACE_MODE(&info),
          static_cast<guint>(size.width), static_cast<guint>(size.height))) {
    other = info;
    GST_VIDEO_INFO_WIDTH(&other) = size.width;
    GST_VIDEO_INFO_HEIGHT(&other) = size.height;
  }
  other.colorimetry = info.colorimetry;
  other.chroma_site = info.chroma_site;
  other.fps_n = info.fps_n;
  other.fps_d = info.fps_d;
  other.par_n = info.par_n;
  other.par_d = info.par_d;
  return other;
}

}  // namespace calvin::gst
