// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The mark over a light.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/draw/overlay.hpp"
#include "calvin_config.h"

namespace calvin {
namespace {

#if CALVIN_HAVE_CAIRO

// How opaque the overlay is at a pixel.
unsigned alpha_at(const std::vector<OverlayTile>& tiles, int x, int y) {
  unsigned alpha = 0;
  for (const OverlayTile& tile : tiles) {
    if (x < tile.x || y < tile.y || x >= tile.x + tile.width || y >= tile.y + tile.height) continue;
    std::uint32_t argb = 0;
    std::memcpy(
        &argb, &tile.pixels[static_cast<std::size_t>(4 * ((y - tile.y) * tile.width + x - tile.x))],
        4);
    alpha = argb >> 24;
  }
  return alpha;
}

TEST(OverlayOfALight, LeavesTheLightInSight) {
  Observation light;
  light.board = "dot";
  light.image_size = {640, 480};
  light.ids = {0};
  light.uv = {{300, 200}};
  light.sigma = {0.02};
  const auto tiles = draw_overlay({640, 480}, std::vector{light}, {});
  ASSERT_TRUE(tiles.has_value());
  for (int y = 197; y <= 203; ++y) {
    for (int x = 297; x <= 303; ++x) EXPECT_EQ(alpha_at(*tiles, x, y), 0U) << x << " " << y;
  }
  // To all sides there is something, and not far away.
  for (const auto& [u, v] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
    unsigned most = 0;
    int last = 0;
    for (int r = 4; r < 100; ++r) {
      const unsigned alpha = alpha_at(*tiles, 300 + r * u, 200 + r * v);
      most = std::max(most, alpha);
      if (alpha > 0) last = r;
    }
    EXPECT_GT(most, 200U);
    EXPECT_LT(last, 40);
  }
}

#endif

}  // namespace
}  // namespace calvin
