// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The pixels from which a corner is fitted.
#pragma once

#include <cstdint>

#include "calvin/core/image.hpp"
#include "calvin/detect/checkerboard/corners/corner.hpp"

namespace calvin::detect {

inline constexpr int kMostPixels = 2600;  // of a window
inline constexpr float kRim = 1.2F;  // px beyond the radius, for the corner is not the middle pixel
inline constexpr int kLongestVector = 64;           // lanes
inline constexpr int kBeyond = 2 * kLongestVector;  // two vectors may read beyond the window

// The pixels of a window, in coordinates from its middle pixel.
struct Window {
  int count = 0;
  bool whole = true;  // not cut by the border of the image
  alignas(64) float x[kMostPixels + kBeyond];
  alignas(64) float y[kMostPixels + kBeyond];
  alignas(64) float grey[kMostPixels + kBeyond];
  alignas(64) float error[kMostPixels + kBeyond];  // of the fit, times the root of the weight
};

// Takes the pixels of an image (of step 1) in a disc around (x, y) that are within `band` px of one
// of two lines through it, in the directions of the edges: pixels further off tell nothing of the
// corner. The disc is made smaller where the window cannot hold its pixels; returns its radius, px.
// Pixels of a whole window are listed point-symmetrically: the first is opposite to the last.
float gather(const ImageView& image, int x, int y, float radius, float band, Direction along,
             Direction down, Window& window) noexcept;

// Appends the pixels of a row from column `first` to `last` from a window's middle column, at which
// `row` points; the image ends before column `end`.
void append_row(const std::uint8_t* row, int first, int last, int end, float y,
                Window& window) noexcept;

// The mean grey levels on the two sides of a corner at (x, y) from the middle of a window: between
// the edges `along` and `down` and opposite, and in the other two squares.
struct SquareMeans {
  float between = 0;
  float beside = 0;
};
[[nodiscard]] SquareMeans square_means(const Window& window, Direction along, Direction down,
                                       float x, float y) noexcept;

// The sum of the squares of the differences between errors of opposite pixels, first to last.
[[nodiscard]] float odd_square(const Window& window) noexcept;

}  // namespace calvin::detect
