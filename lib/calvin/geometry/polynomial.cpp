// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Finds the smallest positive root by bisection between the sign changes of the derivatives, from
// the lowest degree up.

#include "calvin/geometry/polynomial.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace calvin {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double value(std::span<const double> c, double s) {
  double sum = 0;
  for (std::size_t i = c.size(); i-- > 0;) sum = sum * s + c[i];
  return sum;
}

// The root between two places of different sign, to the last bit.
double bisect(std::span<const double> c, double low, double high) {
  const bool rising = value(c, low) < 0;
  for (;;) {
    const double middle = low + (high - low) / 2;
    if (!(middle > low && middle < high)) return high;
    ((value(c, middle) < 0) == rising ? low : high) = middle;
  }
}

// Where the sign changes in (0, end], in order: between two roots of the derivative there is at
// most one such place.
std::vector<double> sign_changes(std::span<const double> c, double end) {
  if (c.size() < 2) return {};
  std::vector<double> slope;
  for (std::size_t i = 1; i < c.size(); ++i) slope.push_back(static_cast<double>(i) * c[i]);
  std::vector<double> places = sign_changes(slope, end);
  places.push_back(end);
  std::vector<double> roots;
  double from = 0;
  for (const double to : places) {
    if ((value(c, from) < 0) != (value(c, to) < 0)) roots.push_back(bisect(c, from, to));
    from = to;
  }
  return roots;
}

}  // namespace

double smallest_positive_root(std::span<const double> coefficients) {
  // In t = 1 / s: a tiny leading coefficient then gives a tiny t instead of an overflow.
  std::vector<double> reversed(coefficients.rbegin(), coefficients.rend());
  const auto counts = [](double c) { return !(std::abs(c) < 1e-300); };
  reversed.erase(reversed.begin(), std::find_if(reversed.begin(), reversed.end(), counts));
  if (reversed.size() < 2 || !counts(reversed.back())) return kInfinity;
  double largest = 0;
  for (const double c : reversed) largest = std::max(largest, std::abs(c / reversed.back()));
  const double end = 1 + largest;  // Cauchy's bound
  if (!std::isfinite(end)) return kInfinity;
  const auto roots = sign_changes(reversed, end);
  return roots.empty() ? kInfinity : 1 / roots.back();
}

}  // namespace calvin
