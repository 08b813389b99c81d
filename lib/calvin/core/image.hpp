// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Grey images: a view of somebody's pixels, and an image that owns its pixels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace calvin {

// A point of an image in px; the centre of the top-left pixel is (0, 0).
struct Pixel {
  double u = 0;
  double v = 0;
};

struct ImageSize {
  int width = 0;
  int height = 0;

  friend bool operator==(const ImageSize&, const ImageSize&) = default;
};

// Pixel coordinates of the centre of the image.
[[nodiscard]] inline Pixel image_center(ImageSize size) {
  return {(size.width - 1) / 2.0, (size.height - 1) / 2.0};
}

// 8-bit grey pixels that somebody else owns; the luma of a YUV frame is viewed in place.
struct ImageView {
  const std::uint8_t* data = nullptr;
  int width = 0;
  int height = 0;
  std::ptrdiff_t stride = 0;  // bytes from a row to the next
  std::ptrdiff_t step = 1;    // bytes from a pixel to the next: 2 for the luma of YUY2

  [[nodiscard]] ImageSize size() const noexcept { return {width, height}; }
  [[nodiscard]] std::uint8_t at(int x, int y) const noexcept { return data[y * stride + x * step]; }
};

// 8-bit grey pixels without padding.
struct GrayImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> pixels;  // width * height, row by row

  GrayImage() = default;
  GrayImage(int w, int h, std::uint8_t value = 0)
      : width(w),
        height(h),
        pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), value) {}

  [[nodiscard]] ImageSize size() const noexcept { return {width, height}; }
  [[nodiscard]] std::uint8_t* row(int y) noexcept {
    return pixels.data() + static_cast<std::ptrdiff_t>(y) * width;
  }
  [[nodiscard]] ImageView view() const noexcept { return {pixels.data(), width, height, width, 1}; }
};

}  // namespace calvin
