// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The corners and discs next to pixels of a frame of any raw format.
#pragma once

#include <memory>
#include <optional>

#include <gst/video/video.h>

#include "calvin/detect/nearest/nearest_point.hpp"
#include "common/frames/frame_luma.hpp"

namespace calvin::gst {

// One frame while it is looked at. No longer than its buffer.
class FrameLook {
 public:
  // nearest_point(). Absent also where the frame's pixels cannot be read.
  [[nodiscard]] std::optional<FoundPoint> point_at(Pixel at, double reach) const;

 private:
  friend class FramePoints;
  std::shared_ptr<LumaReader> luma_;  // has the pixels of `image_`
  Picture picture_;
  ImageView image_;  // without data where nothing can be read
};

// One streaming thread at a time.
class FramePoints {
 public:
  void set_format(const GstVideoInfo& info) { info_ = info; }
  [[nodiscard]] FrameLook look(GstBuffer* buffer) const;

 private:
  GstVideoInfo info_{};
};

}  // namespace calvin::gst
