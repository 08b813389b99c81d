// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Reads the luma of a frame that somebody has pointed at.

#include "common/frames/frame_points.hpp"

#include <utility>

#include "common/frames/frame_part.hpp"

namespace calvin::gst {

std::optional<FoundPoint> FrameLook::point_at(Pixel at, double reach) const {
  if (image_.data == nullptr) return std::nullopt;
  return nearest_point(image_, at, reach);
}

FrameLook FramePoints::look(GstBuffer* buffer) const {
  FrameLook look;
  if (GST_VIDEO_INFO_FORMAT(&info_) == GST_VIDEO_FORMAT_UNKNOWN) return look;
  const auto part = part_of(buffer, info_);
  const GstVideoInfo whole = part ? with_size(info_, part->whole) : info_;
  auto luma = LumaReader::make(whole);
  if (!luma) return look;
  auto frame = MappedFrame::map(whole, buffer);
  if (!frame) return look;
  look.luma_ = *std::move(luma);
  look.picture_ = look.luma_->borrow(*std::move(frame));
  look.image_ = frame_of(look.luma_->view(look.picture_), part);
  return look;
}

}  // namespace calvin::gst
