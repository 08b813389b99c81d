// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The frame of a rig is the one that was asked for, and errors in it are as large as is said.
#include <cmath>
#include <functional>
#include <iostream>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "calvin/io/rig_world.hpp"
#include "calvin/rig/solve_rig.hpp"
#include "simulated_rig.hpp"

namespace calvin {
namespace {

using scenes::place_error;
using scenes::Random;
using scenes::SimulatedRig;

// Four cameras around a board that lies on the floor first, and is carried then.
struct FloorFirst {
  SimulatedRig rig;
  SE3 world_from_floor;
  std::vector<RigCameraViews> seen;
};

FloorFirst floor_first(Random& random) {
  FloorFirst all = {scenes::ring_rig(4, random), {}, {}};
  const BoardArea extent = all.rig.board.extent();
  all.world_from_floor = {Eigen::Matrix3d::Identity(),
                          {-extent.width() / 2, -extent.height() / 2, 0}};
  all.seen = scenes::seen_by(all.rig, 25, 0.7, random);
  for (std::size_t c = 0; c < all.seen.size(); ++c) {
    for (View& view : all.seen[c].views) view.observation.timestamp += 2'000'000'000;
    const SE3 pose = all.rig.world_from_camera[c].inverse() * all.world_from_floor;
    View view = scenes::observe(all.rig.cameras[c], all.rig.board, pose, all.rig.noise, random);
    view.observation.timestamp = 1'000'000'000 + c * 1'000'000;
    all.seen[c].views.insert(all.seen[c].views.begin(), std::move(view));
  }
  return all;
}

// Focal lengths and principal points are off by what their sigmas say.
void make_inexact(std::vector<RigCameraViews>& seen, Random& random) {
  std::normal_distribution<double> noise(0, 1);
  for (RigCameraViews& camera : seen) {
    camera.calibration.covariance = std::vector<double>(16, 0.0);
    for (std::size_t i = 0; i < 4; ++i) {
      Parameter& p = camera.calibration.parameters[i];
      p.sigma = 1.5;
      p.value += *p.sigma * noise(random);
      camera.calibration.covariance[5 * i] = *p.sigma * *p.sigma;
    }
  }
}

RigOptions in_world(const std::string& text) {
  RigOptions options;
  options.world = parse_rig_world(text).value();
  return options;
}

// What z of the world has to be turned by for "x180".
const SE3 kHalfTurn = {exp_so3({std::numbers::pi, 0, 0}), {0, 0, 0}};

struct Kind {
  const char* name;
  bool is_inexact;
  RigIntrinsics intrinsics;
  bool is_scaled;
};
const Kind kKinds[] = {
    {"ExactLenses", false, RigIntrinsics::kHeld, false},
    {"InexactLenses", true, RigIntrinsics::kHeld, false},
    {"FreeLenses", false, RigIntrinsics::kFree, false},
    {"PriorLenses", true, RigIntrinsics::kPrior, false},
    {"KnownDistance", false, RigIntrinsics::kHeld, true},
};
class Worlds : public ::testing::TestWithParam<Kind> {};
INSTANTIATE_TEST_SUITE_P(RigWorld, Worlds, ::testing::ValuesIn(kKinds),
                         [](const auto& test) { return std::string(test.param.name); });

// All cameras have errors there, the first one too.
TEST_P(Worlds, OfABoardIsAsWellKnownAsItSays) {
  const Kind& kind = GetParam();
  const int trials = scenes::full_count() ? 500 : 40;
  double squares = 0;
  int cameras = 0;
  for (int trial = 0; trial < trials; ++trial) {
    Random random(8100 + static_cast<std::uint64_t>(trial));
    FloorFirst all = floor_first(random);
    if (kind.is_inexact) make_inexact(all.seen, random);
    RigOptions options = in_world("board:x180");
    options.intrinsics = kind.intrinsics;
    if (kind.is_scaled) {
      const auto& places = all.rig.world_from_camera;
      const double distance = (places[0].translation - places[2].translation).norm();
      options.baselines = {{"cam0", "cam2", distance, 1e-4}};
    }
    const auto solved = solve_rig(all.seen, options);
    ASSERT_TRUE(solved.has_value()) << solved.error().message;
    EXPECT_EQ(solved->rig.world, kBoardWorld);
    const SE3 from_world = (all.world_from_floor * kHalfTurn).inverse();
    for (std::size_t c = 0; c < 4; ++c) {
      const SE3 truth = from_world * all.rig.world_from_camera[c];
      EXPECT_GT(solved->rig.cameras[c].rig_from_camera.translation[2], 0.1) << "z points up";
      squares += place_error(solved->rig.cameras[c], truth).square;
      ++cameras;
    }
  }
  std::cout << "mean of e^T C^-1 e / 6 = " << squares / cameras << '\n';
  EXPECT_NEAR(squares / cameras, 1, scenes::full_count() ? 0.1 : 0.25);
}

TEST(RigWorld, OfAnotherCameraIsAsWellKnownAsItSays) {
  const int trials = scenes::full_count() ? 500 : 40;
  double squares = 0;
  int cameras = 0;
  for (int trial = 0; trial < trials; ++trial) {
    Random random(8200 + static_cast<std::uint64_t>(trial));
    const FloorFirst all = floor_first(random);
    const SimulatedRig& rig = all.rig;
    const auto solved = solve_rig(all.seen, in_world("cam2"));
    ASSERT_TRUE(solved.has_value()) << solved.error().message;
    EXPECT_EQ(solved->rig.world, "cam2");
    EXPECT_TRUE(solved->rig.cameras[2].covariance.empty());
    EXPECT_TRUE(to_se3(solved->rig.cameras[2].rig_from_camera).rotation.isIdentity(1e-12));
    for (const std::size_t c : {0U, 1U, 3U}) {
      const SE3 truth = rig.world_from_camera[2].inverse() * rig.world_from_camera[c];
      squares += place_error(solved->rig.cameras[c], truth).square;
      ++cameras;
    }
  }
  std::cout << "mean of e^T C^-1 e / 6 = " << squares / cameras << '\n';
  EXPECT_NEAR(squares / cameras, 1, scenes::full_count() ? 0.1 : 0.25);
}

// Pairs, boards and cameras are the same, wherever one looks at them from.
TEST(RigWorld, ChangesNothingButTheFrame) {
  Random random(8300);
  const FloorFirst all = floor_first(random);
  const auto plain = solve_rig(all.seen);
  ASSERT_TRUE(plain.has_value());
  for (const char* world : {"cam0:x90:y-90", "cam3", "board", "board:last", "board:7"}) {
    const auto turned = solve_rig(all.seen, in_world(world));
    ASSERT_TRUE(turned.has_value()) << turned.error().message;
    const SE3 moved = to_se3(turned->rig.cameras[0].rig_from_camera) *
                      to_se3(plain->rig.cameras[0].rig_from_camera).inverse();
    for (std::size_t c = 0; c < 4; ++c) {
      const SE3 expected = moved * to_se3(plain->rig.cameras[c].rig_from_camera);
      const SE3 found = to_se3(turned->rig.cameras[c].rig_from_camera);
      EXPECT_LT((expected.rotation - found.rotation).norm(), 1e-9);
      EXPECT_LT((expected.translation - found.translation).norm(), 1e-9);
    }
    ASSERT_EQ(turned->rig.boards.size(), plain->rig.boards.size());
    for (std::size_t b = 0; b < plain->rig.boards.size(); ++b) {
      const SE3 expected = moved * to_se3(plain->rig.boards[b].rig_from_board);
      const SE3 found = to_se3(turned->rig.boards[b].rig_from_board);
      EXPECT_LT((expected.translation - found.translation).norm(), 1e-9);
    }
    for (std::size_t l = 0; l < plain->links.size(); ++l) {
      const double sigma = plain->links[l].distance_sigma;
      EXPECT_NEAR(turned->links[l].distance_sigma, sigma, 1e-6 * sigma);
      EXPECT_EQ(turned->links[l].agree, plain->links[l].agree);
    }
  }
}

// At the time that is asked for, and not at another one.
TEST(RigWorld, IsOfTheBoardAtItsTime) {
  Random random(8400);
  SimulatedRig rig = scenes::stereo_rig(random);
  std::vector<RigCameraViews> seen(2);
  std::vector<SE3> boards;
  for (std::size_t n = 0; n < 12; ++n) {
    SE3 world_from_board = scenes::held_board(rig, 0.7, random);
    while (!scenes::sees_all(rig.cameras[0], rig.board, world_from_board) ||
           !scenes::sees_all(rig.cameras[1], rig.board,
                             rig.world_from_camera[1].inverse() * world_from_board)) {
      world_from_board = scenes::held_board(rig, 0.7, random);
    }
    boards.push_back(world_from_board);
    for (std::size_t c = 0; c < 2; ++c) {
      seen[c].calibration = rig.cameras[c].to_calibration();
      seen[c].calibration.camera = "cam" + std::to_string(c);
      View view = scenes::observe(rig.cameras[c], rig.board,
                                  rig.world_from_camera[c].inverse() * world_from_board, 0, random);
      view.observation.timestamp = (5 + n) * 1'000'000'000;
      seen[c].views.push_back(std::move(view));
    }
  }
  const std::pair<const char*, std::size_t> cases[] = {{"board", 0},       {"board:0", 0},
                                                       {"board:9", 4},     {"board:9.4s", 4},
                                                       {"board:last", 11}, {"board:100", 11}};
  for (const auto& [text, instant] : cases) {
    const auto solved = solve_rig(seen, in_world(text));
    ASSERT_TRUE(solved.has_value()) << solved.error().message;
    for (std::size_t c = 0; c < 2; ++c) {
      const SE3 truth = boards[instant].inverse() * rig.world_from_camera[c];
      const SE3 found = to_se3(solved->rig.cameras[c].rig_from_camera);
      EXPECT_LT((truth.translation - found.translation).norm(), 1e-6) << text;
      EXPECT_LT((truth.rotation - found.rotation).norm(), 1e-6) << text;
    }
  }
}

TEST(RigWorld, TurnsTheFrameOfAFloor) {
  Random random(8500);
  FloorFirst all = floor_first(random);
  for (RigCameraViews& camera : all.seen) camera.views.resize(1);
  RigOptions options = in_world("board:x180");
  options.mode = RigMode::kFloor;
  const auto solved = solve_rig(all.seen, options);
  ASSERT_TRUE(solved.has_value()) << solved.error().message;
  const SE3 from_world = (all.world_from_floor * kHalfTurn).inverse();
  for (std::size_t c = 0; c < 4; ++c) {
    const SE3 truth = from_world * all.rig.world_from_camera[c];
    EXPECT_LT(place_error(solved->rig.cameras[c], truth).largest, 5);
  }
  options.world = parse_rig_world("cam1").value();
  const auto of_camera = solve_rig(all.seen, options);
  ASSERT_TRUE(of_camera.has_value());
  const SE3 truth = all.rig.world_from_camera[1].inverse() * all.rig.world_from_camera[0];
  EXPECT_LT(place_error(of_camera->rig.cameras[0], truth).largest, 5);
  EXPECT_TRUE(of_camera->rig.cameras[1].covariance.empty());
}

TEST(RigWorld, IsRefusedWhereNobodyKnowsIt) {
  Random random(8600);
  const SimulatedRig rig = scenes::stereo_rig(random);
  const auto solved = solve_rig(scenes::seen_by(rig, 12, 0.7, random), in_world("lefft"));
  ASSERT_FALSE(solved.has_value());
  EXPECT_EQ(solved.error().code, ErrorCode::kInvalidArgument);
  EXPECT_NE(solved.error().message.find("'cam0', 'cam1'"), std::string::npos);
  for (const char* wrong :
       {":x90", "board:w90", "board:x45", "board:-3", "board:x90:7", "cam0:last"}) {
    const auto world = parse_rig_world(wrong);
    ASSERT_FALSE(world.has_value()) << wrong;
    EXPECT_NE(world.error().message.find("board:x180"), std::string::npos);
  }
  EXPECT_FALSE(parse_rig_world(" ").value().has_value());
  EXPECT_TRUE(std::isinf(*parse_rig_world("board:last:y90").value()->time));
}

// ---- In a mirror --------------------------------------------------------------------------------

// What the camera gives behind a mirror: its calibration, and corners by the labels of the board
// that a detector finds there.
void mirror(RigCameraViews& camera, const Board& board, bool by_rows) {
  const auto grid = board.grid().value();
  Calibration& lens = camera.calibration;
  const int width = lens.image_size.width;
  for (Parameter& p : lens.parameters) {
    if (p.name == "cx") p.value = width - 1 - p.value;
    if (p.name == "p2") p.value = -p.value;
  }
  for (View& view : camera.views) {
    for (Pixel& at : view.observation.uv) at.u = width - 1 - at.u;
    for (int& id : view.observation.ids) {
      const int col = id % grid.cols;
      const int row = id / grid.cols;
      id =
          by_rows ? (grid.rows - 1 - row) * grid.cols + col : row * grid.cols + grid.cols - 1 - col;
    }
  }
}

TEST(RigMirrored, IsSaidOfTheCameraThatIs) {
  for (const bool by_rows : {false, true}) {
    Random random(8700);
    SimulatedRig rig = scenes::ring_rig(4, random);
    for (std::size_t c = 0; c < 4; ++c) {
      rig.cameras[c] = scenes::random_camera("brown4", random, rig.cameras[c].image_size());
    }
    auto seen = scenes::seen_by(rig, 30, 0.7, random);
    ASSERT_TRUE(solve_rig(seen).has_value());
    mirror(seen[1], rig.board, by_rows);
    const auto solved = solve_rig(seen);
    ASSERT_FALSE(solved.has_value());
    EXPECT_NE(solved.error().message.find("The pictures of 'cam1' are mirrored"), std::string::npos)
        << solved.error().message;
    RigOptions partial;
    partial.is_partial = true;
    const auto others = solve_rig(seen, partial);
    ASSERT_TRUE(others.has_value()) << others.error().message;
    EXPECT_EQ(others->rig.cameras.size(), 3U);
    ASSERT_EQ(others->left_out.size(), 1U);
    EXPECT_NE(others->left_out[0].reason.find("mirrored"), std::string::npos);
  }
}

TEST(RigMirrored, IsSaidOfBothOfAPair) {
  Random random(8800);
  SimulatedRig rig = scenes::stereo_rig(random);
  for (Camera& camera : rig.cameras) camera = scenes::random_camera("brown4", random);
  auto seen = scenes::seen_by(rig, 15, 0.7, random);
  mirror(seen[0], rig.board, true);
  const auto solved = solve_rig(seen);
  ASSERT_FALSE(solved.has_value());
  EXPECT_NE(solved.error().message.find("'cam0' or those of 'cam1' are mirrored"),
            std::string::npos)
      << solved.error().message;
}

}  // namespace
}  // namespace calvin
