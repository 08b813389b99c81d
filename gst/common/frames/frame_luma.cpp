// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The luma of a frame of any raw format.

#include "common/frames/frame_luma.hpp"

#include <utility>

#include <fmt/format.h>

#include "calvin/detect/luma.hpp"
#include "common/frames/padded_frame.hpp"

namespace calvin::gst {

namespace {

// Where the 8 highest bits of a 16-bit luma lie side by side in one byte, that byte is read.
bool has_high_byte(const GstVideoFormatInfo* f) {
  return GST_VIDEO_FORMAT_INFO_DEPTH(f, 0) > 8 &&
         GST_VIDEO_FORMAT_INFO_DEPTH(f, 0) + GST_VIDEO_FORMAT_INFO_SHIFT(f, 0) == 16 &&
         GST_VIDEO_FORMAT_INFO_PSTRIDE(f, 0) == 2;
}

bool has_luma_in_place(const GstVideoInfo& info) {
  const GstVideoFormatInfo* f = info.finfo;
  return (GST_VIDEO_FORMAT_INFO_IS_YUV(f) || GST_VIDEO_FORMAT_INFO_IS_GRAY(f)) &&
         !GST_VIDEO_FORMAT_INFO_IS_COMPLEX(f) && !GST_VIDEO_FORMAT_INFO_IS_TILED(f) &&
         // IYU1 has no place per pixel, and does not say that it is complex.
         GST_VIDEO_FORMAT_INFO_PSTRIDE(f, 0) > 0 &&
         (GST_VIDEO_FORMAT_INFO_DEPTH(f, 0) == 8 || has_high_byte(f)) &&
         GST_VIDEO_FORMAT_INFO_W_SUB(f, 0) == 0 && GST_VIDEO_FORMAT_INFO_H_SUB(f, 0) == 0;
}

bool is_plain_rgb(const GstVideoInfo& info) {
  const GstVideoFormatInfo* f = info.finfo;
  const int step = GST_VIDEO_FORMAT_INFO_PSTRIDE(f, 0);
  return GST_VIDEO_FORMAT_INFO_IS_RGB(f) && !GST_VIDEO_FORMAT_INFO_IS_COMPLEX(f) &&
         !GST_VIDEO_FORMAT_INFO_HAS_PALETTE(f) && !GST_VIDEO_FORMAT_INFO_IS_TILED(f) &&
         GST_VIDEO_FORMAT_INFO_N_PLANES(f) == 1 && (step == 3 || step == 4) &&
         GST_VIDEO_FORMAT_INFO_DEPTH(f, 0) == 8 && GST_VIDEO_FORMAT_INFO_DEPTH(f, 1) == 8 &&
         GST_VIDEO_FORMAT_INFO_DEPTH(f, 2) == 8;
}

RgbView rgb_of(const GstVideoFrame& frame) {
  const GstVideoFormatInfo* f = frame.info.finfo;
  const auto place = [f](int component) {
    return static_cast<int>(GST_VIDEO_FORMAT_INFO_POFFSET(f, component));
  };
  return {static_cast<const std::uint8_t*>(GST_VIDEO_FRAME_PLANE_DATA(&frame, 0)),
          GST_VIDEO_FRAME_WIDTH(&frame),
          GST_VIDEO_FRAME_HEIGHT(&frame),
          GST_VIDEO_FRAME_PLANE_STRIDE(&frame, 0),
          GST_VIDEO_FORMAT_INFO_PSTRIDE(f, 0),
          place(GST_VIDEO_COMP_R),
          place(GST_VIDEO_COMP_G),
          place(GST_VIDEO_COMP_B)};
}

ImageView luma_in_place(const GstVideoFrame& frame) {
  const GstVideoFormatInfo* f = frame.info.finfo;
  const int high = has_high_byte(f) && GST_VIDEO_FORMAT_INFO_IS_LE(f) ? 1 : 0;
  return {static_cast<const std::uint8_t*>(GST_VIDEO_FRAME_COMP_DATA(&frame, 0)) + high,
          GST_VIDEO_FRAME_WIDTH(&frame), GST_VIDEO_FRAME_HEIGHT(&frame),
          GST_VIDEO_FRAME_COMP_STRIDE(&frame, 0), GST_VIDEO_FRAME_COMP_PSTRIDE(&frame, 0)};
}

bool is_from_bounded_pool(GstBuffer* buffer) {
  // A buffer that shares the memory of another one holds that back too.
  const GstParentBufferMeta* parent = gst_buffer_get_parent_buffer_meta(buffer);
  if (parent != nullptr && is_from_bounded_pool(parent->buffer)) return true;
  if (buffer->pool == nullptr) return false;
  GstStructure* config = gst_buffer_pool_get_config(buffer->pool);
  guint most = 0;
  gst_buffer_pool_config_get_params(config, nullptr, nullptr, nullptr, &most);
  gst_structure_free(config);
  return most > 0;
}

}  // namespace

std::shared_ptr<GrayImage> SparePicture::take(const std::shared_ptr<SparePicture>& spare) {
  std::unique_ptr<GrayImage> image;
  {
    const std::lock_guard guard(spare->lock_);
    image = std::move(spare->image_);
  }
  if (!image) image = std::make_unique<GrayImage>();
  return {image.release(), [spare](GrayImage* used) {
            const std::lock_guard guard(spare->lock_);
            spare->image_.reset(used);
          }};
}

Result<std::shared_ptr<LumaReader>> LumaReader::make(const GstVideoInfo& info) {
  auto reader = std::make_shared<LumaReader>();
  reader->info_ = info;
  if (Status set = reader->set_format(); !set) return tl::unexpected<Error>(set.error());
  return reader;
}

Status LumaReader::set_format() {
  is_rgb_ = is_plain_rgb(info_);
  if (is_rgb_ || has_luma_in_place(info_)) return {};
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

Picture LumaReader::borrow(MappedFrame frame) const {
  if (needs_padding(info_)) return copy(*frame);
  return {nullptr, std::move(frame)};
}

Picture LumaReader::keep(MappedFrame frame) const {
  return is_from_bounded_pool((*frame).buffer) ? copy(*frame) : borrow(std::move(frame));
}

Picture LumaReader::copy(const GstVideoFrame& frame) const {
  if (!converter_) {
    auto gray = SparePicture::take(spare_);
    take_gray(frame, *gray);
    return {std::move(gray), std::nullopt};
  }
  GstAllocationParams params;
  gst_allocation_params_init(&params);
  params.padding = kPadding;
  const std::unique_ptr<GstBuffer, Unref> own(
      gst_buffer_new_allocate(nullptr, GST_VIDEO_INFO_SIZE(&info_), &params));
  GstVideoFrame to;
  if (!own || !gst_video_frame_map(&to, &info_, own.get(), GST_MAP_WRITE)) return {};
  gst_video_frame_copy(&to, &frame);
  gst_video_frame_unmap(&to);
  auto kept = MappedFrame::map(info_, own.get());
  if (!kept) return {};
  return {nullptr, *std::move(kept)};
}

ImageView LumaReader::view(const Picture& picture) {
  if (picture.gray) return picture.gray->view();
  if (!picture.frame) return {};
  if (converter_) return converted(**picture.frame);
  if (!is_rgb_) return luma_in_place(**picture.frame);
  take_gray(**picture.frame, pixels_);
  return pixels_.view();
}

void LumaReader::take_gray(const GstVideoFrame& frame, GrayImage& gray) const {
  if (is_rgb_) {
    take_luma(rgb_of(frame), gray);
  } else {
    take_luma(luma_in_place(frame), gray);
  }
}

ImageView LumaReader::converted(const GstVideoFrame& frame) {
  GstVideoFrame gray;
  if (!gst_video_frame_map(&gray, &gray_info_, gray_.get(), GST_MAP_WRITE)) return {};
  gst_video_converter_frame(converter_.get(), &frame, &gray);
  take_luma(luma_in_place(gray), pixels_);
  gst_video_frame_unmap(&gray);
  return pixels_.view();
}

}  // namespace calvin::gst
