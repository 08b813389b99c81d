// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A lens that zooms from view to view: from Sturm and Maybank's closed form the least squares end
// where those of another solver end that begins at the truth.
#include <algorithm>
#include <cmath>
#include <iostream>

#include <gtest/gtest.h>

#include "calvin/rig/zoom/solve_zooming.hpp"
#include "ceres_zooming.hpp"

namespace calvin {
namespace {

using scenes::Random;

// The largest difference of a focal length or of the principal point, in sigmas.
double difference(const std::vector<Calibration>& found, const formulas::CeresZooming& peer) {
  double most = 0;
  const auto compare = [&](const Parameter& one, double other) {
    most = std::max(most, std::abs(one.value - other) / one.sigma.value());
  };
  for (std::size_t v = 0; v < found.size(); ++v) compare(*found[v].find("fx"), peer.f_k1[v][0]);
  compare(*found[0].find("cx"), peer.center[0]);
  compare(*found[0].find("cy"), peer.center[1]);
  return most;
}

TEST(SolveZooming, LeadsWhereTheTruthLeads) {
  const int trials = scenes::full_count() ? 2000 : 20;
  int refused = 0;
  int elsewhere = 0;
  double most = 0;
  for (int trial = 0; trial < trials; ++trial) {
    Random random(500 + static_cast<std::uint64_t>(trial));
    const auto lens = scenes::random_zooming_lens(random, 12, 0.05);
    const auto scene = scenes::zooming_scene(lens, 10, 0.1, random);
    ZoomingOptions options;
    options.square = true;
    const auto found = solve_zooming(scene.views, scenes::kSize, options);
    if (!found) {
      ++refused;
      continue;
    }
    const double apart = difference(*found, formulas::solve_zooming_by_ceres(scene));
    if (apart > 0.03) ++elsewhere;
    most = std::max(most, apart);
  }
  std::cout << "of " << trials << " lenses " << refused << " refused, " << elsewhere
            << " at another optimum than from the truth; the farthest " << most << " sigma\n";
  EXPECT_LE(refused + elsewhere, trials / 100);
}

}  // namespace
}  // namespace calvin
