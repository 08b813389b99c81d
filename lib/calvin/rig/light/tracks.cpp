// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Picks instants, and directions of least support.

#include "calvin/rig/light/tracks.hpp"

#include <algorithm>

#include "calvin/geometry/symmetric.hpp"

namespace calvin::rig {

std::vector<std::size_t> Picker::pick(std::size_t wanted, std::size_t count) {
  std::vector<std::size_t> picked;
  while (picked.size() < wanted) {
    const auto next = static_cast<std::size_t>(random_() % count);
    if (std::ranges::find(picked, next) == picked.end()) picked.push_back(next);
  }
  return picked;
}

std::vector<std::size_t> common_instants(const Track& a, const Track& b) {
  std::vector<std::size_t> common;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] && b[i]) common.push_back(i);
  }
  return common;
}

Eigen::VectorXd least_direction(const Eigen::MatrixXd& symmetric) {
  const auto eigen = symmetric_eigen(symmetric);
  if (!eigen) return Eigen::VectorXd::Zero(symmetric.rows());
  return eigen->vectors.col(0);
}

}  // namespace calvin::rig
