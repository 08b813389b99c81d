// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The luma of a frame of any raw format.
#pragma once

#include <memory>

#include <gst/video/video.h>

#include "calvin/core/image.hpp"
#include "calvin/core/result.hpp"

namespace calvin::gst {

// Gives a grey view of mapped frames of one format: in place where the format has an 8-bit luma,
// converted into an own frame otherwise. One thread at a time.
class LumaReader {
 public:
  // A message that says what to insert where the format cannot be read.
  Status set_format(const GstVideoInfo& info);

  // Valid until the next call, and no longer than the frame is mapped.
  [[nodiscard]] ImageView view(GstVideoFrame& frame);

 private:
  struct FreeConverter {
    void operator()(GstVideoConverter* c) const { gst_video_converter_free(c); }
  };
  struct Unref {
    void operator()(GstBuffer* b) const { gst_buffer_unref(b); }
  };

  GstVideoInfo gray_info_{};
  std::unique_ptr<GstVideoConverter, FreeConverter> converter_;  // null: read in place
  std::unique_ptr<GstBuffer, Unref> gray_;
  GrayImage pixels_;
};

}  // namespace calvin::gst
