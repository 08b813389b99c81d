// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Boards over several sheets: their parts join without a gap, are cut between control points, and
// together they are the board.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/draw/board_drawing.hpp"
#include "calvin/target/artwork/artwork.hpp"
#include "calvin/target/kinds.hpp"
#include "calvin_config.h"

#include "artwork_at.hpp"
#include "read_picture.hpp"

namespace calvin {
namespace {

Board board_of(const char* text) { return parse_board(text).value(); }

// The part of the board that is cut out of a sheet, m in the board frame.
BoardArea part_of(const BoardTile& tile) {
  return {tile.left - tile.page.x, tile.top - tile.page.y, tile.right - tile.page.x,
          tile.bottom - tile.page.y};
}

TEST(BoardTiles, JoinToTheWholeBoardWithItsBorder) {
  for (const char* text : {"checkerboard:14x9:40mm", "puzzle:20x13:30mm", "acircles:9x20:30mm",
                           "circles:30x7:25mm:inverted"}) {
    const Board board = board_of(text);
    for (const char* paper : {"a4", "Letter", "auto", "a3"}) {
      const auto tiles = lay_out_tiles(board, paper);
      ASSERT_TRUE(tiles) << tiles.error().message;
      ASSERT_EQ(static_cast<int>(tiles->size()), tiles->front().cols * tiles->front().rows);
      const BoardArea outline = board.outline();
      const BoardArea first = part_of(tiles->front());
      const BoardArea last = part_of(tiles->back());
      const double border = board.cell_size(0) / 2;
      EXPECT_NEAR(first.left, outline.left - border, 1e-12);
      EXPECT_NEAR(first.top, outline.top - border, 1e-12);
      EXPECT_NEAR(last.right, outline.right + border, 1e-12);
      EXPECT_NEAR(last.bottom, outline.bottom + border, 1e-12);
      for (std::size_t i = 0; i < tiles->size(); ++i) {
        const BoardTile& tile = (*tiles)[i];
        EXPECT_GE(tile.left, 0.01 - 1e-12);
        EXPECT_GE(tile.top, 0.01 - 1e-12);
        EXPECT_LE(tile.right, tile.page.width - 0.01 + 1e-12);
        EXPECT_LE(tile.bottom, tile.page.height - 0.02 + 1e-12) << "the text has room";
        if (tile.col > 0) {
          EXPECT_NEAR(part_of(tile).left, part_of((*tiles)[i - 1]).right, 1e-12);
        }
      }
    }
  }
}

TEST(BoardTiles, AreCutFarFromControlPoints) {
  for (const char* text : {"checkerboard:14x9:40mm", "puzzle:20x13:30mm", "circles:20x14:25mm"}) {
    const Board board = board_of(text);
    const double least = 0.45 * board.cell_size(0);
    const auto tiles = lay_out_tiles(board, "a4").value();
    ASSERT_GT(tiles.size(), 1U);
    for (const Eigen::Vector3d& p : board.points()) {
      for (const BoardTile& tile : tiles) {
        const BoardArea part = part_of(tile);
        EXPECT_GT(std::abs(p.x() - part.left), least) << text;
        EXPECT_GT(std::abs(p.x() - part.right), least) << text;
        EXPECT_GT(std::abs(p.y() - part.top), least) << text;
        EXPECT_GT(std::abs(p.y() - part.bottom), least) << text;
      }
    }
  }
  // Squares larger than a sheet are cut where it ends.
  EXPECT_GT(lay_out_tiles(board_of("checkerboard:3x3:400mm"), "a4").value().size(), 4U);
}

TEST(BoardTiles, NeedNoMoreSheetsThanTheyMust) {
  EXPECT_EQ(lay_out_tiles(board_of("checkerboard:9x6:20mm"), "a4").value().size(), 1U);
  EXPECT_EQ(lay_out_tiles(board_of("checkerboard:9x6:40mm"), "a3").value().size(), 2U);
  EXPECT_FALSE(lay_out_tiles(board_of("checkerboard:9x6:40mm"), "fit"));
  EXPECT_FALSE(lay_out_tiles(board_of("dot"), "a4"));
  const auto many = lay_out_tiles(board_of("checkerboard:200x200:1000m"), "a4");
  ASSERT_FALSE(many);
  EXPECT_NE(many.error().message.find("more than 200 sheets"), std::string::npos);
}

#if CALVIN_HAVE_CAIRO

// A pixel in the part that is cut out whose surroundings are of one colour has it.
TEST(BoardTiles, ShowTheirPartsOfTheBoard) {
  constexpr double kDpi = 100;
  constexpr double kPixel = 0.0254 / kDpi;
  const Board board = board_of("puzzle:11x8:30mm");
  const Artwork artwork = artwork_of(board);
  const auto files = draw_tiles(board, {DrawingFormat::kPng, "a4", kDpi});
  ASSERT_TRUE(files) << files.error().message;
  const auto tiles = lay_out_tiles(board, "a4").value();
  ASSERT_EQ(files->size(), tiles.size());
  ASSERT_GT(tiles.size(), 1U);
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    const BoardTile& tile = tiles[i];
    const GrayImage image = scenes::decode_png((*files)[i]);
    const auto is_dark = [&](double u, double v) {
      return scenes::is_dark_at(artwork, (u + 0.5) * kPixel - tile.page.x,
                                (v + 0.5) * kPixel - tile.page.y);
    };
    int plain = 0;
    for (int v = static_cast<int>(tile.top / kPixel) + 2; v < tile.bottom / kPixel - 2; v += 3) {
      for (int u = static_cast<int>(tile.left / kPixel) + 2; u < tile.right / kPixel - 2; u += 3) {
        const bool dark = is_dark(u, v);
        bool same = true;
        for (const double x : {-1.1, 0.0, 1.1}) {
          for (const double y : {-1.1, 0.0, 1.1}) same = same && is_dark(u + x, v + y) == dark;
        }
        if (!same) continue;
        ++plain;
        ASSERT_EQ(image.view().at(u, v), dark ? 0 : 255) << i << ": " << u << ", " << v;
      }
    }
    EXPECT_GT(plain, 1000) << i;
    // The mark beside the upper left corner, 2 to 6 mm outside.
    int dark = 0;
    const int mark = static_cast<int>((tile.left - 0.004) / kPixel);
    const auto at = static_cast<int>(std::lround(tile.top / kPixel - 0.5));
    for (int v = at - 2; v <= at + 2; ++v) dark += image.view().at(mark, v) < 200 ? 1 : 0;
    EXPECT_GT(dark, 0) << i;
  }
}

TEST(BoardTiles, ArePagesOfOnePdf) {
  const Board board = board_of("checkerboard:14x9:40mm");
  const auto files = draw_tiles(board, {DrawingFormat::kPdf, "a4"});
  ASSERT_TRUE(files) << files.error().message;
  ASSERT_EQ(files->size(), 1U);
  std::size_t pages = 0;
  for (auto at = files->front().find("/Type /Page"); at != std::string::npos;
       at = files->front().find("/Type /Page", at + 1)) {
    pages += files->front().compare(at, 12, "/Type /Pages") != 0 ? 1 : 0;
  }
  EXPECT_EQ(pages, lay_out_tiles(board, "a4").value().size());
}

#endif

}  // namespace
}  // namespace calvin
