// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The loops over the bytes of stamps. Private to draw/ and the elements.
#pragma once

#include <array>
#include <cstdint>

#include "calvin/draw/raster/tile_stamp.hpp"

namespace calvin {

// The planes are those of a frame of the layout and size of which the stamp was made.
void blend_stamp(const TileStamp& stamp, const FramePlanes& frame) noexcept;

// Where the components of pixels go, with room for `kSpareComponents` more than there are.
struct ComponentRows {
  std::uint8_t* add[3];  // premultiplied
  std::uint8_t* keep;    // 255 - alpha
};
inline constexpr int kSpareComponents = 16;

// How many of a row's pixels are transparent before the first that is not: a multiple of 16, or
// all.
[[nodiscard]] int blank_pixels(const std::uint8_t* argb, int count) noexcept;

// The rows of which a plane's bytes are made, of pixel after pixel: 1 to 4 rows in turn, and of
// each every 2^shift-th element.
struct InterleavedRows {
  std::array<const std::uint8_t*, 4> from{};
  int count = 0;
  int shift = 0;  // 0 or 1
};

// `samples` of each row, of 2^shift elements each.
void interleave(const InterleavedRows& rows, int samples, std::uint8_t* to) noexcept;

// Of a tile's pixels: R G B, or Y U V as ayuv_of() has it, but premultiplied, or Y of these alone
// where a row has no chroma.
enum class Split { kRgb, kYuv, kLuma };
void split_pixels(const std::uint8_t* argb, int count, Split split,
                  const ComponentRows& to) noexcept;

}  // namespace calvin
