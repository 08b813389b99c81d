// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Looks at the variances, at each two that belong together, and at the eigenvalues of the
// correlations.

#include "calvin/geometry/covariance.hpp"

#include <cmath>

#include <fmt/format.h>
#include <Eigen/Core>

#include "calvin/geometry/symmetric.hpp"

namespace calvin {

std::optional<std::string> no_covariance(std::span<const double> row_major, std::size_t size) {
  constexpr double kRounding = 1e-6;  // files are written with as many digits as their makers like
  constexpr double kLeast = -1e-3;    // of the eigenvalues, whose rounding adds up over the rows
  const auto at = [&](std::size_t r, std::size_t c) { return row_major[r * size + c]; };
  for (std::size_t r = 0; r < size; ++r) {
    if (!(at(r, r) >= 0)) return fmt::format("has a negative variance in row {}", r + 1);
  }
  const auto n = static_cast<Eigen::Index>(size);
  Eigen::MatrixXd correlations = Eigen::MatrixXd::Identity(n, n);
  for (std::size_t r = 0; r < size; ++r) {
    for (std::size_t c = 0; c < r; ++c) {
      const double sigmas = std::sqrt(at(r, r)) * std::sqrt(at(c, c));
      const double most = (1 + kRounding) * sigmas;
      const bool same = std::abs(at(r, c) - at(c, r)) <= kRounding * most;
      if (!same || !(std::abs(at(r, c)) <= most)) {
        return fmt::format("is no covariance: {} in row {}, column {}", at(r, c), r + 1, c + 1);
      }
      correlations(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c)) =
          sigmas > 0 ? at(r, c) / sigmas : 0;
    }
  }
  if (size == 0) return std::nullopt;
  const auto eigen = symmetric_eigen(correlations);
  if (eigen && eigen->values[0] >= kLeast) return std::nullopt;
  return "is no covariance: along some direction its variance is negative";
}

}  // namespace calvin
