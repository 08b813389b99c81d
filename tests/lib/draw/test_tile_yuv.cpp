// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The colours of a tile for video that is not RGB.
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include <gtest/gtest.h>

#include "calvin/draw/raster/tile_yuv.hpp"

namespace calvin {
namespace {

// BT.709 in limited range: the levels of ITU-R BT.709-6, table 4, rounded to 8 bits.
TEST(TileYuv, HasTheColoursOfTheStandard) {
  struct Sample {
    std::uint32_t argb;
    std::array<int, 4> ayuv;
  };
  constexpr Sample kSamples[] = {
      {0xFFFFFFFF, {255, 235, 128, 128}}, {0xFF000000, {255, 16, 128, 128}},
      {0xFFFF0000, {255, 63, 102, 240}},  {0xFF00FF00, {255, 173, 42, 26}},
      {0xFF0000FF, {255, 32, 240, 118}},  {0x80800000, {128, 63, 102, 240}},
      {0x00000000, {0, 0, 0, 0}},         {0x80808080, {128, 235, 128, 128}}};
  OverlayTile tile{0, 0, 8, 1, std::vector<std::uint8_t>(32)};
  for (std::size_t i = 0; i < 8; ++i) std::memcpy(&tile.pixels[4 * i], &kSamples[i].argb, 4);
  const auto ayuv = ayuv_of(tile);
  ASSERT_EQ(ayuv.size(), tile.pixels.size());
  for (std::size_t i = 0; i < 8; ++i) {
    for (std::size_t c = 0; c < 4; ++c) {
      EXPECT_NEAR(ayuv[4 * i + c], kSamples[i].ayuv[c], 1) << i << ", " << c;
    }
  }
}

}  // namespace
}  // namespace calvin
