// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a camera that stands still sees without the light: a level and its spread for each pixel, so
// that lamps and windows that stand still are no lights. After the sigma-delta estimation of A.
// Manzanera, J. C. Richefeu, A new motion detection algorithm based on sigma-delta background
// estimation, Pattern Recognition Letters 28(3), 2007: with each frame the level goes one grey
// level towards the pixel, which leads to its median, and the spread one towards four times the
// difference. Beyond that, a level falls at once where the picture has become darker: what passed
// by in the first frame is forgotten soon. Internal.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "calvin/core/image.hpp"

namespace calvin::detect {

// Pixels of an image from `left` to `right` and from `top` to `bottom`, the last ones included.
struct PixelBox {
  int left = 0;
  int top = 0;
  int right = -1;
  int bottom = -1;

  [[nodiscard]] int width() const noexcept { return right - left + 1; }
  [[nodiscard]] int height() const noexcept { return bottom - top + 1; }
  [[nodiscard]] PixelBox grown(int by, ImageSize size) const noexcept;
};

// Neighbouring pixels of a row that are brighter than the background, from `first` to `last`.
struct BrightRun {
  int row = 0;
  int first = 0;
  int last = 0;
};

// All images have step 1 and, but for those of the start, the size of the first one.
class LightBackground {
 public:
  [[nodiscard]] bool has(ImageSize size) const noexcept { return size == size_; }
  void forget() noexcept { size_ = {}; }

  // From here on the background is what this image shows, or one level in all of it.
  void start(const ImageView& image);
  void start(ImageSize size, std::uint8_t level, std::uint8_t spread);

  // The pixels that are brighter than the background and what it may differ by, in the order of the
  // image; at most `most` of them, false where there are more.
  [[nodiscard]] bool find_brighter(const ImageView& image, std::size_t most,
                                   std::vector<BrightRun>& runs) const;

  // Goes a step towards the image, but not where the boxes are.
  void learn(const ImageView& image, const std::vector<PixelBox>& without);
  // Takes a part as it is: what stands there is no light.
  void take(const ImageView& image, const PixelBox& part);

  [[nodiscard]] std::uint8_t level(int x, int y) const noexcept { return level_[index(x, y)]; }
  // Grey levels, 1 sigma, of the noise of a pixel.
  [[nodiscard]] double noise(int x, int y) const noexcept;
  // By how much a pixel has to be brighter than its level to be found, grey levels.
  [[nodiscard]] int threshold(int x, int y) const noexcept;

 private:
  [[nodiscard]] std::size_t index(int x, int y) const noexcept {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(size_.width) +
           static_cast<std::size_t>(x);
  }

  ImageSize size_;
  std::vector<std::uint8_t> level_;
  std::vector<std::uint8_t> spread_;  // four times the median difference, in its limits
};

}  // namespace calvin::detect
