// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Puts the scene of a rig into video frames of any format.
#pragma once

#include <memory>

#include <gst/video/video.h>

#include "calvin/core/result.hpp"
#include "view/view_state.hpp"

namespace calvin::gst {

// Belongs to the streaming thread.
class ScenePainter {
 public:
  // False where nothing converts what is drawn to that format.
  [[nodiscard]] bool set_format(const GstVideoInfo& info);
  void clear();

  // Draws the scene at a time of the stream into a frame of that format.
  [[nodiscard]] Status paint(ViewState& state, GstClockTime time, GstBuffer* buffer);

 private:
  struct Free {
    void operator()(GstVideoConverter* converter) const { gst_video_converter_free(converter); }
    void operator()(GstBuffer* buffer) const { gst_buffer_unref(buffer); }
  };
  [[nodiscard]] Status draw(ViewState& state, GstClockTime time, GstBuffer* buffer) const;
  [[nodiscard]] Status convert(GstBuffer* to) const;

  GstVideoInfo info_{};
  GstVideoInfo drawn_{};  // BGRx of the size of info_
  // From that; absent where that is what is wanted.
  std::unique_ptr<GstVideoConverter, Free> converter_;
  std::unique_ptr<GstBuffer, Free> canvas_;
};

}  // namespace calvin::gst
