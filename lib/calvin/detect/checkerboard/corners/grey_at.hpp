// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The grey level of an image between its pixels.
#pragma once

#include <algorithm>
#include <optional>

#include "calvin/core/image.hpp"

namespace calvin::detect {

// Linear between the four pixels around (x, y), which is in an image of at least 2x2 pixels.
[[nodiscard]] inline float grey_inside(const ImageView& image, float x, float y) {
  const int u = std::min(static_cast<int>(x), image.width - 2);
  const int v = std::min(static_cast<int>(y), image.height - 2);
  const float fx = x - static_cast<float>(u);
  const float fy = y - static_cast<float>(v);
  const auto at = [&](int dx, int dy) { return static_cast<float>(image.at(u + dx, v + dy)); };
  return (1 - fy) * ((1 - fx) * at(0, 0) + fx * at(1, 0)) +
         fy * ((1 - fx) * at(0, 1) + fx * at(1, 1));
}

// Likewise; absent outside of the image.
[[nodiscard]] inline std::optional<float> grey_at(const ImageView& image, float x, float y) {
  if (!(x >= 0 && y >= 0 && x <= static_cast<float>(image.width - 1) &&
        y <= static_cast<float>(image.height - 1))) {
    return std::nullopt;
  }
  return grey_inside(image, x, y);
}

}  // namespace calvin::detect
