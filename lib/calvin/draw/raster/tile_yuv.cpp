// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Most pixels of a tile are transparent, and most others like the one before them.

#include "calvin/draw/raster/tile_yuv.hpp"

#include <algorithm>
#include <array>
#include <cstring>

namespace calvin {

namespace {

using Ayuv = std::array<std::uint8_t, 4>;

std::uint8_t clamped(int value) noexcept {
  return static_cast<std::uint8_t>(std::clamp(value, 0, 255));
}

// The matrix in 256ths, as libgstvideo has it.
Ayuv convert(std::uint32_t argb) noexcept {
  const int alpha = static_cast<int>(argb >> 24);
  const auto level = [&](unsigned shift) {
    const int premultiplied = static_cast<int>(argb >> shift & 0xFF);
    return std::min(255, (premultiplied * 255 + alpha / 2) / alpha);
  };
  const int r = level(16);
  const int g = level(8);
  const int b = level(0);
  return {static_cast<std::uint8_t>(alpha), clamped((47 * r + 157 * g + 16 * b + 4096) >> 8),
          clamped((-26 * r - 87 * g + 112 * b + 32768) >> 8),
          clamped((112 * r - 102 * g - 10 * b + 32768) >> 8)};
}

}  // namespace

std::vector<std::uint8_t> ayuv_of(const OverlayTile& tile) {
  std::vector<std::uint8_t> pixels(tile.pixels.size());
  std::uint32_t before = 0;
  Ayuv converted{};
  for (std::size_t i = 0; i + 4 <= pixels.size(); i += 4) {
    std::uint32_t argb = 0;
    std::memcpy(&argb, &tile.pixels[i], sizeof(argb));
    if (argb >> 24 == 0) continue;
    if (argb != before) converted = convert(argb);
    before = argb;
    std::memcpy(&pixels[i], converted.data(), converted.size());
  }
  return pixels;
}

}  // namespace calvin
