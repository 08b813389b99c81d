// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Compares pixels with the darkest and the lightest ones of the tiles around them.

#include "calvin/detect/tags/local_threshold.hpp"

#include <algorithm>

namespace calvin::detect {

namespace {

constexpr int kTile = 4;  // px

}  // namespace

// The loops over a row are without conditions, for the compiler to make vectors of them.
void ToneImage::take_tiles(const ImageView& image) {
  tile_cols_ = (width_ + kTile - 1) / kTile;
  tile_rows_ = (height_ + kTile - 1) / kTile;
  const auto cols = static_cast<std::size_t>(tile_cols_);
  least_.resize(cols * static_cast<std::size_t>(tile_rows_));
  most_.resize(least_.size());
  // Of the columns of a row of tiles; beyond the image as the last one.
  row_least_.resize(cols * kTile);
  row_most_.resize(cols * kTile);
  const auto width = static_cast<std::size_t>(width_);
  for (int tile_row = 0; tile_row < tile_rows_; ++tile_row) {
    const int first = tile_row * kTile;
    std::uint8_t* low = row_least_.data();
    std::uint8_t* high = row_most_.data();
    std::copy_n(image.data + first * image.stride, width, low);
    std::copy_n(image.data + first * image.stride, width, high);
    for (int y = first + 1; y < std::min(first + kTile, height_); ++y) {
      const std::uint8_t* row = image.data + y * image.stride;
      for (std::size_t x = 0; x < width; ++x) {
        low[x] = std::min(low[x], row[x]);
        high[x] = std::max(high[x], row[x]);
      }
    }
    std::fill(low + width, low + cols * kTile, low[width - 1]);
    std::fill(high + width, high + cols * kTile, high[width - 1]);
    std::uint8_t* least = least_.data() + static_cast<std::size_t>(tile_row) * cols;
    std::uint8_t* most = most_.data() + static_cast<std::size_t>(tile_row) * cols;
    for (std::size_t col = 0; col < cols; ++col) {
      const std::uint8_t* l = low + col * kTile;
      const std::uint8_t* m = high + col * kTile;
      least[col] = std::min(std::min(l[0], l[1]), std::min(l[2], l[3]));
      most[col] = std::max(std::max(m[0], m[1]), std::max(m[2], m[3]));
    }
  }
}

// Of the tiles around each tile of a row: the least and the most of three rows, and then of three
// columns.
void ToneImage::take_thresholds(int tile_row, int contrast) {
  const auto cols = static_cast<std::size_t>(tile_cols_);
  const auto at = [&](int row) { return static_cast<std::size_t>(row) * cols; };
  const std::size_t above = at(std::max(tile_row - 1, 0));
  const std::size_t own = at(tile_row);
  const std::size_t below = at(std::min(tile_row + 1, tile_rows_ - 1));
  std::uint8_t* low = row_least_.data();
  std::uint8_t* high = row_most_.data();
  for (std::size_t col = 0; col < cols; ++col) {
    low[col] = std::min(std::min(least_[above + col], least_[own + col]), least_[below + col]);
    high[col] = std::max(std::max(most_[above + col], most_[own + col]), most_[below + col]);
  }
  for (std::size_t col = 0; col < cols; ++col) {
    const std::size_t before = col > 0 ? col - 1 : col;
    const std::size_t after = std::min(col + 1, cols - 1);
    const int least = std::min(std::min(low[before], low[col]), low[after]);
    const int most = std::max(std::max(high[before], high[col]), high[after]);
    const bool is_plain = most - least < contrast;
    for (std::size_t k = col * kTile; k < (col + 1) * kTile; ++k) {
      middle_[k] = static_cast<std::uint8_t>((least + most) / 2);
      seen_[k] = is_plain ? 0 : 0xff;
    }
  }
}

void ToneImage::take(const ImageView& image, int contrast) {
  width_ = image.width;
  height_ = image.height;
  tones_.assign(static_cast<std::size_t>(width_ + 2) * static_cast<std::size_t>(height_ + 2),
                kNoTone);
  if (width_ <= 0 || height_ <= 0) return;
  take_tiles(image);
  middle_.resize(static_cast<std::size_t>(tile_cols_ * kTile));
  seen_.resize(middle_.size());
  const auto width = static_cast<std::size_t>(width_);
  for (int tile_row = 0; tile_row < tile_rows_; ++tile_row) {
    take_thresholds(tile_row, contrast);
    const std::uint8_t* middle = middle_.data();
    const std::uint8_t* seen = seen_.data();
    for (int y = tile_row * kTile; y < std::min((tile_row + 1) * kTile, height_); ++y) {
      const std::uint8_t* grey = image.data + y * image.stride;
      std::uint8_t* tone = tones_.data() + index(0, y);
      for (std::size_t x = 0; x < width; ++x) {
        const std::uint8_t own = grey[x] > middle[x] ? kLightTone : kDarkTone;
        tone[x] = own & seen[x];
      }
    }
  }
}

}  // namespace calvin::detect
