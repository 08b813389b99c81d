// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Compares pixels with the darkest and the lightest ones of the tiles around them.

#include "calvin/detect/tags/local_threshold.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

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
  row_least_.resize(cols * kTile + 2);
  row_most_.resize(cols * kTile + 2);
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
  // With one more at both ends, as the ones beside them.
  std::uint8_t* low = row_least_.data() + 1;
  std::uint8_t* high = row_most_.data() + 1;
  const std::uint8_t* least = least_.data();
  const std::uint8_t* most = most_.data();
  for (std::size_t col = 0; col < cols; ++col) {
    low[col] = std::min(std::min(least[above + col], least[own + col]), least[below + col]);
    high[col] = std::max(std::max(most[above + col], most[own + col]), most[below + col]);
  }
  for (std::uint8_t* ends : {low, high}) {
    ends[-1] = ends[0];
    ends[cols] = ends[cols - 1];
  }
  std::uint8_t* middles = tile_middle_.data();
  std::uint8_t* seen = tile_seen_.data();
  for (std::size_t col = 0; col < cols; ++col) {
    const std::uint8_t dark = std::min(std::min(*(low + col - 1), low[col]), low[col + 1]);
    const std::uint8_t light = std::max(std::max(*(high + col - 1), high[col]), high[col + 1]);
    middles[col] = static_cast<std::uint8_t>((dark + light) / 2);
    seen[col] = light - dark < contrast ? 0 : 0xff;
  }
  // The same for all pixels of a tile, which are four.
  static_assert(kTile == sizeof(std::uint32_t));
  const auto spread = [cols](const std::uint8_t* tiles, std::uint8_t* pixels) {
    for (std::size_t col = 0; col < cols; ++col) {
      const std::uint32_t four = 0x01010101U * tiles[col];
      std::memcpy(pixels + col * kTile, &four, kTile);
    }
  };
  spread(middles, middle_.data());
  spread(seen, seen_.data());
}

void ToneImage::take(const ImageView& image, int contrast) {
  width_ = image.width;
  height_ = image.height;
  // Each pixel gets its tone; only the rim is none's.
  const auto stride = static_cast<std::size_t>(width_) + 2;
  const auto rows = static_cast<std::size_t>(height_) + 2;
  tones_.resize(stride * rows);
  std::fill_n(tones_.begin(), stride, kNoTone);
  std::fill_n(tones_.end() - static_cast<std::ptrdiff_t>(stride), stride, kNoTone);
  for (std::size_t row = 1; row + 1 < rows; ++row) {
    tones_[row * stride] = kNoTone;
    tones_[(row + 1) * stride - 1] = kNoTone;
  }
  if (width_ <= 0 || height_ <= 0) return;
  take_tiles(image);
  middle_.resize(static_cast<std::size_t>(tile_cols_ * kTile));
  seen_.resize(middle_.size());
  tile_middle_.resize(static_cast<std::size_t>(tile_cols_));
  tile_seen_.resize(tile_middle_.size());
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
