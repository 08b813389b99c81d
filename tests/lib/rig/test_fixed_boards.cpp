// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Boards on the sides of a box: cameras that never see the same one are placed by them, how the
// boards are on the box is found with them, and all is as well known as it says.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/rig/solve_rig.hpp"
#include "calvin/target/board.hpp"
#include "simulated_rig.hpp"

namespace calvin {
namespace {

using scenes::place_error;
using scenes::Random;
using scenes::uniform;

struct Box {
  std::vector<Board> boards;  // one on each side
  std::vector<SE3> box_from_board;
};

// The printed sides face outwards, which is -z of a board; none is quite where it should be.
Box box_of(const std::vector<const char*>& texts, Random& random) {
  constexpr double kHalf = 0.1;  // m
  Box box;
  for (std::size_t side = 0; side < texts.size(); ++side) {
    box.boards.push_back(parse_board(texts[side]).value());
    const double angle = 2 * std::numbers::pi * static_cast<double>(side) /
                         static_cast<double>(std::max<std::size_t>(texts.size(), 4));
    const Eigen::Vector3d outwards(std::cos(angle), std::sin(angle), 0);
    const SE3 side_pose = scenes::looking(outwards * kHalf, {0, 0, 0});
    const BoardArea extent = box.boards.back().extent();
    const Eigen::Vector3d middle(extent.width() / 2, extent.height() / 2, 0);
    const auto off = [&](double most) { return uniform(random, -most, most); };
    const SE3 badly = {exp_so3({off(0.05), off(0.05), off(0.5)}), {off(0.01), off(0.01), off(0.01)}};
    const SE3 centered = {Eigen::Matrix3d::Identity(), -middle};
    box.box_from_board.push_back(side_pose * badly * centered);
  }
  return box;
}

struct Studio {
  Box box;
  std::vector<Camera> cameras;
  std::vector<SE3> world_from_camera;
};

// Cameras around the box, in which each sees two sides at the most.
Studio studio_of(const std::vector<const char*>& texts, int cameras, Random& random) {
  Studio studio = {box_of(texts, random), {}, {}};
  for (int i = 0; i < cameras; ++i) {
    const double angle = 2 * std::numbers::pi * i / cameras;
    studio.cameras.push_back(scenes::random_camera("brown5", random));
    studio.world_from_camera.push_back(
        scenes::looking({0.7 * std::cos(angle), 0.7 * std::sin(angle), -0.1}, {0, 0, 0}));
  }
  return studio;
}

std::vector<RigCameraViews> seen_in(const Studio& studio, int instants, Random& random) {
  constexpr double kNoise = 0.1;  // px
  std::vector<RigCameraViews> all(studio.cameras.size());
  for (std::size_t c = 0; c < all.size(); ++c) {
    all[c].calibration = studio.cameras[c].to_calibration();
    all[c].calibration.camera = "cam" + std::to_string(c);
  }
  for (int n = 0; n < instants; ++n) {
    const auto off = [&](double most) { return uniform(random, -most, most); };
    const SE3 world_from_box = {
        exp_so3({off(0.4), off(0.4), 0}) * exp_so3({0, 0, off(std::numbers::pi)}),
        {off(0.08), off(0.08), off(0.08)}};
    for (std::size_t c = 0; c < all.size(); ++c) {
      for (std::size_t side = 0; side < studio.box.boards.size(); ++side) {
        const SE3 pose = studio.world_from_camera[c].inverse() * world_from_box *
                         studio.box.box_from_board[side];
        const Board& board = studio.box.boards[side];
        if (!scenes::faces(pose) || !scenes::sees_all(studio.cameras[c], board, pose)) continue;
        View view = scenes::observe(studio.cameras[c], board, pose, kNoise, random);
        view.observation.timestamp = static_cast<std::uint64_t>(n) * 1'000'000'000;
        scenes::name_at_random(view, random);
        all[c].views.push_back(std::move(view));
      }
    }
  }
  return all;
}

RigOptions on_a_box() {
  RigOptions options;
  options.fixed_boards = true;
  return options;
}

const std::vector<const char*> kSides = {"checkerboard:9x6:16mm", "checkerboard:8x5:18mm",
                                         "checkerboard:7x6:18mm", "checkerboard:10x7:14mm"};

// e^T C^-1 e / 6 of how a board is found to be fixed, and the largest component in sigmas.
scenes::PlaceError error_of(const FixedBoard& found, const Box& box) {
  std::size_t own = 0;
  std::size_t on = 0;
  for (std::size_t side = 0; side < box.boards.size(); ++side) {
    if (box.boards[side].text() == found.board) own = side;
    if (box.boards[side].text() == found.on) on = side;
  }
  RigCamera place;  // the same numbers
  place.rig_from_camera = found.on_from_board;
  place.covariance = found.covariance;
  return place_error(place, box.box_from_board[on].inverse() * box.box_from_board[own]);
}

class FixedBoards : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Cameras, FixedBoards, ::testing::Values(2, 3),
                         [](const auto& test) { return std::to_string(test.param); });

TEST_P(FixedBoards, JoinCamerasThatNeverSeeTheSameBoard) {
  const int trials = scenes::full_count() ? 300 : 20;
  double squares = 0;
  double of_boards = 0;
  int cameras = 0;
  int boards = 0;
  double largest = 0;
  for (int trial = 0; trial < trials; ++trial) {
    Random random(100 + static_cast<std::uint64_t>(trial));
    const Studio studio = studio_of(kSides, GetParam(), random);
    const auto seen = seen_in(studio, 30, random);
    const auto solved = solve_rig(seen, on_a_box());
    ASSERT_TRUE(solved.has_value()) << trial << ": " << solved.error().message;
    EXPECT_TRUE(solved->rejected.empty()) << trial;
    EXPECT_TRUE(solved->remarks.empty()) << solved->remarks.front();
    for (std::size_t c = 1; c < studio.cameras.size(); ++c) {
      const SE3 truth = studio.world_from_camera[0].inverse() * studio.world_from_camera[c];
      const auto error = place_error(solved->rig.cameras[c], truth);
      squares += error.square;
      largest = std::max(largest, error.largest);
      ++cameras;
    }
    ASSERT_EQ(solved->rig.fixed_boards.size(), kSides.size() - 1);
    for (const FixedBoard& board : solved->rig.fixed_boards) {
      const auto error = error_of(board, studio.box);
      of_boards += error.square;
      largest = std::max(largest, error.largest);
      ++boards;
    }
  }
  std::cout << GetParam() << " cameras: mean of e^T C^-1 e / 6 = " << squares / cameras
            << ", of boards " << of_boards / boards << ", the largest component " << largest
            << " sigma\n";
  const double margin = scenes::full_count() ? 0.1 : 0.3;
  EXPECT_NEAR(squares / cameras, 1, margin);
  EXPECT_NEAR(of_boards / boards, 1, margin);
  EXPECT_LT(largest, scenes::full_count() ? 5 : 4.5);
}

TEST(FixedBoards, AreCarriedByThemselvesUnlessSaid) {
  Random random(5);
  const Studio studio = studio_of(kSides, 2, random);
  const auto seen = seen_in(studio, 30, random);
  const auto solved = solve_rig(seen);
  ASSERT_FALSE(solved.has_value());
  EXPECT_NE(solved.error().message.find("have seen no board at the same time"), std::string::npos)
      << solved.error().message;
}

// A board that looks the same after half a turn is on the box either way.
TEST(FixedBoards, MayBeSymmetric) {
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    Random random(seed);
    const Studio studio = studio_of(
        {"checkerboard:9x6:16mm", "checkerboard:8x6:16mm", "checkerboard:7x6:18mm"}, 2, random);
    const auto seen = seen_in(studio, 60, random);
    const auto solved = solve_rig(seen, on_a_box());
    ASSERT_TRUE(solved.has_value()) << solved.error().message;
    const SE3 truth = studio.world_from_camera[0].inverse() * studio.world_from_camera[1];
    EXPECT_LT(place_error(solved->rig.cameras[1], truth).largest, 4.5);
  }
}

// A board that no camera has seen beside another one is carried by itself, and that is said.
TEST(FixedBoards, ThatNoPictureJoinsAreTold) {
  Random random(6);
  const Studio studio = studio_of(kSides, 3, random);
  auto seen = seen_in(studio, 60, random);
  const std::string alone = studio.box.boards[2].text();
  for (RigCameraViews& camera : seen) {
    std::vector<std::uint64_t> with_others;
    for (const View& view : camera.views) {
      if (view.observation.board != alone) with_others.push_back(view.observation.timestamp);
    }
    std::erase_if(camera.views, [&](const View& view) {
      return view.observation.board == alone &&
             std::ranges::count(with_others, view.observation.timestamp) > 0;
    });
  }
  const auto solved = solve_rig(seen, on_a_box());
  ASSERT_TRUE(solved.has_value()) << solved.error().message;
  EXPECT_EQ(solved->rig.fixed_boards.size(), kSides.size() - 2);
  ASSERT_EQ(solved->remarks.size(), 1U);
  EXPECT_NE(solved->remarks.front().find(alone), std::string::npos);
  EXPECT_NE(solved->remarks.front().find("beside another board"), std::string::npos);
}

TEST(FixedBoards, AreRefusedWhereNoPictureShowsTwo) {
  Random random(7);
  const Studio studio = studio_of({"checkerboard:9x6:16mm"}, 2, random);
  const auto solved = solve_rig(seen_in(studio, 30, random), on_a_box());
  ASSERT_FALSE(solved.has_value());
  EXPECT_NE(solved.error().message.find("show two of them to one camera"), std::string::npos);
}

TEST(FixedBoards, TellTheSameTwice) {
  Random random(8);
  const Studio studio = studio_of(kSides, 3, random);
  const auto seen = seen_in(studio, 30, random);
  const auto one = solve_rig(seen, on_a_box());
  const auto other = solve_rig(seen, on_a_box());
  ASSERT_TRUE(one.has_value() && other.has_value());
  for (std::size_t k = 0; k < one->rig.fixed_boards.size(); ++k) {
    EXPECT_EQ(one->rig.fixed_boards[k].on_from_board.translation,
              other->rig.fixed_boards[k].on_from_board.translation);
    EXPECT_EQ(one->rig.fixed_boards[k].covariance, other->rig.fixed_boards[k].covariance);
  }
}

}  // namespace
}  // namespace calvin
