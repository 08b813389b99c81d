// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Compares pixels with the darkest and the lightest ones of the tiles around them.

#include "calvin/detect/tags/local_threshold.hpp"

#include <algorithm>

namespace calvin::detect {

namespace {

constexpr int kTile = 4;  // px

}  // namespace

void ToneImage::take_tiles(const ImageView& image) {
  tile_cols_ = (width_ + kTile - 1) / kTile;
  tile_rows_ = (height_ + kTile - 1) / kTile;
  const auto tiles = static_cast<std::size_t>(tile_cols_) * static_cast<std::size_t>(tile_rows_);
  least_.assign(tiles, 255);
  most_.assign(tiles, 0);
  for (int y = 0; y < height_; ++y) {
    const std::uint8_t* row = image.data + y * image.stride;
    const auto first = static_cast<std::size_t>(y / kTile) * static_cast<std::size_t>(tile_cols_);
    for (int col = 0; col < tile_cols_; ++col) {
      std::uint8_t& least = least_[first + static_cast<std::size_t>(col)];
      std::uint8_t& most = most_[first + static_cast<std::size_t>(col)];
      const int end = std::min((col + 1) * kTile, width_);
      for (int x = col * kTile; x < end; ++x) {
        least = std::min(least, row[x]);
        most = std::max(most, row[x]);
      }
    }
  }
}

void ToneImage::take(const ImageView& image, int contrast) {
  width_ = image.width;
  height_ = image.height;
  tones_.assign(static_cast<std::size_t>(width_ + 2) * static_cast<std::size_t>(height_ + 2),
                kNoTone);
  take_tiles(image);
  for (int tile_row = 0; tile_row < tile_rows_; ++tile_row) {
    for (int tile_col = 0; tile_col < tile_cols_; ++tile_col) {
      int least = 255;
      int most = 0;
      for (int row = std::max(tile_row - 1, 0); row <= std::min(tile_row + 1, tile_rows_ - 1);
           ++row) {
        for (int col = std::max(tile_col - 1, 0); col <= std::min(tile_col + 1, tile_cols_ - 1);
             ++col) {
          const auto at = static_cast<std::size_t>(row * tile_cols_ + col);
          least = std::min<int>(least, least_[at]);
          most = std::max<int>(most, most_[at]);
        }
      }
      if (most - least < contrast) continue;
      const int middle = (least + most) / 2;
      for (int y = tile_row * kTile; y < std::min((tile_row + 1) * kTile, height_); ++y) {
        const std::uint8_t* grey = image.data + y * image.stride;
        std::uint8_t* tone = tones_.data() + index(0, y);
        for (int x = tile_col * kTile; x < std::min((tile_col + 1) * kTile, width_); ++x) {
          tone[x] = grey[x] > middle ? kLightTone : kDarkTone;
        }
      }
    }
  }
}

}  // namespace calvin::detect
