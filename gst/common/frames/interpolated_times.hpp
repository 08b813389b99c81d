// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// When frames were taken that do not say it, as those of a raw H.264 stream: by the rate that their
// caps tell. How fast a board moves, which a rolling shutter needs, nothing else tells.
#pragma once

#include <gst/video/video.h>

namespace calvin::gst {

// ns; 0 where the caps do not tell.
inline GstClockTime frame_duration(const GstVideoInfo& info) {
  const int frames = GST_VIDEO_INFO_FPS_N(&info);
  if (frames <= 0) return 0;
  return gst_util_uint64_scale_int(GST_SECOND, GST_VIDEO_INFO_FPS_D(&info), frames);
}

// Not thread-safe.
class InterpolatedTimes {
 public:
  void set_format(const GstVideoInfo& info) {
    duration_ = frame_duration(info);
    if (duration_ == 0) restart();
  }
  // Another segment begins.
  void restart() { next_ = GST_CLOCK_TIME_NONE; }

  // Of each frame in the order in which they come: its timestamp, or where it has none one frame
  // after the last one. GST_CLOCK_TIME_NONE where neither is known.
  GstClockTime of(const GstSegment& segment, GstBuffer* frame) {
    GstClockTime time = GST_BUFFER_PTS(frame);
    if (!GST_CLOCK_TIME_IS_VALID(time)) time = next_;
    const bool known = duration_ > 0 && segment.rate > 0;
    if (known && !GST_CLOCK_TIME_IS_VALID(time)) time = first_of(segment);
    next_ = known ? time + duration_ : GST_CLOCK_TIME_NONE;
    return time;
  }

 private:
  static GstClockTime first_of(const GstSegment& segment) {
    const bool told = segment.format == GST_FORMAT_TIME && GST_CLOCK_TIME_IS_VALID(segment.start);
    return told ? segment.start : 0;
  }

  GstClockTime duration_ = 0;
  GstClockTime next_ = GST_CLOCK_TIME_NONE;
};

}  // namespace calvin::gst
