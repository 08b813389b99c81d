// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What happens to the rendered scene on its way to grey levels: optics and sensor.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "calvin/core/image.hpp"

namespace calvin::synth {

struct FloatImage {
  int width;
  int height;
  std::vector<float> pixels;

  explicit FloatImage(ImageSize size)
      : width(size.width),
        height(size.height),
        pixels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {}
  [[nodiscard]] float* row(int y) { return pixels.data() + static_cast<std::ptrdiff_t>(y) * width; }
};

// Gaussian blur of `sigma` px (0: none; at most 50), in place; the border pixel goes on outside.
void blur(FloatImage& image, double sigma);

// Adds Gaussian noise of `sigma` grey levels, rounds and cuts off to 0..255.
[[nodiscard]] GrayImage quantise(const FloatImage& image, double sigma, std::uint64_t seed);

}  // namespace calvin::synth
