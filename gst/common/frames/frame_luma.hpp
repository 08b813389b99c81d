// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The luma of a frame of any raw format.
#pragma once

#include <memory>
#include <mutex>
#include <optional>

#include <gst/video/video.h>

#include "calvin/core/image.hpp"
#include "calvin/core/result.hpp"
#include "common/frames/mapped_frame.hpp"

namespace calvin::gst {

// A frame to look at later, on any thread: its luma alone, or all of it where the luma has to be
// computed.
struct Picture {
  std::shared_ptr<GrayImage> gray;
  std::optional<MappedFrame> frame;
};

// Keeps the memory of one picture that nobody looks at any more for the next: to get megabytes from
// the system takes longer than to fill them.
class SparePicture {
 public:
  // Goes back to `spare` when the last reference to it goes.
  [[nodiscard]] static std::shared_ptr<GrayImage> take(const std::shared_ptr<SparePicture>& spare);

 private:
  std::mutex lock_;
  std::unique_ptr<GrayImage> image_;
};

// Gives a grey view of the frames of one format: in place where the format has a luma whose 8
// highest bits are a byte, converted into an own frame otherwise. Immutable but for view().
class LumaReader {
 public:
  // A message that says what to insert where the format cannot be read.
  static Result<std::shared_ptr<LumaReader>> make(const GstVideoInfo& info);

  // The frame itself, or a copy where it needs_padding(); empty where there is no memory for one.
  [[nodiscard]] Picture borrow(MappedFrame frame) const;
  // For a look while the stream goes on. The frame itself too: whoever writes into it downstream
  // meanwhile gets a copy from GStreamer. But of a frame from a pool that has only so many, such as
  // a camera's, a copy, so that whoever fills them never waits for us.
  [[nodiscard]] Picture keep(MappedFrame frame) const;

  // Valid until the next call, and no longer than the picture. One thread at a time.
  [[nodiscard]] ImageView view(const Picture& picture);

 private:
  struct FreeConverter {
    void operator()(GstVideoConverter* c) const { gst_video_converter_free(c); }
  };
  struct Unref {
    void operator()(GstBuffer* b) const { gst_buffer_unref(b); }
  };

  [[nodiscard]] Status set_format();
  [[nodiscard]] Picture copy(const GstVideoFrame& frame) const;
  [[nodiscard]] ImageView converted(const GstVideoFrame& frame);
  // Of a frame that needs no converter.
  void take_gray(const GstVideoFrame& frame, GrayImage& gray) const;

  GstVideoInfo info_{};
  GstVideoInfo gray_info_{};
  bool is_rgb_ = false;
  std::unique_ptr<GstVideoConverter, FreeConverter> converter_;  // null: not needed
  std::unique_ptr<GstBuffer, Unref> gray_;
  GrayImage pixels_;
  std::shared_ptr<SparePicture> spare_ = std::make_shared<SparePicture>();
};

}  // namespace calvin::gst
