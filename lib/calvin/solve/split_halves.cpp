// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The same halves are solved whatever the model is, so that models can be compared by them.

#include "calvin/solve/split_halves.hpp"

#include <cmath>
#include <numeric>
#include <random>
#include <utility>

#include "calvin/solve/difference.hpp"

namespace calvin {

namespace {

constexpr std::size_t kFewest = 8;   // views
constexpr std::size_t kSplits = 12;  // of which models are told apart that differ by a fifth

// The same order on every machine, which std::shuffle is not.
void shuffle(std::vector<PointSet>& views, std::mt19937& random) {
  for (std::size_t i = views.size(); i > 1; --i) {
    std::swap(views[i - 1], views[static_cast<std::size_t>(random()) % i]);
  }
}

std::optional<double> largest_difference(const Calibration& a, const Calibration& b) {
  const auto first = Camera::make(a);
  const auto second = Camera::make(b);
  if (!first || !second) return std::nullopt;
  DifferenceOptions coarse;  // differences are smooth
  coarse.columns = 17;
  coarse.rows = 13;
  coarse.focus = {a.covered, b.covered};
  const auto apart = difference(*first, *second, coarse);
  if (!apart) return std::nullopt;
  return apart->focus.max;
}

}  // namespace

std::vector<PointSet> some_of(const std::vector<PointSet>& views) {
  constexpr std::size_t kMost = 50;
  const std::size_t every = (views.size() + kMost - 1) / kMost;
  std::vector<PointSet> some;
  for (std::size_t i = 0; i < views.size(); i += every) some.push_back(views[i]);
  return some;
}

std::optional<double> split_half_difference(const std::vector<PointSet>& views,
                                            const Calibration& all, const BoardShape& shape,
                                            const SolveOptions& options,
                                            const std::stop_token& stop) {
  if (views.size() < kFewest) return std::nullopt;
  SolveOptions bare = options;
  bare.checks = false;
  bare.reject_outliers = false;
  if (!options.initial_is_prior) bare.initial = all;  // halves are not far from it
  std::vector<PointSet> shuffled = some_of(views);
  const auto half = shuffled.begin() + static_cast<std::ptrdiff_t>(shuffled.size() / 2);
  std::mt19937 random(1);
  std::vector<double> logarithms;
  for (std::size_t i = 0; i < kSplits && !stop.stop_requested(); ++i) {
    shuffle(shuffled, random);
    const auto a = solve_points({shuffled.begin(), half}, shape, all.image_size, bare, stop);
    const auto b = solve_points({half, shuffled.end()}, shape, all.image_size, bare, stop);
    if (!a || !b) continue;
    if (const auto apart = largest_difference(a->calibration, b->calibration)) {
      logarithms.push_back(std::log(*apart));
    }
  }
  if (2 * logarithms.size() <= kSplits) return std::nullopt;
  return std::exp(std::accumulate(logarithms.begin(), logarithms.end(), 0.0) /
                  static_cast<double>(logarithms.size()));
}

}  // namespace calvin
