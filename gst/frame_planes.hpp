// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A GstVideoFrame as the planes that the library's kernels know.
#pragma once

#include <vector>

#include <gst/video/video.h>

#include "calvin/remap/kernel.hpp"

namespace calvin::gst {

// Components of 8 bit that share their places in one plane of a frame.
struct FramePlane {
  PlaneLayout layout;
  guint plane = 0;   // of the GstVideoFrame
  guint offset = 0;  // of the first component, bytes
};

// All samples of frames of an 8-bit format, with their chroma siting (MPEG-2 where it is not
// said) and black as the fill.
[[nodiscard]] std::vector<FramePlane> planes_of(const GstVideoInfo& info);

// Where the plane begins in a mapped frame.
[[nodiscard]] PlaneMemory<std::uint8_t> memory_of(const GstVideoFrame& frame,
                                                  const FramePlane& plane);

}  // namespace calvin::gst
