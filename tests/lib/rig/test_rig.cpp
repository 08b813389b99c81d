// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Rigs of which it is known where every camera stands: they are found, and what is said of the
// errors is so.
#include <algorithm>
#include <cmath>
#include <functional>
#include <iostream>
#include <string>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "calvin/io/rig_io.hpp"
#include "calvin/rig/moved_camera.hpp"
#include "calvin/rig/result/rig_result.hpp"
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
    {"Chain", [](Random& r) { return scenes::chain_rig(4, r); }, 90, 50, 400},
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

// Each board that the rig keeps is where some camera has seen one: its corners are where they were
// found.
TEST(Rig, KeepsBoardsWhereTheyWereShown) {
  Random random(9);
  const SimulatedRig rig = scenes::ring_rig(4, random);
  const auto seen = scenes::seen_by(rig, 60, 0.7, random);
  const auto solved = solve_rig(seen);
  ASSERT_TRUE(solved.has_value());
  ASSERT_EQ(solved->rig.boards.size(), 24U);
  for (const RigBoard& shown : solved->rig.boards) {
    EXPECT_EQ(shown.board, rig.board.text());
    double least = 1e9;
    for (std::size_t c = 0; c < seen.size(); ++c) {
      const SE3 camera_from_board =
          to_se3(solved->rig.cameras[c].rig_from_camera).inverse() * to_se3(shown.rig_from_board);
      for (const View& view : seen[c].views) {
        double worst = 0;
        for (std::size_t i = 0; i < view.observation.ids.size(); ++i) {
          const auto id = rig.board.index_of(view.observation.ids[i]).value();
          const auto at = rig.cameras[c].project(camera_from_board * rig.board.points()[id]);
          const Pixel& found = view.observation.uv[i];
          worst = std::max(worst, at ? std::hypot(at->u - found.u, at->v - found.v) : 1e9);
        }
        least = std::min(least, worst);
      }
    }
    EXPECT_LT(least, 1);
  }
}

// Boards that look the same after a turn, which every camera names as it likes. Where two cameras
// share one place of the board alone the rig is refused.
TEST(Rig, IsNeverTurnedByASymmetricBoard) {
  const int trials = scenes::full_count() ? 300 : 30;
  int refused = 0;
  for (const char* text : {"checkerboard:8x6:25mm", "checkerboard:6x6:25mm", "circles:7x5:25mm"}) {
    for (int trial = 0; trial < trials; ++trial) {
      Random random(3000 + static_cast<std::uint64_t>(trial));
      SimulatedRig rig = trial % 2 == 0 ? scenes::stereo_rig(random) : scenes::ring_rig(4, random);
      rig.board = parse_board(text).value();
      const auto solved = solve_rig(scenes::seen_by(rig, 40, 0.7, random));
      if (!solved) {
        ++refused;
        continue;
      }
      for (std::size_t c = 1; c < rig.cameras.size(); ++c) {
        const SE3 truth = rig.world_from_camera[0].inverse() * rig.world_from_camera[c];
        EXPECT_LT(place_error(solved->rig.cameras[c], truth).largest, 6) << text << trial;
      }
    }
  }
  std::cout << refused << " of " << 3 * trials << " refused\n";
  EXPECT_LE(refused, 3 * trials / 20);
}

// At one place such a board says nothing of which way round the cameras see it.
TEST(Rig, IsRefusedWhereASymmetricBoardLeavesItOpen) {
  Random random(4);
  SimulatedRig rig = scenes::stereo_rig(random);
  rig.board = parse_board("checkerboard:8x6:25mm").value();
  std::vector<RigCameraViews> seen;
  do {
    seen = scenes::seen_by(rig, 1, 0.7, random);
  } while (seen[0].views.empty() || seen[1].views.empty());
  const auto solved = solve_rig(seen);
  ASSERT_FALSE(solved.has_value());
  EXPECT_EQ(solved.error().code, ErrorCode::kDegenerate);
  EXPECT_NE(solved.error().message.find("puzzle:14x9:20mm"), std::string::npos);
  // A board that tells its orientation is enough at one place.
  rig.board = scenes::kBoard;
  do {
    seen = scenes::seen_by(rig, 1, 0.7, random);
  } while (seen[0].views.empty() || seen[1].views.empty());
  EXPECT_TRUE(solve_rig(seen).has_value());
}

// A small board, far away and flat, has two tilts that fit alike: the wrong ones are not taken.
TEST(Rig, IsNotTiltedByAFlatBoard) {
  const int trials = scenes::full_count() ? 2000 : 200;
  int refused = 0;
  int wrong = 0;
  for (int trial = 0; trial < trials; ++trial) {
    Random random(5000 + static_cast<std::uint64_t>(trial));
    SimulatedRig rig = scenes::stereo_rig(random);
    rig.board = parse_board("checkerboard:5x4:15mm").value();
    rig.middle.z() = 1;
    const auto solved = solve_rig(scenes::seen_by(rig, 8, 0.17, random));
    if (!solved) {
      ++refused;
      continue;
    }
    const SE3 truth = rig.world_from_camera[0].inverse() * rig.world_from_camera[1];
    wrong += place_error(solved->rig.cameras[1], truth).largest > 6 ? 1 : 0;
  }
  std::cout << wrong << " of " << trials << " wrong, " << refused << " refused\n";
  EXPECT_LE(wrong, trials / 1000);
  EXPECT_LT(refused, trials / 4);
}

// How well the intrinsics are known is a part of how well the rig is.
TEST(Rig, KnowsThatIntrinsicsAreNotExact) {
  const int trials = scenes::full_count() ? 600 : 120;
  double squares = 0;
  for (int trial = 0; trial < trials; ++trial) {
    Random random(6000 + static_cast<std::uint64_t>(trial));
    const SimulatedRig rig = scenes::stereo_rig(random);
    auto seen = scenes::seen_by(rig, 15, 0.7, random);
    std::normal_distribution<double> noise(0, 1);
    for (RigCameraViews& camera : seen) {
      // Both focal lengths err together.
      const double focal = noise(random);
      const double sigmas[] = {1.5, 1.5, 2, 2};
      camera.calibration.covariance = std::vector<double>(16, 0.0);
      for (std::size_t i = 0; i < 4; ++i) {
        Parameter& p = camera.calibration.parameters[i];
        p.sigma = sigmas[i];
        p.value += sigmas[i] * (i < 2 ? focal : noise(random));
        camera.calibration.covariance[5 * i] = sigmas[i] * sigmas[i];
      }
      camera.calibration.covariance[1] = camera.calibration.covariance[4] = sigmas[0] * sigmas[1];
    }
    const auto solved = solve_rig(seen);
    ASSERT_TRUE(solved.has_value()) << solved.error().message;
    const SE3 truth = rig.world_from_camera[0].inverse() * rig.world_from_camera[1];
    squares += place_error(solved->rig.cameras[1], truth).square;
  }
  std::cout << "mean of e^T C^-1 e / 6 = " << squares / trials << '\n';
  EXPECT_NEAR(squares / trials, 1, 0.25);
}

// Two cameras number what each of them sees of such a grid, and not the same points alike.
TEST(Rig, IsRefusedWhereTheBoardNamesNoPoints) {
  Random random(8);
  const SimulatedRig rig = scenes::stereo_rig(random);
  auto seen = scenes::seen_by(rig, 10, 0.5, random);
  for (auto& camera : seen) {
    for (View& view : camera.views) view.board = parse_board("dots:25mm").value();
  }
  const auto solved = solve_rig(seen);
  ASSERT_FALSE(solved.has_value());
  EXPECT_EQ(solved.error().code, ErrorCode::kUnsupported);
  EXPECT_NE(solved.error().message.find("puzzle:14x9:20mm"), std::string::npos);
}

TEST(Rig, NamesTheCameraThatSharesNothing) {
  Random random(9);
  SimulatedRig rig = scenes::stereo_rig(random);
  auto seen = scenes::seen_by(rig, 20, 0.7, random);
  for (View& view : seen[1].views) view.observation.timestamp += 500'000'000;
  const auto solved = solve_rig(seen);
  ASSERT_FALSE(solved.has_value());
  EXPECT_EQ(solved.error().code, ErrorCode::kDegenerate);
  EXPECT_NE(solved.error().message.find("'cam1'"), std::string::npos);
}

// One picture of one camera shows another board place than the others: it is left out.
TEST(Rig, LeavesOutAViewThatContradictsTheOthers) {
  Random random(10);
  const SimulatedRig rig = scenes::stereo_rig(random);
  auto seen = scenes::seen_by(rig, 20, 0.7, random);
  const std::uint64_t at = seen[0].views[3].observation.timestamp;
  const auto same = std::ranges::find_if(seen[1].views, [&](const View& view) {
    return view.observation.timestamp - at <= 10'000'000;
  });
  ASSERT_NE(same, seen[1].views.end());
  for (Pixel& p : same->observation.uv) p.u += 8;
  const auto solved = solve_rig(seen);
  ASSERT_TRUE(solved.has_value()) << solved.error().message;
  EXPECT_FALSE(solved->rejected.empty());
  const SE3 truth = rig.world_from_camera[0].inverse() * rig.world_from_camera[1];
  EXPECT_LT(place_error(solved->rig.cameras[1], truth).largest, 4);
}

// A camera is pushed by 5 mm after half, or two thirds, of the time; any of them, the first one
// too.
TEST(Rig, TellsWhichCameraWasPushed) {
  const int trials = scenes::full_count() ? 200 : 20;
  int told = 0;
  int wrong = 0;
  for (int trial = 0; trial < trials; ++trial) {
    Random random(40 + static_cast<std::uint64_t>(trial));
    SimulatedRig rig = scenes::ring_rig(4, random);
    auto seen = scenes::seen_by(rig, 120, 0.7, random);
    EXPECT_EQ(moved_cameras(seen, {}), "") << trial;
    const auto pushed = static_cast<std::size_t>(trial % 4);
    rig.world_from_camera[pushed].translation += Eigen::Vector3d(0.003, -0.003, 0.003);
    const auto later = scenes::seen_by(rig, trial % 2 == 0 ? 120 : 60, 0.7, random);
    for (std::size_t c = 0; c < seen.size(); ++c) {
      for (View view : later[c].views) {
        view.observation.timestamp += 1'000'000'000'000;
        seen[c].views.push_back(std::move(view));
      }
    }
    const std::string words = moved_cameras(seen, {});
    // Beside it another one may be named: what was pushed within a half blurs that.
    const bool is_right = words.find("'cam" + std::to_string(pushed) + "'") != std::string::npos;
    told += is_right ? 1 : 0;
    wrong += !words.empty() && !is_right ? 1 : 0;
  }
  std::cout << told << " of " << trials << " told, " << wrong << " of another camera\n";
  EXPECT_GE(told, 0.9 * trials);
  EXPECT_LE(wrong, 0.05 * trials);
}

// Cameras that run alongside each other but never at one time, to the tolerance: that is said.
TEST(Rig, SaysHowFarApartPicturesAre) {
  Random random(13);
  const SimulatedRig rig = scenes::stereo_rig(random);
  auto seen = scenes::seen_by(rig, 40, 0.7, random);
  for (View& view : seen[1].views) view.observation.timestamp += 12'000'000;
  const auto apart = solve_rig(seen);
  ASSERT_FALSE(apart.has_value());
  EXPECT_NE(apart.error().message.find("ms or more"), std::string::npos) << apart.error().message;
  EXPECT_NE(apart.error().message.find("raise that (tolerance)"), std::string::npos);
  RigOptions options;
  options.tolerance = 20'000'000;
  EXPECT_TRUE(solve_rig(seen, options).has_value());
}

// A rig whose corners are far from where it has them is told of, one that is as good as its lenses
// is not.
TEST(Rig, SaysThatItsViewsDoNotFitTogether) {
  Rig rig;
  rig.cameras.resize(2);
  rig.cameras[0].calibration.rms = 0.1;
  rig.cameras[1].calibration.rms = 0.4;
  rig.rms = 1.5;
  EXPECT_FALSE(rig::contradiction_remark(rig).has_value());
  rig.rms = 3;  // a bad lens is not much better alone
  EXPECT_FALSE(rig::contradiction_remark(rig).has_value());
  rig.rms = 19;
  const auto remark = rig::contradiction_remark(rig);
  ASSERT_TRUE(remark.has_value());
  EXPECT_NE(remark->find("19 px (RMS) from where the rig has them"), std::string::npos) << *remark;
}

// A camera that nothing joins to the others keeps them from being solved only where all are wanted;
// also where it is the first one, whose frame the rig would have.
TEST(Rig, LeavesOutCamerasThatNothingJoins) {
  for (const std::size_t alone : {std::size_t{2}, std::size_t{0}}) {
    Random random(13);
    const SimulatedRig rig = scenes::ring_rig(4, random);
    auto seen = scenes::seen_by(rig, 60, 0.7, random);
    for (View& view : seen[alone].views) view.observation.timestamp += 500'000'000;
    EXPECT_FALSE(solve_rig(seen).has_value());
    RigOptions options;
    options.is_partial = true;
    const auto solved = solve_rig(seen, options);
    ASSERT_TRUE(solved.has_value()) << solved.error().message;
    ASSERT_EQ(solved->left_out.size(), 1U);
    EXPECT_EQ(solved->left_out[0].camera, "cam" + std::to_string(alone));
    EXPECT_NE(solved->left_out[0].reason.find("seen no board at the same time as"),
              std::string::npos);
    ASSERT_EQ(solved->rig.cameras.size(), 3U);
    const std::size_t first = alone == 0 ? 1 : 0;
    EXPECT_EQ(solved->rig.world, "cam" + std::to_string(first));
    const SE3 truth = rig.world_from_camera[first].inverse() * rig.world_from_camera[3];
    EXPECT_LT(place_error(solved->rig.cameras[2], truth).largest, 4.5);
  }
}

// Of two cameras that are not joined there is no rig to be had.
TEST(Rig, RefusesAPairThatNothingJoins) {
  Random random(14);
  auto seen = scenes::seen_by(scenes::stereo_rig(random), 15, 0.7, random);
  for (View& view : seen[1].views) view.observation.timestamp += 500'000'000;
  RigOptions options;
  options.is_partial = true;
  const auto solved = solve_rig(seen, options);
  ASSERT_FALSE(solved.has_value());
  EXPECT_EQ(solved.error().code, ErrorCode::kDegenerate);
}

TEST(Rig, IsTheSameAtEveryRun) {
  Random random(11);
  const SimulatedRig rig = scenes::ring_rig(4, random);
  const auto seen = scenes::seen_by(rig, 40, 0.7, random);
  const auto first = solve_rig(seen);
  const auto second = solve_rig(seen);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(print_rig(first->rig).value(), print_rig(second->rig).value());
}

TEST(Rig, RefusesNamesThatDoNotTellCamerasApart) {
  Random random(12);
  auto seen = scenes::seen_by(scenes::stereo_rig(random), 10, 0.7, random);
  EXPECT_EQ(solve_rig({seen[0]}).error().code, ErrorCode::kInvalidArgument);
  seen[1].calibration.camera = "cam0";
  const auto solved = solve_rig(seen);
  ASSERT_FALSE(solved.has_value());
  EXPECT_NE(solved.error().message.find("'cam0'"), std::string::npos);
}

TEST(Instants, HavePicturesOfOneTime) {
  const auto camera = [](std::vector<std::uint64_t> times) {
    RigCameraViews views;
    for (const std::uint64_t t : times) {
      View view{{}, scenes::kBoard};
      view.observation.timestamp = t;
      view.observation.ids = {0};
      views.views.push_back(view);
    }
    return views;
  };
  const auto paired = pair_instants({camera({0, 100, 200, 300}), camera({7, 95, 260, 500})}, 10);
  ASSERT_EQ(paired.instants.size(), 2U);
  EXPECT_EQ(paired.farthest, 7U);
  EXPECT_EQ(paired.instants[0].timestamp, 0U);
  EXPECT_EQ(paired.instants[1].timestamp, 95U);
  EXPECT_EQ(paired.instants[1].views.size(), 2U);
  // A picture belongs to one instant.
  const auto close = pair_instants({camera({0, 8}), camera({4})}, 10);
  ASSERT_EQ(close.instants.size(), 1U);
  EXPECT_EQ(close.instants[0].views.size(), 2U);
}

}  // namespace
}  // namespace calvin
