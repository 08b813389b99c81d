// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Sharp pictures, in which pixels blur more than optics do and edges run along rows of pixels: how
// far corners are off, what they say of it, and that a shift of one of them is seen in full.
#include <cmath>
#include <iostream>
#include <numbers>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/detect/detector.hpp"
#include "exact_board.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

using scenes::ExactBoard;
using scenes::kBoard;
using scenes::uniform;

// The corners of an observation of the whole board, beside where they are. A board that was found
// turned by half a turn is turned back; `add(seen, true, sigma)`.
template <typename F>
bool compare(const Observation& seen, const ExactBoard& board, F add) {
  const std::size_t count = static_cast<std::size_t>(board.cols * board.rows);
  if (seen.ids.size() != count) return false;
  const Pixel first = board.corner(0);
  const bool turned = std::hypot(seen.uv[0].u - first.u, seen.uv[0].v - first.v) > board.square;
  for (std::size_t i = 0; i < count; ++i) {
    add(seen.uv[i], turned ? count - 1 - i : i, seen.sigma[i]);
  }
  return true;
}

// The angle to the rows of pixels in degrees, the blur in px.
class SharpBoards : public ::testing::TestWithParam<std::pair<double, double>> {};
INSTANTIATE_TEST_SUITE_P(Cells, SharpBoards, ::testing::ValuesIn([] {
                           std::vector<std::pair<double, double>> cells;
                           const bool full = scenes::full_count();
                           const std::vector<double> angles =
                               full ? std::vector<double>{0, 0.1, 0.5, 1, 2, 3, 5, 7, 10}
                                    : std::vector<double>{0, 1, 6};
                           const std::vector<double> blurs =
                               full ? std::vector<double>{0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.7, 1}
                                    : std::vector<double>{0.05, 0.3, 0.7};
                           for (const double angle : angles) {
                             for (const double blur : blurs) cells.emplace_back(angle, blur);
                           }
                           return cells;
                         }()));

TEST_P(SharpBoards, AreAsFarOffAsTheySay) {
  const auto& [degrees, blur] = GetParam();
  const auto detector = std::move(*make_detector(kBoard));
  scenes::Random random(5);
  double square = 0;
  double predicted = 0;
  int corners = 0;
  const int boards = scenes::full_count() ? 12 : 4;
  for (int n = 0; n < boards; ++n) {
    ExactBoard board;
    board.square = uniform(random, 20, 28);
    board.angle = degrees * std::numbers::pi / (n % 2 == 0 ? 180 : -180);
    board.middle = {uniform(random, 159, 161), uniform(random, 119, 121)};
    board.blur = blur;
    board.noise = 1;
    const GrayImage image = board.picture({320, 240}, random);
    const bool whole = compare(
        detector->detect(image.view()).observation, board, [&](Pixel seen, auto id, double sigma) {
          const Pixel at = board.corner(id);
          square += (std::pow(seen.u - at.u, 2) + std::pow(seen.v - at.v, 2)) / 2;
          predicted += sigma * sigma;
          ++corners;
        });
    EXPECT_TRUE(whole) << n;
  }
  const double ratio = std::sqrt(predicted / square);
  std::cout << "  " << degrees << " degrees, blur " << blur << ": RMS "
            << std::sqrt(square / corners) << " px, predicted over that " << ratio << '\n';
  // A fit that takes pixels for points is .02 to .08 px off in the sharpest cells.
  EXPECT_LT(std::sqrt(square / corners), 0.0035);
  EXPECT_GT(ratio, 0.8);
  EXPECT_LT(ratio, 1.25);
}

// The part of a shift of single corners that is seen: all of it, where nothing is smoothed over
// neighbours.
TEST(ShiftsOfCorners, AreSeenInFull) {
  const auto detector = std::move(*make_detector(kBoard));
  scenes::Random random(6);
  std::normal_distribution<double> normal(0, 0.05);  // px
  for (const double blur : {0.1, 0.7}) {
    double along = 0;
    double all = 0;
    for (int n = 0; n < 3; ++n) {
      ExactBoard board;
      board.square = 45;
      board.angle = uniform(random, -0.3, 0.3);
      board.middle = {240.3, 179.8};
      board.blur = blur;
      board.noise = 1;
      for (int i = 0; i < 54; ++i) board.shifts.push_back({normal(random), normal(random)});
      ExactBoard unshifted = board;
      unshifted.shifts.clear();
      const GrayImage image = board.picture({480, 360}, random);
      const bool whole = compare(
          detector->detect(image.view()).observation, board, [&](Pixel seen, auto id, double) {
            const Pixel& shift = board.shifts[id];
            const Pixel from = unshifted.corner(id);
            along += shift.u * (seen.u - from.u) + shift.v * (seen.v - from.v);
            all += shift.u * shift.u + shift.v * shift.v;
          });
      ASSERT_TRUE(whole) << n;
    }
    std::cout << "  blur " << blur << ": gain " << along / all << '\n';
    EXPECT_NEAR(along / all, 1, 0.01) << blur;
  }
}

}  // namespace
}  // namespace calvin
