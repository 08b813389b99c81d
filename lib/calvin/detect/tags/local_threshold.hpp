// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which pixels of an image are dark and which are light beside what is around them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "calvin/core/image.hpp"

namespace calvin::detect {

enum Tone : std::uint8_t { kNoTone = 0, kDarkTone = 1, kLightTone = 2 };

// The tones of an image, with a rim of a pixel without one around it, so that whoever follows an
// edge need not look out for the border.
class ToneImage {
 public:
  // A pixel is compared with the middle between the darkest and the lightest pixel of 12x12 around
  // it, as in AprilTag 2 (J. Wang, E. Olson, IROS 2016); it has no tone where these differ by less
  // than `contrast` grey levels. The image has step 1. Keeps its memory.
  void take(const ImageView& image, int contrast);

  [[nodiscard]] int width() const noexcept { return width_; }
  [[nodiscard]] int height() const noexcept { return height_; }
  // Pixels from a row to the next one.
  [[nodiscard]] int stride() const noexcept { return width_ + 2; }
  // From -1 to the width and to the height.
  [[nodiscard]] std::uint8_t& at(int x, int y) { return tones_[index(x, y)]; }
  [[nodiscard]] const std::uint8_t* row(int y) const { return tones_.data() + index(0, y); }

 private:
  [[nodiscard]] std::size_t index(int x, int y) const noexcept {
    return static_cast<std::size_t>(y + 1) * static_cast<std::size_t>(width_ + 2) +
           static_cast<std::size_t>(x + 1);
  }
  void take_tiles(const ImageView& image);
  // Sets `middle_` and `seen_` for the pixels of a row of tiles.
  void take_thresholds(int tile_row, int contrast);

  int width_ = 0;
  int height_ = 0;
  int tile_cols_ = 0;
  int tile_rows_ = 0;
  std::vector<std::uint8_t> tones_;
  std::vector<std::uint8_t> least_;  // of the pixels of a tile
  std::vector<std::uint8_t> most_;
  std::vector<std::uint8_t> row_least_;  // of a column of a row of tiles
  std::vector<std::uint8_t> row_most_;
  std::vector<std::uint8_t> tile_middle_;  // of a row of tiles, as those of pixels
  std::vector<std::uint8_t> tile_seen_;
  std::vector<std::uint8_t> middle_;  // grey level, of each column
  std::vector<std::uint8_t> seen_;    // all bits where there is contrast, else none
};

}  // namespace calvin::detect
