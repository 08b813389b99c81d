// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The overlay of a video: what is left of earlier frames is not seen in later ones, and tiles that
// hold what is painted alone look like whole ones.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/draw/overlay.hpp"
#include "calvin/draw/raster/tile_stamp.hpp"
#include "calvin_config.h"

#if CALVIN_HAVE_CAIRO

namespace calvin {
namespace {

constexpr ImageSize kFrame{640, 360};

// A board that turns, comes nearer, and leaves the frame at the end.
Observation board_at(int frame) {
  Observation o;
  o.board = "checkerboard:9x6:25mm";
  o.image_size = kFrame;
  const double pitch = 12 + 1.7 * frame;
  const double turn = 0.2 * frame;
  for (int id = 0; id < 54; ++id) {
    const double x = pitch * (id % 9);
    const double y = pitch * std::floor(id / 9.0);
    o.ids.push_back(id);
    o.uv.push_back({150.3 + 20 * frame + x * std::cos(turn) - y * std::sin(turn),
                    120.8 + x * std::sin(turn) + y * std::cos(turn)});
    o.sigma.push_back(0.1);
  }
  return o;
}

TEST(OverlayFrames, AreDrawnAsIfEachWereTheFirst) {
  OverlayPainter painter;
  for (int n : {0, 1, 2, 2, 9, 3, 20, 4, 4, 5, 12, 0}) {
    const std::vector<Observation> seen = {board_at(n)};
    const auto alone = draw_overlay(kFrame, seen, {});
    ASSERT_TRUE(alone.has_value());
    const auto tiles = painter.draw(kFrame, seen, {});
    ASSERT_TRUE(tiles.has_value());
    ASSERT_EQ(tiles->size(), alone->size()) << "frame " << n;
    for (std::size_t i = 0; i < tiles->size(); ++i) {
      const OverlayTile whole = whole_tile((*tiles)[i]);
      const OverlayTile& expected = (*alone)[i];
      EXPECT_EQ(whole.x, expected.x);
      EXPECT_EQ(whole.y, expected.y);
      EXPECT_EQ(whole.width, expected.width);
      EXPECT_EQ(whole.pixels, expected.pixels) << "frame " << n << ", tile " << i;
    }
  }
}

struct Frame {
  explicit Frame(const PixelLayout& l) : layout(l) {
    const auto stride = static_cast<std::size_t>(4 * kFrame.width);
    for (std::size_t p = 0; p < bytes.size(); ++p) {
      bytes[p].resize(stride * static_cast<std::size_t>(kFrame.height));
      for (std::size_t i = 0; i < bytes[p].size(); ++i) {
        bytes[p][i] = static_cast<std::uint8_t>(i * 37 + i / 251);
      }
      planes.data[p] = bytes[p].data();
      planes.stride[p] = static_cast<std::ptrdiff_t>(stride);
    }
  }
  PixelLayout layout;
  std::array<std::vector<std::uint8_t>, 3> bytes;
  FramePlanes planes;
};

PixelLayout nv12() {
  return {{{{0, 0, 1, 0, 0}, {1, 0, 2, 1, 1}, {1, 1, 2, 1, 1}}}, 3, false, kFrame};
}
PixelLayout bgrx() {
  return {{{{0, 2, 4, 0, 0}, {0, 1, 4, 0, 0}, {0, 0, 4, 0, 0}}}, 3, true, kFrame};
}

// Once as it is seen for the first time, and as a stamp that is kept; cut off by both sides of the
// frame, and at odd places.
TEST(OverlayFrames, TilesOfSpansLookLikeWholeOnes) {
  const std::vector<Observation> seen = {board_at(3)};
  OverlayPainter painter;
  const auto tiles = painter.draw(kFrame, seen, {});
  ASSERT_TRUE(tiles.has_value());
  ASSERT_FALSE(tiles->empty());
  for (const PixelLayout& layout : {nv12(), bgrx()}) {
    for (const auto& [dx, dy] : {std::pair{0, 0}, {-3, 1}, {-200, -130}, {401, 7}}) {
      Frame of_spans(layout);
      Frame of_wholes(layout);
      TileStamps spans;
      TileStamps wholes;
      for (int time = 0; time < 3; ++time) {
        spans.begin_frame(layout);
        wholes.begin_frame(layout);
        for (const OverlayTile& tile : *tiles) {
          ASSERT_FALSE(tile.spans.empty());
          spans.blend(tile, tile.x + dx, tile.y + dy, of_spans.planes);
          wholes.blend(whole_tile(tile), tile.x + dx, tile.y + dy, of_wholes.planes);
        }
        EXPECT_EQ(of_spans.bytes, of_wholes.bytes) << dx << ", " << dy << ", time " << time;
      }
      EXPECT_NE(of_spans.bytes, Frame(layout).bytes) << "something is seen";
    }
  }
}

}  // namespace
}  // namespace calvin

#endif
