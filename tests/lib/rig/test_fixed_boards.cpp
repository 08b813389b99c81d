// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Boards on the sides of a box: cameras that never see the same one are placed by them, how the
// boards are on the box is found with them, and all is as well known as it says.
#include <algorithm>
#include <cstdint>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/rig/solve_rig.hpp"
#include "calvin/session/rig/rig_session.hpp"
#include "simulated_box.hpp"

namespace calvin {
namespace {

using scenes::Box;
using scenes::kSides;
using scenes::place_error;
using scenes::Random;
using Studio = scenes::BoxStudio;

RigOptions on_a_box() {
  RigOptions options;
  options.fixed_boards = true;
  return options;
}

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
    const Studio studio = scenes::box_studio(kSides, GetParam(), random);
    const auto seen = scenes::boxes_seen_in(studio, 30, random);
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
  const Studio studio = scenes::box_studio(kSides, 2, random);
  const auto seen = scenes::boxes_seen_in(studio, 30, random);
  const auto solved = solve_rig(seen);
  ASSERT_FALSE(solved.has_value());
  EXPECT_NE(solved.error().message.find("seen no board at the same time"), std::string::npos)
      << solved.error().message;
}

// A board that looks the same after half a turn is on the box either way.
TEST(FixedBoards, MayBeSymmetric) {
  const int trials = scenes::full_count() ? 40 : 4;
  for (int trial = 0; trial < trials; ++trial) {
    Random random(40 + static_cast<std::uint64_t>(trial));
    const Studio studio = scenes::box_studio({"checkerboard:9x6:16mm", "checkerboard:8x6:16mm",
                                              "checkerboard:7x6:18mm", "checkerboard:10x7:14mm"},
                                             2, random);
    const auto seen = scenes::boxes_seen_in(studio, 60, random);
    const auto solved = solve_rig(seen, on_a_box());
    ASSERT_TRUE(solved.has_value()) << solved.error().message;
    EXPECT_TRUE(solved->rejected.empty());
    EXPECT_EQ(solved->rig.fixed_boards.size(), 3U);
    const SE3 truth = studio.world_from_camera[0].inverse() * studio.world_from_camera[1];
    EXPECT_LT(place_error(solved->rig.cameras[1], truth).largest, 4.5);
  }
}

// Of two boards that were seen beside a symmetric one alone nothing tells how they lie.
TEST(FixedBoards, AreNotJoinedByASymmetricOne) {
  for (int trial = 0; trial < 4; ++trial) {
    Random random(50 + static_cast<std::uint64_t>(trial));
    const Studio studio = scenes::box_studio(
        {"checkerboard:9x6:16mm", "checkerboard:8x6:16mm", "checkerboard:7x6:18mm"}, 2, random);
    const auto seen = scenes::boxes_seen_in(studio, 60, random);
    const auto solved = solve_rig(seen, on_a_box());
    ASSERT_TRUE(solved.has_value()) << solved.error().message;
    ASSERT_EQ(solved->remarks.size(), 1U);
    EXPECT_NE(solved->remarks.front().find("leaves open"), std::string::npos);
    const SE3 truth = studio.world_from_camera[0].inverse() * studio.world_from_camera[1];
    EXPECT_LT(place_error(solved->rig.cameras[1], truth).largest, 4.5);
  }
}

// A board that no camera has seen beside another one is carried by itself, and that is said.
TEST(FixedBoards, ThatNoPictureJoinsAreTold) {
  Random random(6);
  const Studio studio = scenes::box_studio(kSides, 3, random);
  auto seen = scenes::boxes_seen_in(studio, 60, random);
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
  const Studio studio = scenes::box_studio({"checkerboard:9x6:16mm"}, 2, random);
  const auto solved = solve_rig(scenes::boxes_seen_in(studio, 30, random), on_a_box());
  ASSERT_FALSE(solved.has_value());
  EXPECT_NE(solved.error().message.find("show two of them to one camera"), std::string::npos);
}

// Views as they come, in the order of time: the session keeps what joins the cameras.
TEST(FixedBoards, AreTakenByASession) {
  Random random(9);
  const Studio studio = scenes::box_studio(kSides, 2, random);
  const auto seen = scenes::boxes_seen_in(studio, 60, random);
  RigSessionSettings settings;
  settings.options.fixed_boards = true;
  RigSession session;
  session.start(settings);
  std::vector<std::pair<std::size_t, const Observation*>> all;
  for (std::size_t c = 0; c < seen.size(); ++c) {
    session.set_name(c, seen[c].calibration.camera);
    session.set_intrinsics(c, seen[c].calibration);
    for (const View& view : seen[c].views) all.emplace_back(c, &view.observation);
  }
  std::ranges::stable_sort(all, {}, [](const auto& one) { return one.second->timestamp; });
  for (const auto& [camera, observation] : all) {
    ASSERT_TRUE(session.offer(camera, *observation).has_value());
  }
  const auto job = session.take_solve(true);
  ASSERT_TRUE(job.has_value());
  const auto solved = solve_rig(views_of(*job), job->options);
  ASSERT_TRUE(solved.has_value()) << solved.error().message;
  EXPECT_EQ(solved->rig.fixed_boards.size(), kSides.size() - 1);
  const SE3 truth = studio.world_from_camera[0].inverse() * studio.world_from_camera[1];
  EXPECT_LT(place_error(solved->rig.cameras[1], truth).largest, 4.5);
}

// Two cameras side by side need no second board.
TEST(FixedBoards, AreNotNeededWhereOneBoardPlacesAllCameras) {
  Random random(10);
  const scenes::SimulatedRig rig = scenes::stereo_rig(random);
  const auto solved = solve_rig(scenes::seen_by(rig, 15, 0.7, random), on_a_box());
  ASSERT_TRUE(solved.has_value()) << solved.error().message;
  EXPECT_LT(place_error(solved->rig.cameras[1], rig.world_from_camera[1]).largest, 4.5);
  EXPECT_TRUE(solved->rig.fixed_boards.empty());
  ASSERT_EQ(solved->remarks.size(), 1U);
  EXPECT_NE(solved->remarks.front().find("beside another board"), std::string::npos);
}

TEST(FixedBoards, HaveToDiffer) {
  Random random(11);
  const Studio studio =
      scenes::box_studio({"checkerboard:9x6:16mm", "checkerboard:9x6:16mm"}, 2, random);
  const auto solved = solve_rig(scenes::boxes_seen_in(studio, 60, random), on_a_box());
  ASSERT_FALSE(solved.has_value());
  EXPECT_EQ(solved.error().code, ErrorCode::kInvalidArgument);
  EXPECT_NE(solved.error().message.find("two boards 'checkerboard:9x6:16mm'"), std::string::npos);
}

TEST(FixedBoards, TellTheSameTwice) {
  Random random(8);
  const Studio studio = scenes::box_studio(kSides, 3, random);
  const auto seen = scenes::boxes_seen_in(studio, 30, random);
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
