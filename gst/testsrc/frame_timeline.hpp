// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The times of the frames of a source that can be seeked and played backwards: from their numbers
// alone, so that no rounding adds up.
#pragma once

#include <gst/gst.h>

namespace calvin::gst {

class FrameTimeline {
 public:
  // `fps_n / fps_d` frames a second from the next one on. Time goes on where the frames of the rate
  // before ended; the first rate begins where it was seeked to.
  void set_rate(int fps_n, int fps_d);
  // A seek before the first rate waits for that.
  void seek(GstClockTime position, bool reverse);

  // The next frame; its number is below the first one's where it was played backwards to the start.
  [[nodiscard]] gint64 frame() const { return frame_; }
  [[nodiscard]] bool is_over() const { return frame_ < first_frame_; }
  [[nodiscard]] GstClockTime time() const { return time_of(frame_); }
  [[nodiscard]] GstClockTime duration() const { return time_of(frame_ + 1) - time(); }
  void advance() { frame_ += reverse_ ? -1 : 1; }

 private:
  [[nodiscard]] GstClockTime time_of(gint64 frame) const;
  void find_frame();

  guint64 fps_n_ = 0;  // 0: not known yet
  guint64 fps_d_ = 1;
  gint64 frame_ = 0;
  gint64 first_frame_ = 0;       // of the present rate
  GstClockTime first_time_ = 0;  // its time
  GstClockTime position_ = 0;    // of the last seek
  bool reverse_ = false;
};

}  // namespace calvin::gst
