// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Ground truth for tests: random cameras, random poses of a board before them, exact or noisy
// corners. Everything follows from the seed of the generator that is passed in.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <random>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "calvin/camera/camera.hpp"
#include "calvin/camera/lens_table.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/solve/solve.hpp"
#include "calvin/target/kinds.hpp"

namespace calvin::scenes {

using Random = std::mt19937_64;

inline constexpr ImageSize kSize = {1280, 960};
inline constexpr Checkerboard kSquares = {9, 6, 0.025};
inline const Board kBoard = kSquares;

// The counts that the issues name rather than the reduced ones.
bool full_count();

inline double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

// The models that the tests of the solver go through. Missing are the rational family and the
// double sphere: a board in 25 views at the noise of these scenes hardly tells their coefficients
// apart.
inline const std::vector<std::string_view> kSolvedModels = [] {
  std::vector<std::string_view> models = model_names();
  for (const auto* inseparable : {"rational8", "thinprism12", "tilted14", "doublesphere"}) {
    std::erase(models, inseparable);
  }
  return models;
}();

// Whether the models' lenses see past 90 degrees.
inline bool is_wide(std::string_view model) { return !find_lens(model)->perspective; }

// A plausible camera of any model: 56 to 77 degrees wide, those for wide angles about 180.
Camera random_camera(std::string_view model, Random& random, ImageSize size = kSize);

// Whether every corner projects into the image.
bool sees_all(const Camera& camera, const Board& board, const SE3& camera_from_board);

// camera_from_board with the board wholly in the image, somewhere in it, 0.25 to 0.8 of the image
// wide, turned up to 30 degrees and tilted by `tilt` (rad) from the line of sight to any side.
SE3 random_pose(const Camera& camera, const Board& board, Random& random, double tilt);

// Poses tilted 0 to `max_tilt` rad.
std::vector<SE3> random_poses(const Camera& camera, const Board& board, Random& random, int count,
                              double max_tilt = std::numbers::pi / 4);

// All corners of the board as the camera sees them, with Gaussian noise of `sigma` px per
// coordinate. The corners must have a projection.
View observe(const Camera& camera, const Board& board, const SE3& camera_from_board, double sigma,
             Random& random);

std::vector<View> observe_all(const Camera& camera, const Board& board,
                              const std::vector<SE3>& poses, double sigma, Random& random);

// e^T C^-1 e / n over the estimated parameters: 1 on average where the covariance is right.
double normalised_error(const Calibration& calibration, const Camera& truth);

}  // namespace calvin::scenes
