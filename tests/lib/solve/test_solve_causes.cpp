// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What is wrong is named as what it is, where other lenses or boards would seem to help.
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "faulty_session.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

using scenes::Fault;
using scenes::Random;
using scenes::session;

// A print that is 1 % too long for its width is what is wrong, and not the hand that holds it.
TEST(Causes, AStretchedBoardIsNamed) {
  const Fault stretched = {
      [](const Eigen::Vector3d& p) { return Eigen::Vector3d(p.x(), 1.01 * p.y(), p.z()); }, {}};
  constexpr int kSessions = 10;
  for (const char* model : {"brown4", "auto"}) {
    int named = 0;
    for (int seed = 0; seed < kSessions; ++seed) {
      Random random(seed);
      const Camera camera = scenes::random_camera("brown4", random);
      SolveOptions options;
      options.model = model;
      const auto solution = solve(session(camera, stretched, random), camera.image_size(), options);
      ASSERT_TRUE(solution);
      EXPECT_EQ(solution->misfit.noticed, Misfit::Cause::kBoard) << model << seed;
      const auto& remarks = solution->calibration.remarks;
      ASSERT_FALSE(remarks.empty());
      double percent = 0;
      if (std::sscanf(remarks.front().c_str(), "The board is %lf %%", &percent) != 1) continue;
      EXPECT_NEAR(percent, 1, 0.1) << remarks.front();
      EXPECT_NE(remarks.front().find("along its columns"), std::string::npos);
      ++named;
    }
    EXPECT_GE(named, kSessions - 2) << model;
  }
}

// Of sessions in which one value is held that is wrong by `share`: how many name it, and how many
// are called a misfit of the model.
struct Held {
  int named = 0;
  int of_model = 0;
};
Held held(double share, std::vector<std::string> others, int sessions) {
  Held count;
  for (int seed = 0; seed < sessions; ++seed) {
    Random random(seed);
    const Camera camera = scenes::random_camera("brown4", random);
    SolveOptions options;
    options.model = "brown4";
    options.fix = others;
    options.fix.push_back(fmt::format("fx={:.1f}", share * camera.fx()));
    const auto solution = solve(session(camera, {}, random), camera.image_size(), options);
    if (!solution || solution->calibration.remarks.empty()) continue;
    const std::string& first = solution->calibration.remarks.front();
    EXPECT_EQ(first.find("stretched"), std::string::npos) << first;
    count.named += first.find("What is held (fix=") != std::string::npos ? 1 : 0;
    count.of_model += solution->misfit.cause == Misfit::Cause::kModel ? 1 : 0;
  }
  return count;
}

// Neither a richer model nor a better board helps where a wrong number is held.
TEST(Causes, AWrongValueThatIsHeldIsNamed) {
  constexpr int kSessions = 10;
  const Held far = held(1.03, {"k1"}, kSessions);
  EXPECT_EQ(far.named, kSessions);
  EXPECT_EQ(far.of_model, kSessions);
  // A board of another aspect would explain that nearly as well.
  EXPECT_GE(held(0.99, {}, kSessions).named, kSessions - 1);
}

}  // namespace
}  // namespace calvin
