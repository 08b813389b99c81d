// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Room behind a frame for what GStreamer's functions read and write beyond it.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <gst/video/video.h>

namespace calvin::gst {

// As much as any of GStreamer's functions needs behind a plane, and more: where the chroma of the
// last column lies in a tile that a plane does not have, the functions take it from behind the last
// tile. One of 8x128 pixels of 10 bits has 1280 bytes.
inline constexpr gsize kPadding = 4096;

// Whether GStreamer's functions may go beyond the memory of frames: those of packed formats take
// pixels that share chroma together, and the rows of UYVP, NV12_10LE32, NV16_10LE32 and
// NV12_10BE_8L128 of some odd widths have no room for the last of them.
[[nodiscard]] bool needs_padding(const GstVideoInfo& info);

// The bytes of a plane of groups of pixels or of tiles, from the first to the last: it has at least
// the rows, or tiles, that GStreamer gives it in `plain`, the format without a GstVideoMeta. Absent
// where its rows are shorter.
[[nodiscard]] std::optional<std::int64_t> plane_bytes(const GstVideoInfo& info,
                                                      const GstVideoInfo& plain, guint plane);

// A copy of a frame that needs_padding(), of the same strides.
class PaddedFrame {
 public:
  explicit PaddedFrame(const GstVideoFrame& frame);

  PaddedFrame(const PaddedFrame&) = delete;
  PaddedFrame& operator=(const PaddedFrame&) = delete;

  [[nodiscard]] GstVideoFrame& operator*() { return frame_; }
  // Back into the frame that it is a copy of.
  void copy_to(const GstVideoFrame& frame) const;

 private:
  std::vector<std::uint8_t> memory_;
  GstVideoFrame frame_;  // its planes are in memory_; the buffer is still the other's
};

}  // namespace calvin::gst
