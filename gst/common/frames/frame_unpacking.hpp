// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Frames whose samples the kernels cannot read where they lie, as planes that they can.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <gst/video/video.h>

#include "calvin/remap/map/plane_layout.hpp"

namespace calvin::gst {

// Whether samples share bytes (v210, RGB16), or lie in tiles: then no plane of the frame is one
// that the kernels know.
[[nodiscard]] bool needs_unpacking(const GstVideoFormatInfo* format);

// Whether GStreamer unpacks the format to lines of 16 bits a sample, not of 8.
[[nodiscard]] bool has_wide_lines(const GstVideoFormatInfo* format);

// Whether frames can be packed into that memory: GStreamer's packers want whole pixels from where
// they can be written at once.
[[nodiscard]] bool can_pack_into(const GstVideoFrame& frame);

// The samples of one frame: a plane of 16-bit words, of the machine's order, for each component.
// The values are those of the format, of as many bits: nothing is lost on the way there and back.
class UnpackedFrame {
 public:
  explicit UnpackedFrame(const GstVideoInfo& info);
  [[nodiscard]] bool is_for(const GstVideoInfo& info) const {
    return format_ == info.finfo && width_ == GST_VIDEO_INFO_WIDTH(&info) &&
           height_ == GST_VIDEO_INFO_HEIGHT(&info);
  }

  [[nodiscard]] PlaneMemory<std::uint8_t> plane(guint component);

  // The rows of one part of as many; all parts may be done at the same time, by several threads.
  void unpack(const GstVideoFrame& frame, int part, int parts);
  void pack(const GstVideoFrame& frame, int part, int parts) const;

 private:
  struct Plane {
    int width = 0;
    int x_shift = 0;
    int y_shift = 0;
    int spare_bits = 0;     // of a sample in an unpacked line: those below its value
    std::size_t first = 0;  // sample of an unpacked line
    std::vector<std::uint16_t> words;

    [[nodiscard]] std::uint16_t* row(int y) {
      return words.data() + static_cast<std::ptrdiff_t>(y >> y_shift) * width;
    }
    [[nodiscard]] const std::uint16_t* row(int y) const {
      return words.data() + static_cast<std::ptrdiff_t>(y >> y_shift) * width;
    }
  };

  template <typename Sample>
  void unpack_rows(const GstVideoFrame& frame, int begin, int end);
  template <typename Sample>
  void pack_rows(const GstVideoFrame& frame, int begin, int end) const;
  [[nodiscard]] int row_of(int part, int parts) const;

  const GstVideoFormatInfo* format_;
  int width_;
  int height_;
  bool has_wide_lines_;  // 16 bits a sample in an unpacked line, else 8
  std::vector<Plane> planes_;
};

}  // namespace calvin::gst
