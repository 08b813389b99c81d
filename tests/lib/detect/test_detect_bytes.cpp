// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Any bytes as an image: no byte beyond it is read, and the time has a bound. For a sanitizer too.
#include <cmath>
#include <ctime>
#include <iostream>
#include <memory>
#include <random>

#include <gtest/gtest.h>

#include "calvin/detect/detector.hpp"
#include "calvin/detect/luma.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

struct Shape {
  int width;
  int height;
  int padding;  // bytes between the rows
  int step;
};

enum class Kind { kConstant, kNoise, kGradient, kSaturated, kDots, kSquares };

std::uint8_t value(Kind kind, int x, int y, std::mt19937& random) {
  switch (kind) {
    case Kind::kConstant:
      return 77;
    case Kind::kNoise:
      return static_cast<std::uint8_t>(random());
    case Kind::kGradient:
      return static_cast<std::uint8_t>(x + 3 * y);
    case Kind::kSaturated:
      return random() % 2 == 0 ? 0 : 255;
    case Kind::kDots:
      return random() % 64 == 0 ? 255 : 0;
    case Kind::kSquares:
      return ((x / 11 + y / 11) % 2 == 0) ? 20 : 230;
  }
  return 0;
}

// As long as the last pixel's byte and no longer: what is read beyond is not ours.
struct Bytes {
  std::unique_ptr<std::uint8_t[]> data;
  ImageView view;
};

Bytes make_bytes(const Shape& s, Kind kind, std::mt19937& random) {
  const std::ptrdiff_t stride = static_cast<std::ptrdiff_t>(s.width) * s.step + s.padding;
  const auto size = static_cast<std::size_t>((s.height - 1) * stride + (s.width - 1) * s.step + 1);
  Bytes b{std::make_unique<std::uint8_t[]>(size), {}};
  b.view = {b.data.get(), s.width, s.height, stride, s.step};
  for (int y = 0; y < s.height; ++y) {
    for (int x = 0; x < s.width; ++x) {
      b.data[static_cast<std::size_t>(y * stride + x * s.step)] = value(kind, x, y, random);
    }
  }
  return b;
}

std::vector<Shape> shapes() {
  std::vector<Shape> all = {{1, 1, 0, 1},     {16, 16, 0, 1},   {17, 31, 3, 1},   {33, 16, 0, 2},
                            {299, 5, 0, 1},   {5, 299, 1, 1},   {160, 120, 0, 1}, {161, 123, 7, 2},
                            {320, 240, 0, 3}, {640, 480, 0, 1}, {8192, 24, 0, 1}, {24, 8192, 0, 4}};
  if (scenes::full_count()) {
    all.push_back({1001, 777, 5, 2});
    all.push_back({1920, 1080, 0, 1});
    all.push_back({8192, 8192, 0, 1});
  }
  return all;
}

double thread_ms() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

class BytesFor : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Boards, BytesFor,
                         ::testing::Values("checkerboard:9x6:25mm", "puzzle:9x6:25mm",
                                           "circles:7x5:30mm", "dots:7x5:30mm:big=0.0:inverted",
                                           "dots:5mm", "lines:5mm", "dot"));

TEST_P(BytesFor, AreNoBoardAndTakeNoLongerThanTheirPixels) {
  const auto finder = make_detector(parse_board(GetParam()).value()).value();
  std::mt19937 random(8);
  double worst = 0;
  for (const Shape& shape : shapes()) {
    for (const Kind kind : {Kind::kConstant, Kind::kNoise, Kind::kGradient, Kind::kSaturated,
                            Kind::kDots, Kind::kSquares}) {
      const Bytes bytes = make_bytes(shape, kind, random);
      const double begin = thread_ms();
      const Detection d = finder->detect(bytes.view);
      const double ms = thread_ms() - begin;
      EXPECT_FALSE(d.observation.found()) << shape.width << "x" << shape.height;
      EXPECT_FALSE(finder->follow(bytes.view, 1).observation.found());
      const double pixels = static_cast<double>(shape.width) * shape.height;
      worst = std::max(worst, 1e6 * ms / std::max(pixels, 3e5));
      // 1 us a pixel: a hundred times of what is usual, for a busy machine and a sanitizer, which
      // takes longest for the many places of dense grids in a small picture.
      EXPECT_LT(ms, 300 + 1e-3 * pixels) << shape.width << "x" << shape.height;
    }
  }
  std::cout << "  at most " << worst << " ns a pixel\n";
}

// RGB, BGR, RGBA, BGRA, ARGB, ABGR: (77 R + 150 G + 29 B) / 256, rounded, whatever is beside them.
TEST(Bytes, OfColoursAreTakenAsTheyAre) {
  struct Layout {
    int step, red, green, blue;
  };
  std::mt19937 random(9);
  for (const int width : {1, 7, 16, 33, 100}) {
    for (const Layout l : {Layout{3, 0, 1, 2},
                           {3, 2, 1, 0},
                           {4, 0, 1, 2},
                           {4, 2, 1, 0},
                           {4, 1, 2, 3},
                           {4, 3, 2, 1}}) {
      const int height = 3;
      const int stride = width * l.step + 5;
      const auto size = static_cast<std::size_t>((height - 1) * stride + width * l.step);
      const auto data = std::make_unique<std::uint8_t[]>(size);
      for (std::size_t i = 0; i < size; ++i) data[i] = static_cast<std::uint8_t>(random());
      GrayImage gray;
      take_luma({data.get(), width, height, stride, l.step, l.red, l.green, l.blue}, gray);
      ASSERT_EQ(gray.size(), (ImageSize{width, height}));
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          const std::uint8_t* p = data.get() + y * stride + x * l.step;
          const double luma = (77 * p[l.red] + 150 * p[l.green] + 29 * p[l.blue]) / 256.0;
          ASSERT_EQ(gray.row(y)[x], std::floor(luma + 0.5)) << x << "," << y;
        }
      }
    }
  }
}

TEST(Bytes, SideBySideWithOthersAreTakenAlone) {
  std::mt19937 random(10);
  for (const int width : {1, 15, 16, 17, 64, 129}) {
    for (const int step : {1, 2, 3, 4}) {
      const Bytes bytes = make_bytes({width, 4, 3, step}, Kind::kNoise, random);
      GrayImage gray;
      take_luma(bytes.view, gray);
      for (int y = 0; y < 4; ++y) {
        for (int x = 0; x < width; ++x) ASSERT_EQ(gray.row(y)[x], bytes.view.at(x, y));
      }
    }
  }
}

}  // namespace
}  // namespace calvin
