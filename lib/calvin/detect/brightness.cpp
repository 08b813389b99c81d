// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Counts bright pixels.

#include "calvin/detect/brightness.hpp"

#include <algorithm>
#include <cmath>

namespace calvin {

bool is_too_dark(const ImageView& image) noexcept {
  // Black is at 16 where video does not use its full range.
  constexpr int kBright = 40;
  constexpr double kFewest = 0.02;    // of the pixels: a lamp in a dark room lights no board
  constexpr double kSamples = 10000;  // of the pixels
  if (image.width < 1 || image.height < 1) return false;
  const double pixels = static_cast<double>(image.width) * image.height;
  const int step = std::max(1, static_cast<int>(std::sqrt(pixels / kSamples)));
  int all = 0;
  int bright = 0;
  for (int y = step / 2; y < image.height; y += step) {
    for (int x = step / 2; x < image.width; x += step) {
      ++all;
      bright += image.at(x, y) >= kBright ? 1 : 0;
    }
  }
  return bright < kFewest * all;
}

}  // namespace calvin
