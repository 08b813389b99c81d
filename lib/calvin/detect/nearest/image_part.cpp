// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Copies a few pixels.

#include "calvin/detect/nearest/image_part.hpp"

#include <algorithm>
#include <cmath>

namespace calvin {

namespace {

// The pixels at most `half` columns and rows away from the one nearest to `middle`.
ImagePart part_around(const ImageView& image, Pixel middle, int half) {
  const int left = std::max(0, static_cast<int>(std::lround(middle.u)) - half);
  const int top = std::max(0, static_cast<int>(std::lround(middle.v)) - half);
  const int right = std::min(image.width, static_cast<int>(std::lround(middle.u)) + half + 1);
  const int bottom = std::min(image.height, static_cast<int>(std::lround(middle.v)) + half + 1);
  ImagePart part;
  if (right <= left || bottom <= top) return part;
  part = {GrayImage(right - left, bottom - top), left, top, image.width};
  for (int y = top; y < bottom; ++y) {
    std::uint8_t* row = part.image.row(y - top);
    for (int x = left; x < right; ++x) row[x - left] = image.at(x, y);
  }
  return part;
}

}  // namespace

ImagePart part_within_reach(const ImageView& image, Pixel near, double reach, int around) {
  const bool is_inside = near.u >= -reach && near.v >= -reach && near.u <= image.width + reach &&
                         near.v <= image.height + reach;
  if (image.data == nullptr || !(reach > 0) || !is_inside) return {};
  return part_around(image, near, static_cast<int>(std::ceil(reach)) + around);
}

}  // namespace calvin
