// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Draws BGRx into the frame itself where that is what it is, and else beside it, converted then.

#include "view/scene_painter.hpp"

namespace calvin::gst {

bool ScenePainter::set_format(const GstVideoInfo& info) {
  clear();
  info_ = info;
  gst_video_info_set_format(&drawn_, GST_VIDEO_FORMAT_BGRx,
                            static_cast<guint>(GST_VIDEO_INFO_WIDTH(&info)),
                            static_cast<guint>(GST_VIDEO_INFO_HEIGHT(&info)));
  // A converter wants both sides to be of one rate.
  GST_VIDEO_INFO_FPS_N(&drawn_) = GST_VIDEO_INFO_FPS_N(&info);
  GST_VIDEO_INFO_FPS_D(&drawn_) = GST_VIDEO_INFO_FPS_D(&info);
  if (GST_VIDEO_INFO_FORMAT(&info) == GST_VIDEO_FORMAT_BGRx) return true;
  converter_.reset(gst_video_converter_new(&drawn_, &info_, nullptr));
  if (!converter_) return false;
  canvas_.reset(gst_buffer_new_allocate(nullptr, GST_VIDEO_INFO_SIZE(&drawn_), nullptr));
  return canvas_ != nullptr;
}

void ScenePainter::clear() {
  converter_.reset();
  canvas_.reset();
}

Status ScenePainter::draw(ViewState& state, GstClockTime time, GstBuffer* buffer) const {
  GstVideoFrame frame;
  if (!gst_video_frame_map(&frame, &drawn_, buffer, GST_MAP_READWRITE)) {
    return make_error(ErrorCode::kIo, "The frame's memory cannot be written.");
  }
  Status drawn = state.draw(time, {GST_VIDEO_FRAME_WIDTH(&frame), GST_VIDEO_FRAME_HEIGHT(&frame)},
                            static_cast<std::uint8_t*>(GST_VIDEO_FRAME_PLANE_DATA(&frame, 0)),
                            GST_VIDEO_FRAME_PLANE_STRIDE(&frame, 0));
  gst_video_frame_unmap(&frame);
  return drawn;
}

Status ScenePainter::convert(GstBuffer* to) const {
  GstVideoFrame from_frame;
  GstVideoFrame to_frame;
  if (!gst_video_frame_map(&from_frame, &drawn_, canvas_.get(), GST_MAP_READ)) {
    return make_error(ErrorCode::kIo, "The drawing cannot be read.");
  }
  const bool mapped = gst_video_frame_map(&to_frame, &info_, to, GST_MAP_WRITE) != FALSE;
  if (mapped) {
    gst_video_converter_frame(converter_.get(), &from_frame, &to_frame);
    gst_video_frame_unmap(&to_frame);
  }
  gst_video_frame_unmap(&from_frame);
  if (!mapped) return make_error(ErrorCode::kIo, "The frame's memory cannot be written.");
  return {};
}

Status ScenePainter::paint(ViewState& state, GstClockTime time, GstBuffer* buffer) {
  if (!converter_) return draw(state, time, buffer);
  if (Status drawn = draw(state, time, canvas_.get()); !drawn) return drawn;
  return convert(buffer);
}

}  // namespace calvin::gst
