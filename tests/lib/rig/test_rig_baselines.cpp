// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Known distances between cameras: boards that were printed too large are found so, places are as
// well known as is said, and what nobody can mean is refused.
#include <cmath>
#include <functional>
#include <iostream>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "calvin/io/camera_baselines.hpp"
#include "calvin/rig/joint/baselines.hpp"
#include "calvin/rig/solve_rig.hpp"
#include "simulated_rig.hpp"

namespace calvin {
namespace {

using scenes::place_error;
using scenes::Random;
using scenes::SimulatedRig;

constexpr double kMillimetre = 1e-3;

double normal(Random& random) { return std::normal_distribution<double>(0, 1)(random); }

double distance_in(const Rig& rig, std::size_t a, std::size_t b) {
  return (to_se3(rig.cameras[a].rig_from_camera).translation -
          to_se3(rig.cameras[b].rig_from_camera).translation)
      .norm();
}

double true_distance(const SimulatedRig& rig, std::size_t a, std::size_t b) {
  return (rig.world_from_camera[a].translation - rig.world_from_camera[b].translation).norm();
}

// What is seen of a board that is `size` times as large as its text says.
std::vector<RigCameraViews> seen_larger(SimulatedRig rig, double size, int instants,
                                        Random& random) {
  rig.board = parse_board(fmt::format("checkerboard:9x6:{:.9f}mm", 25 * size)).value();
  auto seen = scenes::seen_by(rig, instants, 0.7, random);
  const Board said = parse_board("checkerboard:9x6:25mm").value();
  for (RigCameraViews& camera : seen) {
    for (View& view : camera.views) view.board = said;
  }
  return seen;
}

struct Kind {
  const char* name;
  std::function<SimulatedRig(Random&)> make;
  int instants;
  int trials;  // reduced
  int full_trials;
  std::vector<std::pair<std::size_t, std::size_t>> known;
  double sigma;  // m
};
const Kind kKinds[] = {
    {"Stereo", [](Random& r) { return scenes::stereo_rig(r); }, 15, 120, 900, {{0, 1}}, 5e-5},
    {"RingOfFour",
     [](Random& r) { return scenes::ring_rig(4, r); },
     40,
     30,
     400,
     {{0, 1}, {1, 3}},
     1e-3},
};

class Baselines : public ::testing::TestWithParam<Kind> {};
INSTANTIATE_TEST_SUITE_P(Rig, Baselines, ::testing::ValuesIn(kKinds),
                         [](const auto& test) { return std::string(test.param.name); });

// Boards are off by a percent, distances are measured with an error: predicted over true error.
TEST_P(Baselines, ArePriorsWithTheirSigmas) {
  const Kind& kind = GetParam();
  const int trials = scenes::full_count() ? kind.full_trials : kind.trials;
  double squares = 0;
  double of_scale = 0;
  int cameras = 0;
  for (int trial = 0; trial < trials; ++trial) {
    Random random(7000 + static_cast<std::uint64_t>(trial));
    const SimulatedRig rig = kind.make(random);
    const double size = 1 + 0.01 * normal(random);
    const auto seen = seen_larger(rig, size, kind.instants, random);
    RigOptions options;
    for (const auto& [a, b] : kind.known) {
      options.baselines.push_back({fmt::format("cam{}", a), fmt::format("cam{}", b),
                                   true_distance(rig, a, b) + kind.sigma * normal(random),
                                   kind.sigma});
    }
    const auto solved = solve_rig(seen, options);
    ASSERT_TRUE(solved.has_value()) << trial << ": " << solved.error().message;
    ASSERT_TRUE(solved->board_scale.has_value());
    of_scale += std::pow((solved->board_scale->scale - size) / solved->board_scale->sigma, 2);
    for (std::size_t c = 1; c < rig.cameras.size(); ++c) {
      const SE3 truth = rig.world_from_camera[0].inverse() * rig.world_from_camera[c];
      squares += place_error(solved->rig.cameras[c], truth).square;
      ++cameras;
    }
  }
  std::cout << kind.name << ": mean of e^T C^-1 e / 6 = " << squares / cameras << ", of the scale "
            << of_scale / trials << "\n";
  EXPECT_NEAR(squares / cameras, 1, scenes::full_count() ? 0.1 : 0.15);
  // A chi square of so many degrees of freedom, within 3.5 of its sigmas.
  EXPECT_NEAR(of_scale / trials, 1, 3.5 * std::sqrt(2.0 / trials));
}

TEST(Baselines, GiveTheirLengthToBoardsThatAreWrong) {
  Random random(1);
  const SimulatedRig rig = scenes::stereo_rig(random);
  const auto seen = seen_larger(rig, 1.02, 15, random);
  const double distance = true_distance(rig, 0, 1);
  const auto plain = solve_rig(seen);
  ASSERT_TRUE(plain.has_value());
  EXPECT_FALSE(plain->board_scale.has_value());
  RigOptions options;
  options.baselines = {{"", "", distance, 0}};  // of the two cameras
  const auto solved = solve_rig(seen, options);
  ASSERT_TRUE(solved.has_value()) << solved.error().message;
  EXPECT_NEAR(distance_in(solved->rig, 0, 1), distance, 1e-10);
  EXPECT_NEAR(solved->board_scale->scale, 1.02, 4 * solved->board_scale->sigma);
  EXPECT_LT(solved->board_scale->sigma, 0.003);
  // It is said, in what people measure; and the links show it.
  ASSERT_EQ(solved->remarks.size(), 1U);
  EXPECT_NE(solved->remarks[0].find("larger"), std::string::npos) << solved->remarks[0];
  EXPECT_NE(solved->remarks[0].find("25 mm on them measures 25."), std::string::npos);
  ASSERT_TRUE(solved->links[0].bias && plain->links[0].bias);
  EXPECT_NEAR((1 + *solved->links[0].bias) / (1 + *plain->links[0].bias),
              solved->board_scale->scale, 1e-3);
  EXPECT_NEAR(solved->links[0].distance, distance, 1e-10);
  EXPECT_LT(solved->links[0].distance_sigma, 1e-9);
  // In the lengths of the boards it is the rig without them.
  const Rig back = in_board_lengths(*solved);
  EXPECT_NEAR(distance_in(back, 0, 1) * solved->board_scale->scale, distance, 1e-10);
  // Boards are kept where they were shown, scaled likewise.
  ASSERT_FALSE(solved->rig.boards.empty());
  ASSERT_EQ(solved->rig.boards.size(), plain->rig.boards.size());
  for (std::size_t i = 0; i < solved->rig.boards.size(); ++i) {
    const Eigen::Vector3d before = to_se3(plain->rig.boards[i].rig_from_board).translation;
    const Eigen::Vector3d after = to_se3(solved->rig.boards[i].rig_from_board).translation;
    EXPECT_LT((after - solved->board_scale->scale * before).norm(), 1e-9);
  }
}

// A distance that is known to a tenth says nothing against boards that are known to a hundredth.
TEST(Baselines, CountAsMuchAsTheyAreKnown) {
  Random random(2);
  const SimulatedRig rig = scenes::stereo_rig(random);
  const auto seen = seen_larger(rig, 1, 15, random);
  const double distance = true_distance(rig, 0, 1);
  RigOptions options;
  options.baselines = {{"cam0", "cam1", 1.1 * distance, 0.1 * distance}};
  const auto weak = solve_rig(seen, options);
  ASSERT_TRUE(weak.has_value());
  EXPECT_NEAR(weak->board_scale->scale, 1, 0.003);
  EXPECT_NEAR(weak->board_scale->sigma, 0.01, 0.001);
  EXPECT_TRUE(weak->remarks.empty());
  // Boards of a known size are that large, whatever is said of the cameras.
  options.board_sigma = 0;
  options.baselines = {{"cam1", "cam0", 1.02 * distance, 0.005 * distance}};
  const auto held = solve_rig(seen, options);
  ASSERT_TRUE(held.has_value());
  EXPECT_EQ(held->board_scale->scale, 1);
  EXPECT_EQ(held->board_scale->sigma, 0);
  // A contradiction is told of.
  options.board_sigma = 0.001;
  options.baselines = {{"cam1", "cam0", 1.05 * distance, 0.001 * distance}};
  const auto wrong = solve_rig(seen, options);
  ASSERT_TRUE(wrong.has_value());
  ASSERT_FALSE(wrong->remarks.empty());
  EXPECT_NE(wrong->remarks.back().find("sigmas from what boards say"), std::string::npos);
}

// Before a floor, too: the board is as large as the distance says.
TEST(Baselines, ScaleAFloor) {
  Random random(3);
  SimulatedRig rig = scenes::ring_rig(4, random);
  rig.board = parse_board("checkerboard:9x6:25.5mm").value();
  const Board said = parse_board("checkerboard:9x6:25mm").value();
  std::vector<RigCameraViews> seen;
  const SE3 world_from_board = {exp_so3({0.1, 0.05, 0.3}), {-0.1, -0.06, 0}};
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    RigCameraViews camera;
    camera.calibration = rig.cameras[c].to_calibration();
    camera.calibration.camera = "cam" + std::to_string(c);
    const SE3 pose = rig.world_from_camera[c].inverse() * world_from_board;
    View view = scenes::observe(rig.cameras[c], rig.board, pose, rig.noise, random);
    view.board = said;
    camera.views.push_back(view);
    seen.push_back(camera);
  }
  RigOptions options;
  options.mode = RigMode::kFloor;
  options.baselines = {{"cam0", "cam2", true_distance(rig, 0, 2), 1e-4}};
  const auto solved = solve_rig(seen, options);
  ASSERT_TRUE(solved.has_value()) << solved.error().message;
  EXPECT_NEAR(solved->board_scale->scale, 1.02, 4 * solved->board_scale->sigma);
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    const SE3 truth = world_from_board.inverse() * rig.world_from_camera[c];
    EXPECT_LT(place_error(solved->rig.cameras[c], truth).largest, 4.5) << c;
  }
  ASSERT_EQ(solved->rig.boards.size(), 1U);
  EXPECT_EQ(solved->rig.boards[0].board, "checkerboard:9x6:25mm");
}

// The same least squares by its normal equations, step by step: other formulas than the update.
TEST(Baselines, AreALeastSquares) {
  Random random(4);
  constexpr Eigen::Index kCount = 18;
  rig::PlacedCameras cameras;
  for (int c = 0; c < 3; ++c) {
    cameras.rig_from_camera.push_back(
        {exp_so3({0.1 * c, -0.2, 0.3}), {0.4 * c, 0.3 * normal(random), 0.2 * normal(random)}});
  }
  const Eigen::MatrixXd root =
      Eigen::MatrixXd::NullaryExpr(kCount, kCount, [&] { return 0.003 * normal(random); });
  cameras.covariance = root * root.transpose() + 1e-8 * Eigen::MatrixXd::Identity(kCount, kCount);
  const auto before = [&](std::size_t a, std::size_t b) {
    return (cameras.rig_from_camera[a].translation - cameras.rig_from_camera[b].translation).norm();
  };
  const std::vector<rig::KnownDistance> known = {{0, 1, 1.02 * before(0, 1), 0.004},
                                                 {1, 2, 1.01 * before(1, 2), 0.01},
                                                 {0, 2, 1.03 * before(0, 2), 0.002}};
  constexpr double kBoard = 0.02;
  const auto scaled = rig::scale_by(cameras, known, kBoard);
  ASSERT_TRUE(scaled.has_value());
  const Eigen::MatrixXd weight = cameras.covariance.inverse();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(kCount + 1);
  const auto error = [&](const Eigen::VectorXd& at, std::size_t k) {
    const auto place = [&](std::size_t c) -> Eigen::Vector3d {
      return cameras.rig_from_camera[c].translation +
             at.segment<3>(6 * static_cast<Eigen::Index>(c) + 3);
    };
    const double length = (place(known[k].a) - place(known[k].b)).norm();
    return ((1 + at(kCount)) * length - known[k].distance) / known[k].sigma;
  };
  Eigen::MatrixXd information;
  for (int step = 0; step < 30; ++step) {
    information = Eigen::MatrixXd::Zero(kCount + 1, kCount + 1);
    information.topLeftCorner(kCount, kCount) = weight;
    information(kCount, kCount) = 1 / (kBoard * kBoard);
    Eigen::VectorXd gradient = information * x;
    for (std::size_t k = 0; k < known.size(); ++k) {
      Eigen::VectorXd by(kCount + 1);
      for (Eigen::Index i = 0; i <= kCount; ++i) {
        Eigen::VectorXd to = x;
        Eigen::VectorXd from = x;
        to(i) += 1e-6;
        from(i) -= 1e-6;
        by(i) = (error(to, k) - error(from, k)) / 2e-6;
      }
      gradient += by * error(x, k);
      information += by * by.transpose();
    }
    x -= information.ldlt().solve(gradient);
  }
  EXPECT_NEAR(scaled->scale, 1 + x(kCount), 1e-7);
  EXPECT_NEAR(scaled->sigma, std::sqrt(information.inverse()(kCount, kCount)), 1e-6);
  for (std::size_t c = 0; c < 3; ++c) {
    const auto at = 6 * static_cast<Eigen::Index>(c);
    const Eigen::Vector3d place =
        (1 + x(kCount)) * (cameras.rig_from_camera[c].translation + x.segment<3>(at + 3));
    EXPECT_LT((scaled->cameras.rig_from_camera[c].translation - place).norm(), 1e-7);
    const Eigen::Matrix3d turned = exp_so3(x.segment<3>(at)) * cameras.rig_from_camera[c].rotation;
    EXPECT_LT((scaled->cameras.rig_from_camera[c].rotation - turned).norm(), 1e-7);
  }
}

TEST(Baselines, ThatNobodyCanMeanAreRefused) {
  Random random(5);
  const SimulatedRig rig = scenes::chain_rig(3, random);
  const auto seen = scenes::seen_by(rig, 60, 0.7, random);
  const std::pair<std::vector<CameraBaseline>, const char*> wrong[] = {
      {{{"cam0", "left", 1, 0}}, "no distance between 'cam0' and 'left': the cameras are 'cam0', "},
      {{{"cam0", "cam0", 1, 0}}, "no distance between 'cam0' and 'cam0'"},
      {{{"", "", 1, 0}}, "the rig has 3: name two of them, as 'cam0:cam2:110mm'"},
      {{{"cam0", "cam1", -1, 0}}, "is a length"},
      {{{"cam0", "cam1", 1, std::nan("")}}, "is a length"},
      {{{"cam0", "cam1", 1, 0}, {"cam1", "cam0", 1.1, 0}}, "contradict each other"},
  };
  for (const auto& [baselines, words] : wrong) {
    RigOptions options;
    options.baselines = baselines;
    const auto solved = solve_rig(seen, options);
    ASSERT_FALSE(solved.has_value()) << words;
    EXPECT_EQ(solved.error().code, ErrorCode::kInvalidArgument);
    EXPECT_NE(solved.error().message.find(words), std::string::npos) << solved.error().message;
  }
}

// One that is of a camera that cannot be placed keeps the others from nothing.
TEST(Baselines, OfCamerasThatAreLeftOutDoNotCount) {
  Random random(6);
  const SimulatedRig rig = scenes::chain_rig(3, random);
  auto seen = scenes::seen_by(rig, 60, 0.7, random);
  seen[2].views.clear();
  RigOptions options;
  options.is_partial = true;
  options.baselines = {{"cam0", "cam2", 1.5, 0}, {"cam0", "cam1", true_distance(rig, 0, 1), 1e-3}};
  const auto solved = solve_rig(seen, options);
  ASSERT_TRUE(solved.has_value()) << solved.error().message;
  ASSERT_EQ(solved->left_out.size(), 1U);
  EXPECT_NEAR(distance_in(solved->rig, 0, 1), true_distance(rig, 0, 1), 4e-3);
  const std::string all = fmt::format("{}", fmt::join(solved->remarks, " "));
  EXPECT_NE(all.find("between 'cam0' and 'cam2' does not count"), std::string::npos) << all;
}

TEST(BaselineText, IsWhatUsersType) {
  const auto named = parse_camera_baselines("left:right:110.03mm:0.05mm, left : top : 12.5cm");
  ASSERT_TRUE(named.has_value()) << named.error().message;
  ASSERT_EQ(named->size(), 2U);
  EXPECT_EQ((*named)[0].a, "left");
  EXPECT_EQ((*named)[0].b, "right");
  EXPECT_NEAR((*named)[0].distance, 110.03 * kMillimetre, 1e-12);
  EXPECT_NEAR((*named)[0].sigma, 0.05 * kMillimetre, 1e-12);
  EXPECT_EQ((*named)[1].b, "top");
  EXPECT_EQ((*named)[1].sigma, 0);
  const auto plain = parse_camera_baselines("0.12m:1mm");
  ASSERT_TRUE(plain.has_value()) << plain.error().message;
  EXPECT_TRUE(plain->front().a.empty());
  EXPECT_NEAR(plain->front().sigma, kMillimetre, 1e-12);
  EXPECT_TRUE(parse_camera_baselines(" ")->empty());
  for (const char* wrong : {"left:right", "110", "-1mm", "left:left:1m", "a:b:1m:2m:3m", "a::1m",
                            "1m:0mm", "1m,", "a:b:1m:x"}) {
    const auto read = parse_camera_baselines(wrong);
    ASSERT_FALSE(read.has_value()) << wrong;
    EXPECT_NE(read.error().message.find("left:right:110.03mm:0.05mm"), std::string::npos);
  }
}

}  // namespace
}  // namespace calvin
