// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Rigs of which it is known where every camera stands: they are found, and what is said of the
// errors is so.
#include <algorithm>
#include <functional>
#include <iostream>
#include <string>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "calvin/rig/solve_rig.hpp"
#include "simulated_rig.hpp"

namespace calvin {
namespace {

using scenes::place_error;
using scenes::Random;
using scenes::SimulatedRig;

struct Kind {
  const char* name;
  std::function<SimulatedRig(Random&)> make;
  int instants;
  int trials;  // reduced
  int full_trials;
};
const Kind kKinds[] = {
    {"Stereo", [](Random& r) { return scenes::stereo_rig(r); }, 15, 120, 900},
    {"RingOfFour", [](Random& r) { return scenes::ring_rig(4, r); }, 40, 50, 500},
    {"RingOfEight", [](Random& r) { return scenes::ring_rig(8, r); }, 60, 20, 200},
    {"Chain", [](Random& r) { return scenes::chain_rig(4, r); }, 60, 50, 400},
};

class Rigs : public ::testing::TestWithParam<Kind> {};
INSTANTIATE_TEST_SUITE_P(Rig, Rigs, ::testing::ValuesIn(kKinds),
                         [](const auto& test) { return std::string(test.param.name); });

TEST_P(Rigs, AreAsWellKnownAsTheySay) {
  const Kind& kind = GetParam();
  const int trials = scenes::full_count() ? kind.full_trials : kind.trials;
  double squares = 0;
  int cameras = 0;
  int beyond = 0;  // components
  for (int trial = 0; trial < trials; ++trial) {
    Random random(1000 + static_cast<std::uint64_t>(trial));
    const SimulatedRig rig = kind.make(random);
    const auto seen = scenes::seen_by(rig, kind.instants, 0.7, random);
    const auto solved = solve_rig(seen);
    ASSERT_TRUE(solved.has_value()) << trial << ": " << solved.error().message;
    EXPECT_TRUE(solved->rejected.empty()) << trial;
    for (std::size_t c = 1; c < rig.cameras.size(); ++c) {
      const SE3 truth = rig.world_from_camera[0].inverse() * rig.world_from_camera[c];
      const auto error = place_error(solved->rig.cameras[c], truth);
      squares += error.square;
      beyond += error.largest > 4 ? 1 : 0;
      ++cameras;
    }
  }
  std::cout << GetParam().name << ": mean of e^T C^-1 e / 6 = " << squares / cameras << ", "
            << beyond << " of " << 6 * cameras << " components beyond 4 sigma\n";
  const double margin = scenes::full_count() ? 0.1 : 0.15;
  EXPECT_NEAR(squares / cameras, 1, margin);
  EXPECT_LE(beyond, 1);
}

}  // namespace
}  // namespace calvin
