// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The pixel formats of the emulated camera, one row each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "calvin/core/image.hpp"

namespace calvin::v4l2 {

struct PixelFormat {
  std::string_view name;  // in CALVIN_V4L2_FORMATS
  std::uint32_t fourcc;   // V4L2_PIX_FMT_...
  std::string_view description;
  // Bytes of a line of the first plane for each pixel of its width; 0 where it is compressed.
  std::uint32_t line_bytes;
  std::uint32_t frame_bits;  // the most for each pixel of a frame
  std::vector<std::uint8_t> (*encode)(const GrayImage&);
};

[[nodiscard]] std::span<const PixelFormat> pixel_formats();

// Null where there is none with that code.
[[nodiscard]] const PixelFormat* find_pixel_format(std::uint32_t fourcc);

}  // namespace calvin::v4l2
