// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Ground truth for tests: random cameras, random poses of a board before them, exact or noisy
// corners. Everything follows from the seed of the generator that is passed in.
#pragma once

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <random>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "calvin/camera/camera.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/solve/solve.hpp"

namespace calvin::scenes {

using Random = std::mt19937_64;

inline constexpr ImageSize kSize = {1280, 960};
inline constexpr Checkerboard kSquares = {9, 6, 0.025};
inline const Board kBoard = kSquares;

// The counts that the issues name rather than the reduced ones.
inline bool full_count() {
  const char* text = std::getenv("CALVIN_FULL");
  return text != nullptr && std::string_view(text) == "1";
}

inline double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

// The models that the tests of the solver go through. Missing are the rational family and the
// double sphere: a board in 25 views at the noise of these scenes hardly tells their coefficients
// apart.
inline const std::vector<std::string_view> kSolvedModels = {"pinhole", "brown4", "brown5",
                                                            "fisheye", "ucm",    "eucm"};

// Whether the models' lenses see past 90 degrees.
inline bool is_wide(std::string_view model) {
  return model == "fisheye" || model == "ucm" || model == "eucm" || model == "doublesphere";
}

// sqrt(x_d^2 + y_d^2) at 90 degrees from the axis, by the formulae of docs/conventions.md.
inline double half_picture(std::string_view model, const double* d) {
  if (model == "ucm") return 1 / d[0];
  if (model == "eucm") return 1 / (d[0] * std::sqrt(d[1]));
  if (model == "doublesphere") return 1 / (d[1] * std::hypot(1, d[0]) + (1 - d[1]) * d[0]);
  return std::numbers::pi / 2;
}

// A plausible camera of any model: 56 to 77 degrees wide, those for wide angles about 180.
inline Camera random_camera(std::string_view model, Random& random, ImageSize size = kSize) {
  const auto draw = [&random](double low, double high) { return uniform(random, low, high); };
  const auto names = parameter_names(model);
  const bool wide = is_wide(model);
  const double fx = size.width * (wide ? draw(0.28, 0.36) : draw(0.8, 1.2));
  std::vector<double> p = {fx, fx * draw(0.997, 1.003), size.width * draw(0.48, 0.52),
                           size.height * draw(0.48, 0.52)};
  if (model == "fisheye") {
    for (const double k : {0.03, 0.01, 0.005, 0.002}) p.push_back(draw(-k, k));
  } else if (wide) {
    for (std::size_t i = 4; i < names.size(); ++i) {
      if (names[i] == "alpha") p.push_back(draw(0.5, 0.7));
      if (names[i] == "beta") p.push_back(draw(0.9, 1.2));
      if (names[i] == "xi") p.push_back(draw(-0.25, 0.1));
    }
    const double scale = std::numbers::pi / 2 / half_picture(model, p.data() + 4);
    p[0] *= scale;
    p[1] *= scale;
  } else if (model != "pinhole") {
    for (const auto& [low, high] : std::vector<std::pair<double, double>>{{-0.3, 0.1},
                                                                          {-0.05, 0.12},
                                                                          {-1e-3, 1e-3},
                                                                          {-1e-3, 1e-3},
                                                                          {-0.03, 0.03},
                                                                          {-0.1, 0.1},
                                                                          {-0.02, 0.02},
                                                                          {-0.01, 0.01},
                                                                          {-1e-3, 1e-3},
                                                                          {-1e-3, 1e-3},
                                                                          {-1e-3, 1e-3},
                                                                          {-1e-3, 1e-3},
                                                                          {-0.03, 0.03},
                                                                          {-0.03, 0.03}}) {
      // As many draws for brown4 as for brown5.
      if (p.size() >= std::max<std::size_t>(names.size(), 9)) break;
      p.push_back(draw(low, high));
    }
    p.resize(names.size());
  }
  return Camera::make(model, size, p).value();
}

// Whether every corner projects into the image.
inline bool sees_all(const Camera& camera, const Board& board, const SE3& camera_from_board) {
  for (const Eigen::Vector3d& point : board.points()) {
    const auto at = camera.project(camera_from_board * point);
    if (!at || at->u < 0 || at->v < 0 || at->u > camera.image_size().width - 1 ||
        at->v > camera.image_size().height - 1) {
      return false;
    }
  }
  return true;
}

// camera_from_board with the board wholly in the image, somewhere in it, 0.25 to 0.8 of the image
// wide, turned up to 30 degrees and tilted by `tilt` (rad) from the line of sight to any side.
inline SE3 random_pose(const Camera& camera, const Board& board, Random& random, double tilt) {
  const BoardArea area = board.extent();
  const Eigen::Vector3d center((area.left + area.right) / 2, (area.top + area.bottom) / 2, 0);
  for (;;) {
    const ImageSize size = camera.image_size();
    const auto ray =
        camera.unproject({uniform(random, 0, size.width - 1), uniform(random, 0, size.height - 1)});
    if (!ray) continue;
    const double extent = uniform(random, 0.25, 0.8) * size.width;
    const double distance = camera.fx() * area.width() / extent;
    const double side = uniform(random, 0, 2 * std::numbers::pi);
    const Eigen::Matrix3d facing = rotation_between(Eigen::Vector3d::UnitZ(), *ray);
    const Eigen::Matrix3d rotation = facing *
                                     exp_so3({tilt * std::cos(side), tilt * std::sin(side), 0}) *
                                     exp_so3({0, 0, uniform(random, -0.5, 0.5)});
    SE3 pose = {rotation, *ray * distance - rotation * center};
    if (sees_all(camera, board, pose)) return pose;
  }
}

// Poses tilted 0 to `max_tilt` rad.
inline std::vector<SE3> random_poses(const Camera& camera, const Board& board, Random& random,
                                     int count, double max_tilt = std::numbers::pi / 4) {
  std::vector<SE3> poses;
  for (int i = 0; i < count; ++i) {
    poses.push_back(random_pose(camera, board, random, uniform(random, 0, max_tilt)));
  }
  return poses;
}

// All corners of the board as the camera sees them, with Gaussian noise of `sigma` px per
// coordinate. The corners must have a projection.
inline View observe(const Camera& camera, const Board& board, const SE3& camera_from_board,
                    double sigma, Random& random) {
  std::normal_distribution<double> noise(0, 1);
  View view;
  view.board = board;
  view.observation.board = board.text();
  view.observation.image_size = camera.image_size();
  view.observation.ids = board.ids();
  for (const Eigen::Vector3d& point : board.points()) {
    const Pixel at = camera.project(camera_from_board * point).value();
    view.observation.uv.push_back({at.u + sigma * noise(random), at.v + sigma * noise(random)});
    view.observation.sigma.push_back(sigma > 0 ? sigma : 1);
  }
  return view;
}

inline std::vector<View> observe_all(const Camera& camera, const Board& board,
                                     const std::vector<SE3>& poses, double sigma, Random& random) {
  std::vector<View> views;
  for (const SE3& pose : poses) {
    views.push_back(observe(camera, board, pose, sigma, random));
    views.back().observation.timestamp = 1000 * views.size();
  }
  return views;
}

// e^T C^-1 e / n over the estimated parameters: 1 on average where the covariance is right.
double normalised_error(const Calibration& calibration, const Camera& truth);

}  // namespace calvin::scenes
