// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Picks instants, and directions of least support.

#include "calvin/rig/light/tracks.hpp"

#include <algorithm>
#include <functional>
#include <iterator>
#include <numeric>
#include <set>

#include "calvin/geometry/symmetric.hpp"

namespace calvin::rig {

namespace {

std::size_t seen_by(const std::vector<LightCamera>& cameras, std::size_t instant) {
  return static_cast<std::size_t>(std::ranges::count_if(
      cameras, [&](const LightCamera& c) { return c.seen[instant].has_value(); }));
}

// Some of a list, evenly.
std::vector<std::size_t> some_of(const std::vector<std::size_t>& all, std::size_t most) {
  std::vector<std::size_t> some;
  const std::size_t count = std::min(all.size(), most);
  for (std::size_t k = 0; k < count; ++k) some.push_back(all[k * all.size() / count]);
  return some;
}

}  // namespace

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

std::vector<std::size_t> instants_to_begin_with(const std::vector<LightCamera>& cameras) {
  constexpr std::size_t kAll = 300;
  constexpr std::size_t kOfEach = 60;
  std::vector<std::size_t> all(cameras.front().seen.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  std::erase_if(all, [&](std::size_t i) { return seen_by(cameras, i) < 2; });
  std::ranges::stable_sort(all, std::greater(), [&](std::size_t i) { return seen_by(cameras, i); });
  std::vector<std::size_t> best(
      all.begin(), all.begin() + static_cast<std::ptrdiff_t>(std::min(all.size(), 2 * kAll)));
  std::ranges::sort(best);
  const std::vector<std::size_t> chosen = some_of(best, kAll);
  std::set<std::size_t> instants(chosen.begin(), chosen.end());
  for (const LightCamera& camera : cameras) {
    std::vector<std::size_t> own;
    std::ranges::copy_if(all, std::back_inserter(own),
                         [&](std::size_t i) { return camera.seen[i].has_value(); });
    own.resize(std::min(own.size(), 2 * kOfEach));
    for (const std::size_t i : some_of(own, kOfEach)) instants.insert(i);
  }
  return {instants.begin(), instants.end()};
}

}  // namespace calvin::rig
