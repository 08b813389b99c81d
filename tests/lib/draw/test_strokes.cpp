// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The areas that lines, circles, discs and boxes cover, beside those of geometry.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/draw/raster/stroke_kernels.hpp"

namespace calvin {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr Ink kWhiteInk{{255, 255, 255, 255}};

// A tile on which one thing is painted.
struct Painted {
  Painted(int w, int h) : width(w), height(h) { planes.begin(w, h); }
  void merge() {
    OverlayTile tile{.width = width, .height = height};
    planes.take_painted(tile.spans);
    tile.pixels.resize(static_cast<std::size_t>(4 * width * height));
    merge_planes(planes, tile.spans, tile.pixels.data());
    pixels = whole_tile(tile).pixels;
  }
  [[nodiscard]] std::uint32_t argb(int x, int y) const {
    std::uint32_t pixel = 0;
    std::copy_n(&pixels[static_cast<std::size_t>(4 * (y * width + x))], 4,
                reinterpret_cast<std::uint8_t*>(&pixel));
    return pixel;
  }
  // Of a channel, in whole px.
  [[nodiscard]] double area(unsigned shift) const {
    double sum = 0;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) sum += (argb(x, y) >> shift & 255) / 255.0;
    }
    return sum;
  }

  int width;
  int height;
  TilePlanes planes;
  std::vector<std::uint8_t> pixels;
};

Stroke line(double x, double y, double angle, double length, double width) {
  const auto f = [](double value) { return static_cast<float>(value); };
  return {.x = f(x),
          .y = f(y),
          .along_x = f(std::cos(angle)),
          .along_y = f(std::sin(angle)),
          .length = f(length),
          .half = f(width / 2)};
}

TEST(Strokes, LinesCoverTheirLengthTimesTheirWidthAndRoundEnds) {
  for (const double width : {1.0, 2.7, 6.0}) {
    for (double angle = 0; angle < 2 * kPi; angle += 0.37) {
      Painted p(103, 97);
      paint_stroke(line(50.3, 48.8, angle, 35, width), kWhiteInk, p.planes);
      p.merge();
      const double expected = 35 * width + kPi * width * width / 4;
      EXPECT_NEAR(p.area(24), expected, 0.03 * expected) << width << ", " << angle;
    }
  }
}

TEST(Strokes, CirclesAndDiscsCoverTheirAreas) {
  for (const double at : {40.0, 40.3, 40.75}) {
    Painted circle(83, 81);
    Stroke s = line(at, at - 0.4, 0, 0, 3);
    s.along_x = 0;
    s.radius = 17.3F;
    paint_stroke(s, kWhiteInk, circle.planes);
    circle.merge();
    EXPECT_NEAR(circle.area(24), 2 * kPi * 17.3 * 3, 0.02 * 2 * kPi * 17.3 * 3);
    EXPECT_EQ(circle.argb(40, 40), 0U) << "its middle stays in sight";
    Painted disc(83, 81);
    s.radius = 0;
    s.half = 17.3F;
    paint_stroke(s, kWhiteInk, disc.planes);
    disc.merge();
    EXPECT_NEAR(disc.area(24), kPi * 17.3 * 17.3, 0.01 * kPi * 17.3 * 17.3);
  }
}

// Of the dark around it half is seen, and no more where two of them meet.
TEST(Strokes, TheDarkLiesUnderAllShapes) {
  Painted p(64, 32);
  Stroke s = line(10, 15, 0, 40, 4);
  s.halo = 3;
  paint_stroke(s, kWhiteInk, p.planes);
  s.y = 21;
  paint_stroke(s, {{0, 0, 255, 255}}, p.planes);
  p.merge();
  EXPECT_EQ(p.argb(30, 15), 0xFFFFFFFFU);
  EXPECT_EQ(p.argb(30, 21), 0xFFFF0000U);
  EXPECT_EQ(p.argb(30, 18), 0x80000000U);
  EXPECT_EQ(p.argb(30, 11), 0x80000000U);
  EXPECT_EQ(p.argb(30, 5), 0U);
}

TEST(Strokes, BoxesCoverPartsOfPixels) {
  Painted p(50, 40);
  paint_box({3.25F, 5.5F, 37.75F, 20.25F}, {{0, 255, 0, 128}}, p.planes);
  p.merge();
  const double area = (37.75 - 3.25) * (20.25 - 5.5);
  EXPECT_NEAR(p.area(24), area * 128 / 255, 0.5);
  EXPECT_NEAR(p.area(8), area * 128 / 255, 0.5);
  EXPECT_EQ(p.area(16), 0);
  EXPECT_EQ(p.argb(20, 10), 0x80008000U);
}

// A line goes on in the next tile as if there were none.
TEST(Strokes, TilesMeet) {
  Painted whole(96, 64);
  const Stroke s = line(-20, 70, -0.6, 150, 5.5);
  paint_stroke(s, kWhiteInk, whole.planes);
  whole.merge();
  for (const int left : {0, 20, 52}) {
    for (const int top : {0, 12, 40}) {
      Painted part(44, 24);
      Stroke moved = s;
      moved.x -= static_cast<float>(left);
      moved.y -= static_cast<float>(top);
      paint_stroke(moved, kWhiteInk, part.planes);
      part.merge();
      for (int y = 0; y < 24; ++y) {
        for (int x = 0; x < 44; ++x) {
          const int a = static_cast<int>(part.argb(x, y) >> 24);
          EXPECT_NEAR(a, static_cast<int>(whole.argb(left + x, top + y) >> 24), 1);
        }
      }
    }
  }
}

// What was painted in a tile is gone in the next one.
TEST(Strokes, ATileBeginsEmpty) {
  Painted p(70, 30);
  paint_box({0, 0, 70, 30}, kWhiteInk, p.planes);
  p.merge();
  p.planes.begin(40, 50);
  p.width = 40;
  p.height = 50;
  p.merge();
  EXPECT_EQ(p.area(24), 0);
}

}  // namespace
}  // namespace calvin
