// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Two cameras of different models on a rig, a board that may bend, a board without a grid and with
// gaps in its ids, and free points: where everything truly is, and what is seen of it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "calvin/solve/residuals/board_shape.hpp"
#include "calvin/solve/residuals/bundle_problem.hpp"
#include "scenes.hpp"

namespace calvin::scenes {

inline constexpr int kFrames = 12;
inline constexpr int kPoints = 20;
inline constexpr double kNoise = 0.2;       // px
inline constexpr double kWarpSigma = 2e-3;  // m, of the prior

inline SE3 drawn(Random& random, double turn, double shift) {
  const auto vector = [&random](double size) {
    return Eigen::Vector3d(uniform(random, -size, size), uniform(random, -size, size),
                           uniform(random, -size, size));
  };
  return {exp_so3(vector(turn)), vector(shift)};
}

inline constexpr std::array<double, 2> kWarp = {8e-4, -1.2e-3};  // m

// What is seen, and where everything truly is. The first camera is the rig.
struct Scene {
  std::vector<Camera> cameras;
  BundlePoint truth;
  BoardShape shape;                  // of the first board; the second is rigid
  std::deque<PointSet> sets;         // of the views of boards
  std::vector<BoardResiduals> seen;  // where `seen` is not set yet
  std::vector<PointResiduals> points;
};

// `on_frame`: the frame of the rig is that of no camera, and the first one has a place in it too.
inline ParameterTable table_of(const Scene& scene, bool on_frame) {
  TableCamera first = {std::string(scene.cameras[0].model()), true};
  first.has_rig_pose = on_frame;
  TableCamera second = {std::string(scene.cameras[1].model())};
  second.has_rig_pose = true;
  return ParameterTable({first, second}, {scene.shape.unknowns, BoardUnknowns()});
}

// Adds a corner where the camera sees the point, if it does, with noise and a sigma of its own.
inline void see(PointSet& set, const Camera& camera, int id, const Eigen::Vector3d& printed,
                const Eigen::Vector3d& in_camera, Random& random) {
  const auto at = camera.project(in_camera);
  if (!at || at->u < 0 || at->v < 0 || at->u > kSize.width || at->v > kSize.height) return;
  std::normal_distribution<double> noise(0, kNoise);
  set.ids.push_back(id);
  set.points.push_back(printed);
  set.uv.push_back({at->u + noise(random), at->v + noise(random)});
  set.weight.push_back(uniform(random, 0.5, 2));
}

// The ids of the second board have gaps, and its points lie in no grid and no plane.
inline std::vector<std::pair<int, Eigen::Vector3d>> gridless(Random& random) {
  std::vector<std::pair<int, Eigen::Vector3d>> points;
  for (int i = 0; i < 17; ++i) {
    points.emplace_back(5 + 7 * i + i * i,
                        Eigen::Vector3d(uniform(random, 0, 0.2), uniform(random, 0, 0.12),
                                        uniform(random, 0, 0.03)));
  }
  return points;
}

// What a camera sees of a board in one pose. The first board is bent.
inline PointSet seen_board(const Scene& scene, const BoardResiduals& block,
                           const std::vector<std::pair<int, Eigen::Vector3d>>& odd,
                           Random& random) {
  const Camera& camera = scene.cameras[block.camera];
  const SE3 camera_from_board =
      scene.truth.camera_from_rig[block.camera] * scene.truth.rig_from_board[block.pose];
  PointSet set;
  if (block.board == 1) {
    for (const auto& [id, p] : odd) see(set, camera, id, p, camera_from_board * p, random);
    return set;
  }
  const auto printed = kBoard.points();
  for (std::size_t i = 0; i < printed.size(); ++i) {
    Eigen::Vector3d bent = printed[i];
    for (std::size_t m = 0; m < 2; ++m) bent += kWarp[m] * scene.shape.displacement[2 * i + m];
    see(set, camera, static_cast<int>(i), printed[i], camera_from_board * bent, random);
  }
  return set;
}

inline void add_boards(Scene& scene, Random& random) {
  const auto odd = gridless(random);
  for (std::size_t pose = 0; pose < 2 * kFrames; ++pose) {
    const double tilt = uniform(random, 0, std::numbers::pi / 4);
    scene.truth.rig_from_board.push_back(random_pose(scene.cameras[0], kBoard, random, tilt));
    for (std::size_t c = 0; c < 2; ++c) {
      const BoardResiduals block = {nullptr, pose, c, pose % 2};
      PointSet set = seen_board(scene, block, odd, random);
      // That some cameras miss a board is part of it.
      if (set.size() < 6 || (pose == 7 && c == 1) || (pose == 10 && c == 0)) continue;
      scene.sets.push_back(std::move(set));
      scene.seen.push_back(block);
    }
  }
}

// Free points, seen from where the rig stands and from where it is known to stand later.
inline void add_points(Scene& scene, Random& random) {
  for (int i = 0; i < kPoints; ++i) {
    scene.truth.points.emplace_back(uniform(random, -0.3, 0.3), uniform(random, -0.2, 0.2),
                                    uniform(random, 0.7, 1.6));
  }
  for (const SE3& rig_from_world : {SE3(), drawn(random, 0.1, 0.1)}) {
    for (std::size_t c = 0; c < 2; ++c) {
      PointResiduals block = {{}, c, rig_from_world};
      const SE3 to_camera = scene.truth.camera_from_rig[c] * rig_from_world;
      for (int i = 0; i < kPoints; ++i) {
        const Eigen::Vector3d& p = scene.truth.points[static_cast<std::size_t>(i)];
        see(block.seen, scene.cameras[c], i, p, to_camera * p, random);
      }
      scene.points.push_back(std::move(block));
    }
  }
}

inline Scene make_scene() {
  Random random(11);
  Scene scene;
  const Camera plain = random_camera("brown5", random);
  scene.cameras = {Camera::make("brown5", kSize, plain.parameters(), 0.8).value(),
                   random_camera("fisheye", random)};
  scene.truth.camera_from_rig = {{}, {exp_so3({0.05, -0.2, 0.03}), {-0.12, 0.01, 0.02}}};
  SolveOptions options;
  options.warp = true;
  scene.shape = make_shape(kBoard, options);
  // In the order of table_of(scene, false): the cameras, the place of the second, the board.
  std::vector<double>& shared = scene.truth.shared;
  for (const Camera& camera : scene.cameras) {
    shared.insert(shared.end(), camera.parameters().begin(), camera.parameters().end());
    if (camera.skew() != 0) shared.push_back(camera.skew());
  }
  shared.insert(shared.end(), 6, 0.0);
  shared.insert(shared.end(), kWarp.begin(), kWarp.end());
  add_boards(scene, random);
  add_points(scene, random);
  return scene;
}

// Off the truth by more than any noise.
inline BundlePoint pushed(const Scene& scene, const ParameterTable& table, std::uint64_t seed) {
  Random random(seed);
  BundlePoint point = scene.truth;
  for (std::size_t c = 0; c < 2; ++c) {
    const auto scale = [&](ParameterRange range, double low, double high) {
      for (int i = range.first; i < range.end(); ++i) {
        point.shared[static_cast<std::size_t>(i)] *= uniform(random, low, high);
      }
    };
    scale(table.focal(c), 0.97, 1.03);
    scale(table.center(c), 0.98, 1.02);
    scale(table.distortion(c), 0.7, 1.2);
    scale(table.skew(c), 0, 1);
  }
  std::fill(point.shared.end() - 2, point.shared.end(), 0.0);
  for (SE3& pose : point.rig_from_board) pose = drawn(random, 0.02, 0.005) * pose;
  point.camera_from_rig[1] = drawn(random, 0.02, 0.01) * point.camera_from_rig[1];
  for (Eigen::Vector3d& p : point.points) p += drawn(random, 0, 0.02).translation;
  return point;
}

inline ParameterTable with_priors(ParameterTable table) {
  const ParameterRange warp = table.warp(0);
  for (int i = warp.first; i < warp.end(); ++i) table.add_prior({i, 0, kWarpSigma});
  return table;
}

}  // namespace calvin::scenes
