// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The quantiles of the normal distribution as a table, which makes Gaussian noise of 16 random
// bits.

#include "calvin/synth/random.hpp"

#include <cmath>
#include <numbers>

namespace calvin::synth {

namespace {

// The x with P(X < x) = p, by Newton's method on the distribution function from the lower tail.
double normal_quantile(double p) {
  double x = 0;
  for (int i = 0; i < 100; ++i) {
    const double cdf = 0.5 * std::erfc(-x / std::numbers::sqrt2);
    const double pdf = std::exp(-0.5 * x * x) / std::sqrt(2 * std::numbers::pi);
    const double step = (cdf - p) / pdf;
    x -= std::fmin(std::fmax(step, -0.5), 0.5);
    if (std::fabs(step) < 1e-12) break;
  }
  return x;
}

std::vector<float> make_table() {
  constexpr int kCount = 65536;
  std::vector<float> table(kCount);
  double x_squared = 0;
  for (std::size_t i = 0; i < kCount / 2; ++i) {
    const double x = normal_quantile((static_cast<double>(i) + 0.5) / kCount);
    x_squared += 2 * x * x;
    table[i] = static_cast<float>(x);
    table[kCount - 1 - i] = static_cast<float>(-x);
  }
  // The middle of the outermost steps is not their mean square: make the variance exact.
  const auto scale = static_cast<float>(1 / std::sqrt(x_squared / kCount));
  for (float& x : table) x *= scale;
  return table;
}

}  // namespace

const std::vector<float>& normal_quantiles() {
  // Never freed: while a program ends, its other threads may still be at work.
  static const auto& kTable = *new std::vector<float>(make_table());
  return kTable;
}

}  // namespace calvin::synth
