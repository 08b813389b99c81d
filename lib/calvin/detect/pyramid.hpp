// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// An image and its halves, quarters, ...: a board is looked for in the smallest first.
#pragma once

#include <vector>

#include "calvin/camera/image_transform.hpp"
#include "calvin/core/image.hpp"

namespace calvin::detect {

class Pyramid {
 public:
  static constexpr int kMaxLevels = 8;
  // Smaller levels have no room for the corners of a board.
  static constexpr ImageSize kLeastForCorners = {150, 100};

  // Level 0 is the image itself, in place wherever its pixels lie side by side; each further level
  // has half the size, as long as that is not below the least one. Keeps its memory.
  void build(const ImageView& image, int most_levels = kMaxLevels,
             ImageSize least = kLeastForCorners);

  [[nodiscard]] int levels() const noexcept { return count_; }
  [[nodiscard]] const ImageView& level(int i) const { return views_[static_cast<std::size_t>(i)]; }
  // The same level for a search: smoothed where it is noisy, which is found out when it is asked
  // for first.
  [[nodiscard]] const ImageView& calm_level(int i);

  // From the pixels of a level to those of the image.
  [[nodiscard]] static float to_image(float u, int level) noexcept {
    return scaled_coordinate(u, static_cast<float>(1 << level));
  }
  // And back.
  [[nodiscard]] static double to_level(double u, int level) noexcept {
    return scaled_coordinate(u, 1.0 / (1 << level));
  }

 private:
  int count_ = 0;
  ImageView views_[kMaxLevels];
  ImageView calm_[kMaxLevels];                    // without data where nobody has asked yet
  std::vector<std::uint8_t> pixels_[kMaxLevels];  // of levels 1 and up
  std::vector<std::uint8_t> calm_pixels_[kMaxLevels];
  std::vector<std::uint16_t> sums_;
  GrayImage own_;  // level 0 of an image whose pixels do not lie side by side
};

}  // namespace calvin::detect
