// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Boards on the sides of a box that is turned before cameras all around it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "calvin/target/board.hpp"
#include "simulated_rig.hpp"

namespace calvin::scenes {

inline const std::vector<const char*> kSides = {"checkerboard:9x6:16mm", "checkerboard:8x5:18mm",
                                                "checkerboard:7x6:18mm", "checkerboard:10x7:14mm"};

struct Box {
  std::vector<Board> boards;  // one on each side
  std::vector<SE3> box_from_board;
};

// The printed sides face outwards, which is -z of a board; none is quite where it should be.
inline Box box_of(const std::vector<const char*>& texts, Random& random) {
  constexpr double kHalf = 0.1;  // m
  Box box;
  for (std::size_t side = 0; side < texts.size(); ++side) {
    box.boards.push_back(parse_board(texts[side]).value());
    const double angle = 2 * std::numbers::pi * static_cast<double>(side) /
                         static_cast<double>(std::max<std::size_t>(texts.size(), 4));
    const Eigen::Vector3d outwards(std::cos(angle), std::sin(angle), 0);
    const SE3 side_pose = looking(outwards * kHalf, {0, 0, 0});
    const BoardArea extent = box.boards.back().extent();
    const Eigen::Vector3d middle(extent.width() / 2, extent.height() / 2, 0);
    const auto off = [&](double most) { return uniform(random, -most, most); };
    const SE3 badly = {exp_so3({off(0.05), off(0.05), off(0.5)}),
                       {off(0.01), off(0.01), off(0.01)}};
    const SE3 centered = {Eigen::Matrix3d::Identity(), -middle};
    box.box_from_board.push_back(side_pose * badly * centered);
  }
  return box;
}

struct BoxStudio {
  Box box;
  std::vector<Camera> cameras;
  std::vector<SE3> world_from_camera;
};

// Cameras around the box, in which each sees two sides at the most.
inline BoxStudio box_studio(const std::vector<const char*>& texts, int cameras, Random& random) {
  BoxStudio studio = {box_of(texts, random), {}, {}};
  for (int i = 0; i < cameras; ++i) {
    const double angle = 2 * std::numbers::pi * i / cameras;
    studio.cameras.push_back(random_camera("brown5", random));
    studio.world_from_camera.push_back(
        looking({0.7 * std::cos(angle), 0.7 * std::sin(angle), -0.1}, {0, 0, 0}));
  }
  return studio;
}

inline std::vector<RigCameraViews> boxes_seen_in(const BoxStudio& studio, int instants,
                                                 Random& random) {
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
        if (!faces(pose) || !sees_all(studio.cameras[c], board, pose)) continue;
        View view = observe(studio.cameras[c], board, pose, kNoise, random);
        view.observation.timestamp = static_cast<std::uint64_t>(n) * 1'000'000'000;
        name_at_random(view, random);
        all[c].views.push_back(std::move(view));
      }
    }
  }
  return all;
}

}  // namespace calvin::scenes
