// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The middle of several measurements, and from which to which they go.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace bench {

struct Spread {
  double median = NAN;
  double least = NAN;
  double most = NAN;
};

// Of those that are numbers.
inline Spread spread_of(std::vector<double> values) {
  std::erase_if(values, [](double v) { return std::isnan(v); });
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  const double upper = values[half];
  return {values.size() % 2 == 1 ? upper : (values[half - 1] + upper) / 2, values.front(),
          values.back()};
}

// Each over the one of the same number.
inline std::vector<double> ratios(const std::vector<double>& values,
                                  const std::vector<double>& over) {
  std::vector<double> result;
  for (std::size_t i = 0; i < std::min(values.size(), over.size()); ++i) {
    result.push_back(values[i] / over[i]);
  }
  return result;
}

}  // namespace bench
