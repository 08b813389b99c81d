// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Scores by part and group of views, and the products of the groups with each other.

#include "calvin/solve/judge/agreement.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace calvin {

std::pair<double, double> Agreement::total(std::size_t part) const {
  const Sums& of = parts_[part];
  return {std::accumulate(of.score.begin(), of.score.end(), 0.0),
          std::accumulate(of.information.begin(), of.information.end(), 0.0)};
}

double Agreement::deviations() const {
  std::array<std::array<double, kGroups>, kGroups> common{};
  for (const Sums& part : parts_) {
    const double all = std::accumulate(part.information.begin(), part.information.end(), 0.0);
    if (!(all > 0)) continue;
    for (std::size_t a = 1; a < kGroups; ++a) {
      const double scaled = part.score[a] / all;
      for (std::size_t b = 0; b < a; ++b) common[a][b] += scaled * part.score[b];
    }
  }
  double sum = 0;
  double squares = 0;
  for (std::size_t a = 1; a < kGroups; ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      sum += common[a][b];
      squares += common[a][b] * common[a][b];
    }
  }
  return squares > 0 ? sum / std::sqrt(squares) : 0;
}

double Agreement::variance() const {
  double shared = 0;
  double weight = 0;
  for (const Sums& part : parts_) {
    double score = 0;
    double information = 0;
    double own_scores = 0;
    double own_information = 0;
    for (std::size_t g = 0; g < kGroups; ++g) {
      score += part.score[g];
      information += part.information[g];
      own_scores += part.score[g] * part.score[g];
      own_information += part.information[g] * part.information[g];
    }
    if (!(information > 0)) continue;
    shared += (score * score - own_scores) / information;
    weight += (information * information - own_information) / information;
  }
  return weight > 0 ? std::max(0.0, shared / weight) : 0;
}

}  // namespace calvin
