// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Grey images out of frames whose pixels hold more than luma.
#pragma once

#include <cstddef>
#include <cstdint>

#include "calvin/core/image.hpp"

namespace calvin {

// 8-bit red, green and blue side by side in pixels of 3 or 4 bytes, that somebody else owns.
struct RgbView {
  const std::uint8_t* data = nullptr;
  int width = 0;
  int height = 0;
  std::ptrdiff_t stride = 0;  // bytes from a row to the next
  int step = 4;               // bytes from a pixel to the next, 3 or 4
  int red = 0;                // place in a pixel, bytes
  int green = 1;
  int blue = 2;
};

// (77 R + 150 G + 29 B) / 256, rounded: BT.601, full range. `to` takes the size of the image.
void take_luma(const RgbView& image, GrayImage& to);

// A copy without padding; keeps the memory of `to` where that has the size.
void take_luma(const ImageView& image, GrayImage& to);

}  // namespace calvin
