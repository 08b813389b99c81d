// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The bitmaps that an overlay comes as: small ones that cover only the touched parts of the frame,
// for blending costs per pixel, and one as large as the frame would cost more than everything else.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace calvin {

// Pixels of a row of a tile.
struct TileSpan {
  int row = 0;
  int first = 0;
  int count = 0;
  std::size_t at = 0;  // the first of them, of all that the tile holds
};

// A part of the drawing. `pixels` are 32-bit ARGB in the machine's byte order (B G R A in memory on
// little-endian ones), premultiplied, width * height, row by row. It lies inside the frame;
// x and y are multiples of 4, so that no chroma sample of a video frame lies in two tiles.
struct OverlayTile {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> pixels = {};
  // Where there are any, only the pixels in these are held, one span after another, from the top
  // and from the left; all others are transparent. `pixels` may be longer than these need.
  std::vector<TileSpan> spans = {};
  // Another one for each drawing: what is made of the tile may be kept by it. 0 where nothing may.
  std::uint64_t serial = 0;
};

// Any thread.
[[nodiscard]] std::uint64_t next_tile_serial() noexcept;

// The same tile with all of its pixels, and without spans.
[[nodiscard]] OverlayTile whole_tile(const OverlayTile& tile);

}  // namespace calvin
