// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A buffer that is mapped and holds the picture that its caps promise.
#pragma once

#include <utility>

#include <gst/video/video.h>

#include "calvin/core/result.hpp"

namespace calvin::gst {

// A frame that is mapped, with the reference to its buffer that this takes. Memory may give access
// once and refuse it the next time: whoever uses a frame maps it once, and uses that.
class MappedFrame {
 public:
  // An Error where the frame cannot be read, or written; must not be used. GStreamer itself
  // believes what a GstVideoMeta says, and GstVideoFilter lets a frame that it cannot read through
  // unwritten: this finds both.
  [[nodiscard]] static Result<MappedFrame> map(const GstVideoInfo& info, GstBuffer* buffer,
                                               GstMapFlags access = GST_MAP_READ);

  MappedFrame(MappedFrame&& other) noexcept
      : frame_(other.frame_), mapped_(std::exchange(other.mapped_, false)) {}
  MappedFrame& operator=(MappedFrame&& other) noexcept {
    std::swap(frame_, other.frame_);
    std::swap(mapped_, other.mapped_);
    return *this;
  }
  ~MappedFrame() {
    if (mapped_) gst_video_frame_unmap(&frame_);
  }

  [[nodiscard]] const GstVideoFrame& operator*() const { return frame_; }
  [[nodiscard]] GstVideoFrame& operator*() { return frame_; }

 private:
  MappedFrame() = default;

  GstVideoFrame frame_{};
  bool mapped_ = false;
};

}  // namespace calvin::gst
