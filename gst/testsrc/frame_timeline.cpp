// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Converts between frame numbers and times with the rate as a fraction, forwards and backwards.

#include "testsrc/frame_timeline.hpp"

namespace calvin::gst {

void FrameTimeline::set_rate(int fps_n, int fps_d) {
  const bool first = fps_n_ == 0;
  if (!first) {
    first_time_ = time_of(frame_);
    first_frame_ = frame_;
  }
  fps_n_ = static_cast<guint64>(fps_n);
  fps_d_ = static_cast<guint64>(fps_d);
  if (first) find_frame();
}

void FrameTimeline::seek(GstClockTime position, bool reverse) {
  reverse_ = reverse;
  frame_ = first_frame_ = 0;
  first_time_ = 0;
  position_ = position;
  if (fps_n_ > 0) find_frame();
}

GstClockTime FrameTimeline::time_of(gint64 frame) const {
  return first_time_ + gst_util_uint64_scale(static_cast<guint64>(frame - first_frame_),
                                             fps_d_ * GST_SECOND, fps_n_);
}

// The last frame that starts before the position or on it; times are rounded down.
void FrameTimeline::find_frame() {
  frame_ =
      static_cast<gint64>(gst_util_uint64_scale_ceil(position_ + 1, fps_n_, fps_d_ * GST_SECOND)) -
      1;
  if (reverse_ && time_of(frame_) == position_) --frame_;  // it would start where playing ends
}

}  // namespace calvin::gst
