// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Velocities of corners whose motion is known: parabolas in time, of frames that are unevenly
// apart.
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/session/views/corner_motion.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

constexpr int kCols = 7;
constexpr int kRows = 5;

// px/s and px/s² in the newest frame, at a place in px: polynomials of it, as a board's are.
struct Motion {
  Pixel velocity;
  Pixel acceleration;
};

Motion motion_at(Pixel p) {
  const double x = (p.u - 500) / 300;
  const double y = (p.v - 400) / 200;
  return {{120 - 30 * x + 14 * y + 5 * x * y, -40 + 22 * x + 9 * y * y},
          {600 + 90 * x - 120 * y, -300 + 150 * y}};
}

// The corners `ago` seconds before the newest frame.
Observation seen(double ago) {
  Observation o;
  o.board = "checkerboard:7x5:30mm";
  o.image_size = scenes::kSize;
  o.timestamp = static_cast<std::uint64_t>(std::llround(1e9 * (10 - ago)));
  for (int id = 0; id < kCols * kRows; ++id) {
    const Pixel at = {300.0 + 60 * (id % kCols), 250.0 + 60 * (id / kCols)};
    const Motion m = motion_at(at);
    o.ids.push_back(id);
    o.uv.push_back({at.u - ago * m.velocity.u + ago * ago / 2 * m.acceleration.u,
                    at.v - ago * m.velocity.v + ago * ago / 2 * m.acceleration.v});
  }
  return o;
}

// Those of the newest frame itself, not of the time between it and the one before.
TEST(CornerVelocities, AreThoseInTheNewestFrame) {
  for (const auto& [before, earlier] :
       {std::pair(0.03, 0.06), std::pair(0.03, 0.13), std::pair(0.1, 0.13)}) {
    const Observation now = seen(0);
    const auto found = corner_velocities(seen(earlier), seen(before), now);
    ASSERT_TRUE(found) << before << " " << earlier;
    ASSERT_EQ(found->of.size(), now.uv.size());
    for (std::size_t i = 0; i < now.uv.size(); ++i) {
      const Pixel true_velocity = motion_at(now.uv[i]).velocity;
      EXPECT_NEAR(found->of[i].u, true_velocity.u, 1e-5) << i;
      EXPECT_NEAR(found->of[i].v, true_velocity.v, 1e-5) << i;
    }
    EXPECT_LT(found->sigma, 1e-5);
  }
}

// Without two frames before it, in their order, a motion is not known.
TEST(CornerVelocities, NeedFramesInTheirOrder) {
  EXPECT_FALSE(corner_velocities(seen(0.03), seen(0.06), seen(0)));
  EXPECT_FALSE(corner_velocities(seen(0.06), seen(0), seen(0)));
  EXPECT_TRUE(corner_velocities(seen(0.06), seen(0.03), seen(0)));
  Observation untimed = seen(0.06);
  untimed.timestamp = kNoTimestamp;
  EXPECT_FALSE(corner_velocities(untimed, seen(0.03), seen(0)));
}

}  // namespace
}  // namespace calvin
