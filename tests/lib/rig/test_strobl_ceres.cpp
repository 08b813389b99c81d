// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The joint solve of cameras, robot and board, and the same statistics with other unknowns by
// another solver: the same optimum, and the same covariance.
#include <cmath>
#include <iostream>

#include <gtest/gtest.h>

#include "ceres_strobl.hpp"
#include "simulated_strobl.hpp"

namespace calvin {
namespace {

class StroblByCeres : public ::testing::TestWithParam<std::size_t> {};
INSTANTIATE_TEST_SUITE_P(Cameras, StroblByCeres, ::testing::Values(1, 2),
                         [](const auto& test) { return test.param == 1 ? "One" : "Two"; });

// Beside the truth, where another optimum would show.
formulas::CeresStrobl beside_truth(const scenes::StroblScene& scene) {
  formulas::CeresStrobl at;
  const SE3& hand_from_first = scene.robot.mount_from_camera;
  for (std::size_t c = 0; c < scene.cameras.size(); ++c) {
    auto& camera = at.cameras.emplace_back();
    std::ranges::copy(scene.cameras[c].parameters(), camera.intrinsics.begin());
    camera.intrinsics[0] *= 1.01;
    camera.hand_from_camera =
        formulas::to_numbers(hand_from_first * scene.camera_from_first[c].inverse());
    camera.hand_from_camera[3] += 0.005;
  }
  at.base_from_board = formulas::to_numbers(scene.robot.carrier_from_board);
  at.sheet = {scene.robot.scale * 1.01, scene.aspect * 0.99};
  return at;
}

TEST_P(StroblByCeres, IsTheSame) {
  scenes::Random random(77);
  const scenes::StroblScene scene =
      scenes::random_strobl(EyeSetup::kInHand, GetParam(), random, "brown4");
  scenes::StroblRun run = scenes::random_strobl_run(scene, 14, random);
  ASSERT_TRUE(scenes::solve_cameras(run, false));
  const auto solved = solve_strobl(run.cameras, run.base_from_hand);
  ASSERT_TRUE(solved.has_value()) << solved.error().message;
  const HandEye& found = solved->hand_eye;
  formulas::CeresStrobl peer = beside_truth(scene);
  ASSERT_TRUE(formulas::solve_strobl_by_ceres(
      run.cameras, run.base_from_hand,
      {found.corner_factor, found.robot_turn_sigma, found.robot_place_sigma}, peer));
  constexpr double kApart = 0.02;  // sigmas: the noise is found to 1e-3 of itself
  constexpr double kRatio = 0.005;
  const auto expect = [&](double one, double sigma, double other, double other_sigma,
                          const std::string& name) {
    EXPECT_LT(std::abs(one - other), kApart * sigma) << name;
    EXPECT_NEAR(sigma / other_sigma, 1, kRatio) << name;
  };
  expect(found.scale->value, found.scale->sigma, peer.sheet[0], peer.sheet_sigma[0], "scale");
  expect(found.aspect->value, found.aspect->sigma, peer.sheet[1], peer.sheet_sigma[1], "aspect");
  for (std::size_t c = 0; c < peer.cameras.size(); ++c) {
    const auto& parameters = solved->calibrations[c].parameters;
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      expect(parameters[i].value, parameters[i].sigma.value(), peer.cameras[c].intrinsics[i],
             peer.intrinsics_sigma[c][i], solved->calibrations[c].camera + parameters[i].name);
    }
  }
  const SE3 mount = formulas::from_numbers(peer.cameras[0].hand_from_camera);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(found.mount_from_camera.translation[k],
                mount.translation[static_cast<Eigen::Index>(k)],
                kApart * std::sqrt(found.mount_covariance[7 * (3 + k)]));
  }
  std::cout << "scale " << found.scale->value << " +- " << found.scale->sigma << ", Ceres "
            << peer.sheet[0] << " +- " << peer.sheet_sigma[0] << "; aspect " << found.aspect->value
            << " +- " << found.aspect->sigma << ", Ceres " << peer.sheet[1] << " +- "
            << peer.sheet_sigma[1] << '\n';
  if (peer.cameras.size() == 1) return;
  const SE3 second = formulas::from_numbers(peer.cameras[1].hand_from_camera);
  const RigCamera& own = solved->rig->cameras[1];
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(own.rig_from_camera.translation[k],
                (mount.inverse() * second).translation[static_cast<Eigen::Index>(k)],
                kApart * std::sqrt(own.covariance[7 * (3 + k)]));
  }
}

}  // namespace
}  // namespace calvin
