// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Manual points on the picture: a cross at each, and where its number stands.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/draw/mirrored.hpp"
#include "calvin/draw/overlay.hpp"
#include "calvin_config.h"

namespace calvin {
namespace {

constexpr ImageSize kFrame = {640, 480};
constexpr OverlayParts kPointsAlone = {.ghost = false, .coverage = false};

Progress with_points(std::vector<PlacedPoint> points) {
  Progress progress;
  progress.points = std::move(points);
  return progress;
}

PlacedPoint at_pixel(int id, double u, double v) {
  return {id, {(u + 0.5) / kFrame.width, (v + 0.5) / kFrame.height}};
}

TEST(OverlayOfPoints, NumbersStandBesideTheirPoints) {
  const Progress progress =
      with_points({at_pixel(7, 300, 200), at_pixel(12, 632, 100), at_pixel(3, 900, 100)});
  const auto numbers = overlay_point_numbers(kFrame, progress);
  ASSERT_EQ(numbers.size(), 2U) << "none for what is outside";
  EXPECT_EQ(numbers[0].text, "7");
  EXPECT_GT(numbers[0].at.u, 305);
  EXPECT_LT(numbers[0].at.u, 315);
  EXPECT_NEAR(numbers[0].at.v, 200, 1e-9);
  EXPECT_EQ(numbers[1].text, "12");
  EXPECT_LT(numbers[1].at.u + 2 * 0.6 * numbers[1].size, 630) << "on the other side at the border";
  const auto turned = overlay_point_numbers(kFrame, mirrored(progress));
  EXPECT_NEAR(turned[0].at.u - numbers[0].at.u, 639 - 2 * 300, 1e-9);
  const std::vector<PlacedPoint> many(2000, at_pixel(1, 300, 200));
  EXPECT_EQ(overlay_point_numbers(kFrame, with_points(many)).size(), Progress::kMostPoints);
  EXPECT_TRUE(overlay_point_numbers(kFrame, with_points({{1, {NAN, 0.5}}})).empty());
}

#if CALVIN_HAVE_CAIRO

// Blue, green, red and alpha of the overlay at a pixel.
std::array<std::uint8_t, 4> overlay_at(const std::vector<OverlayTile>& tiles, int x, int y) {
  std::array<std::uint8_t, 4> bgra{};
  for (const OverlayTile& tile : tiles) {
    if (x < tile.x || y < tile.y || x >= tile.x + tile.width || y >= tile.y + tile.height) continue;
    const auto at = static_cast<std::size_t>(4 * ((y - tile.y) * tile.width + x - tile.x));
    std::memcpy(bgra.data(), &tile.pixels[at], 4);
  }
  return bgra;
}

TEST(OverlayOfPoints, ACrossLeavesThePixelInSight) {
  const auto tiles = draw_overlay(
      kFrame, {}, with_points({at_pixel(0, 300, 200), at_pixel(1, 100, 100)}), kPointsAlone);
  ASSERT_TRUE(tiles.has_value());
  for (const int from : {-1, 0, 1}) {
    for (const int down : {-1, 0, 1}) {
      EXPECT_EQ(overlay_at(*tiles, 300 + from, 200 + down)[3], 0) << from << " " << down;
    }
  }
  for (const int x : {-1, 1}) {
    for (const int y : {-1, 1}) {
      const auto older = overlay_at(*tiles, 300 + 5 * x, 200 + 5 * y);
      EXPECT_GT(older[3], 200) << x << " " << y;
      EXPECT_LT(std::abs(older[1] - older[2]), 20) << "white";
      const auto newest = overlay_at(*tiles, 100 + 5 * x, 100 + 5 * y);
      EXPECT_GT(newest[1], newest[2] + 50) << "green";
    }
  }
  EXPECT_EQ(overlay_at(*tiles, 320, 200)[3], 0);
  const auto nothing = draw_overlay(kFrame, {}, Progress{}, kPointsAlone);
  ASSERT_TRUE(nothing.has_value());
  EXPECT_TRUE(nothing->empty());
}

#endif

}  // namespace
}  // namespace calvin
