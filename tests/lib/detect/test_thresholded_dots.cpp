// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Dots by a threshold: where discorpy places them, and what it takes for none.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/detect/grids/thresholded_dots.hpp"

namespace calvin::detect {
namespace {

constexpr int kWidth = 400;
constexpr int kHeight = 300;

struct Ellipse {
  double u = 0;
  double v = 0;
  double half_width = 6;
  double half_height = 6;
};

GrayImage picture(const std::vector<Ellipse>& dots, bool dark) {
  GrayImage image(kWidth, kHeight, dark ? 200 : 40);
  for (const Ellipse& dot : dots) {
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const double r = std::hypot((x - dot.u) / dot.half_width, (y - dot.v) / dot.half_height);
        if (r <= 1) image.row(y)[x] = dark ? 40 : 200;
      }
    }
  }
  return image;
}

std::vector<Ellipse> grid() {
  std::vector<Ellipse> dots;
  for (int j = 0; j < 9; ++j) {
    for (int i = 0; i < 12; ++i) dots.push_back({30.0 + 30 * i, 30.0 + 30 * j});
  }
  return dots;
}

// Half a pixel to the right and down, by its median of 2 x 2 px.
TEST(ThresholdedDots, AreWhereDiscorpyPlacesThem) {
  for (const bool dark : {true, false}) {
    const auto seen = grid();
    const auto found = thresholded_dots(picture(seen, dark).view());
    ASSERT_EQ(found.size(), seen.size());
    for (const ThresholdedDot& dot : found) {
      const auto near = std::ranges::count_if(seen, [&dot](const Ellipse& e) {
        return std::abs(dot.center.u - e.u - 0.5) < 1e-9 &&
               std::abs(dot.center.v - e.v - 0.5) < 1e-9;
      });
      EXPECT_EQ(near, 1) << dot.center.u << " " << dot.center.v;
    }
  }
}

// With soft edges, of which a median of four and the threshold decide: by a count of pixels.
TEST(ThresholdedDots, AreBrighterOrDarkerThanOtsusThreshold) {
  GrayImage image(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double u = std::remainder(x - 30.3, 30);
      const double v = std::remainder(y - 30.6, 30);
      image.row(y)[x] =
          static_cast<std::uint8_t>(std::clamp(220 - 45 * (8 - std::hypot(u, v)), 40.0, 220.0));
    }
  }
  const GrayImage& seen = image;
  const auto median = [&seen](int x, int y) {
    std::array<int, 4> four = {seen.view().at(x - 1, y - 1), seen.view().at(x, y - 1),
                               seen.view().at(x - 1, y), seen.view().at(x, y)};
    std::ranges::sort(four);
    return four[2];
  };
  std::vector<int> middle;
  for (int y = 105; y < 195; ++y) {
    for (int x = 140; x < 260; ++x) middle.push_back(median(x, y));
  }
  int threshold = 0;
  double most = 0;
  for (int t = 0; t < 255; ++t) {
    double below = 0;
    double sum_below = 0;
    double sum = 0;
    for (const int grey : middle) {
      sum += grey;
      if (grey <= t) sum_below += grey;
      if (grey <= t) ++below;
    }
    const double above = static_cast<double>(middle.size()) - below;
    if (below == 0 || above == 0) continue;
    const double apart = sum_below / below - (sum - sum_below) / above;
    if (below * above * apart * apart <= most) continue;
    most = below * above * apart * apart;
    threshold = t;
  }
  const auto found = thresholded_dots(image.view());
  ASSERT_GT(found.size(), 100u);
  for (const ThresholdedDot& dot : found) {
    int area = 0;
    for (int dy = -14; dy <= 14; ++dy) {
      for (int dx = -14; dx <= 14; ++dx) {
        const int x = static_cast<int>(std::lround(dot.center.u)) + dx;
        const int y = static_cast<int>(std::lround(dot.center.v)) + dy;
        if (x > 0 && y > 0 && x < kWidth && y < kHeight && median(x, y) <= threshold) ++area;
      }
    }
    // What stands out by one pixel goes, as at the ends of the axes.
    EXPECT_LE(dot.area, area) << "at " << dot.center.u << " " << dot.center.v;
    EXPECT_GE(dot.area, area - 6) << "at " << dot.center.u << " " << dot.center.v;
  }
}

// A larger one, a smaller one, a long one and what touches the border are none; a hole is no hole.
TEST(ThresholdedDots, AreOfOneSizeAndRound) {
  auto dots = grid();
  dots[0].half_width = dots[0].half_height = 8;
  dots[1].half_width = dots[1].half_height = 4;
  dots[2].half_width = 8;
  dots[2].half_height = 5;
  dots.push_back({150, 4});  // nine tenths of one
  GrayImage image = picture(dots, true);
  const Ellipse& ring = dots[3];
  image.row(static_cast<int>(ring.v))[static_cast<int>(ring.u)] = 200;
  image.row(static_cast<int>(ring.v))[static_cast<int>(ring.u) + 1] = 200;
  image.row(static_cast<int>(ring.v) + 1)[static_cast<int>(ring.u)] = 200;
  image.row(static_cast<int>(ring.v) + 1)[static_cast<int>(ring.u) + 1] = 200;
  image.row(50)[50] = 40;  // a speck
  const auto found = thresholded_dots(image.view());
  EXPECT_EQ(found.size(), grid().size() - 3);
  for (const ThresholdedDot& dot : found) {
    for (const int none : {0, 1, 2}) {
      const auto& e = dots[static_cast<std::size_t>(none)];
      EXPECT_GT(std::hypot(dot.center.u - e.u, dot.center.v - e.v), 5);
    }
  }
  const auto filled = std::ranges::find_if(found, [&ring](const ThresholdedDot& dot) {
    return std::hypot(dot.center.u - ring.u, dot.center.v - ring.v) < 2;
  });
  ASSERT_NE(filled, found.end());
  EXPECT_EQ(filled->area, found.back().area);
}

TEST(ThresholdedDots, TakeTheirPointsAlong) {
  const auto dots = grid();
  Observation seen;
  for (std::size_t i = 0; i < dots.size(); ++i) {
    seen.ids.push_back(static_cast<int>(i));
    seen.uv.push_back({dots[i].u + 1, dots[i].v - 2});
    seen.sigma.push_back(0.1);
  }
  seen.ids.push_back(999);
  seen.uv.push_back({45, 45});
  seen.sigma.push_back(0.1);
  const Observation moved = at_thresholded_dots(picture(dots, true).view(), seen);
  ASSERT_EQ(moved.ids.size(), dots.size());
  EXPECT_TRUE(moved.sigma.empty());
  for (std::size_t i = 0; i < dots.size(); ++i) {
    EXPECT_EQ(moved.ids[i], static_cast<int>(i));
    EXPECT_NEAR(moved.uv[i].u, dots[i].u + 0.5, 1e-9);
    EXPECT_NEAR(moved.uv[i].v, dots[i].v + 0.5, 1e-9);
  }
}

TEST(ThresholdedDots, OfNothingAreNone) {
  EXPECT_TRUE(thresholded_dots(GrayImage(kWidth, kHeight, 77).view()).empty());
  EXPECT_TRUE(thresholded_dots(GrayImage(2, 2, 0).view()).empty());
  EXPECT_TRUE(thresholded_dots({}).empty());
}

}  // namespace
}  // namespace calvin::detect
