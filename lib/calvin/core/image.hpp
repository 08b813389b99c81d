// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Pictures: pixels and sizes, how a picture has to be turned to stand upright, and grey images: a
// view of somebody's pixels, and an image that owns its pixels.
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

// The eight ways to lay a picture on itself. First rows become columns (transpose), then the new
// picture is mirrored: left to right (flip_x), top to bottom (flip_y). A quarter turn clockwise is
// transpose and flip_x.
struct Orientation {
  bool transpose = false;
  bool flip_x = false;
  bool flip_y = false;

  [[nodiscard]] Orientation inverse() const noexcept {
    return transpose ? Orientation{true, flip_y, flip_x} : *this;
  }
  [[nodiscard]] ImageSize size_of(ImageSize size) const noexcept {
    return transpose ? ImageSize{size.height, size.width} : size;
  }
  friend bool operator==(const Orientation&, const Orientation&) = default;
};

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
