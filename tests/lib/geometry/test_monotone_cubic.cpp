// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// monotone_cubic_weights() against parabolas, which it has to reproduce, and random rows of values,
// which it must not overshoot.
#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/geometry/monotone_cubic.hpp"

namespace calvin {
namespace {

double at(const std::vector<double>& nodes, const std::vector<double>& guides,
          const std::vector<double>& values, double x) {
  const auto weights = monotone_cubic_weights(nodes, guides, x);
  EXPECT_EQ(weights.size(), nodes.size());
  EXPECT_NEAR(std::accumulate(weights.begin(), weights.end(), 0.0), 1, 1e-12);
  return std::inner_product(weights.begin(), weights.end(), values.begin(), 0.0);
}

// Ascending, 0.2 to 2 apart.
std::vector<double> random_steps(std::size_t count, std::mt19937& random) {
  std::uniform_real_distribution<double> step(0.2, 2);
  std::vector<double> all = {-3};
  while (all.size() < count) all.push_back(all.back() + step(random));
  return all;
}

TEST(MonotoneCubic, ReproducesAParabolaThatGrows) {
  std::mt19937 random(1);
  const auto parabola = [](double x) { return 30 + 9 * x + 0.4 * x * x; };
  for (const std::size_t count : {3, 4, 9}) {
    const auto nodes = random_steps(count, random);
    std::vector<double> values;
    for (const double x : nodes) values.push_back(parabola(x));
    for (double t = 0; t <= 1; t += 0.01) {
      const double x = nodes.front() + t * (nodes.back() - nodes.front());
      EXPECT_NEAR(at(nodes, values, values, x), parabola(x), 1e-9) << count << " nodes, " << x;
    }
  }
}

TEST(MonotoneCubic, GivesTheValuesAtTheNodesAndBeyondTheEnds) {
  std::mt19937 random(2);
  const auto nodes = random_steps(6, random);
  const std::vector<double> values = {1, 1.5, 1.5, 8, 8.1, 20};
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    EXPECT_NEAR(at(nodes, values, values, nodes[i]), values[i], 1e-12);
  }
  EXPECT_EQ(at(nodes, values, values, nodes.front() - 5), values.front());
  EXPECT_EQ(at(nodes, values, values, nodes.back() + 5), values.back());
  EXPECT_EQ(at({4}, {7}, {7}, 1), 7);
  EXPECT_NEAR(at({1, 3}, {7, 9}, {7, 9}, 1.5), 7.5, 1e-12);
}

// Steps and level parts, as of a motor that stands at its ends.
TEST(MonotoneCubic, TurnsBackNowhereWhereTheGuidesDoNot) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(0, 1);
  for (int n = 0; n < 200; ++n) {
    const auto nodes = random_steps(7, random);
    std::vector<double> values = {0};
    while (values.size() < nodes.size()) {
      const double draw = any(random);
      values.push_back(values.back() + (draw < 0.3 ? 0 : (draw < 0.5 ? 50 * draw : draw)));
    }
    double before = values.front();
    for (int k = 0; k <= 400; ++k) {
      const double x = nodes.front() + k / 400.0 * (nodes.back() - nodes.front());
      const double now = at(nodes, values, values, x);
      EXPECT_GE(now, before - 1e-9) << "row " << n << " at " << x;
      before = now;
    }
    // Falling, it is the same upside down.
    std::vector<double> falling;
    for (const double v : values) falling.push_back(-v);
    const double middle = (nodes.front() + nodes.back()) / 2;
    EXPECT_NEAR(at(nodes, falling, falling, middle), -at(nodes, values, values, middle), 1e-9);
  }
}

// What makes up for each other at the nodes does so between them, whatever the guides.
TEST(MonotoneCubic, KeepsSumsOfQuantities) {
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  const auto nodes = random_steps(8, random);
  const auto guides = random_steps(8, random);
  std::vector<double> noise;
  std::vector<double> against;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    noise.push_back(normal(random));
    against.push_back(4 - 3 * noise.back());
  }
  for (double x = nodes.front(); x < nodes.back(); x += 0.05) {
    EXPECT_NEAR(3 * at(nodes, guides, noise, x) + at(nodes, guides, against, x), 4, 1e-9);
  }
}

}  // namespace
}  // namespace calvin
