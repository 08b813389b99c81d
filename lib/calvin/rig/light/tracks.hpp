// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What cameras have seen of a light, as linear algebra wants it. Internal.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include <Eigen/Core>

#include "calvin/rig/light_camera.hpp"

namespace calvin::rig {

using Matrix34 = Eigen::Matrix<double, 3, 4>;

// The image of the light in one camera: `at` is in coordinates in which the axis is at 0 and a
// focal length is about 1, `scale` is how many px such a unit is.
struct TrackPoint {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  double scale = 1;
};

// Of one camera, by instant; absent where it has not seen the light. All cameras have as many.
using Track = std::vector<std::optional<TrackPoint>>;
using Tracks = std::vector<Track>;

// Picks for random sampling. The numbers of the generator are defined by the standard, those of
// the standard's distributions are not.
class Picker {
 public:
  // Different numbers, all below `count`, which is not less than `wanted`.
  [[nodiscard]] std::vector<std::size_t> pick(std::size_t wanted, std::size_t count);

 private:
  std::mt19937_64 random_{20050214};
};

// The instants at which both cameras have seen the light.
[[nodiscard]] std::vector<std::size_t> common_instants(const Track& a, const Track& b);

// Instants that are enough for a start: some that most cameras have seen, and some of each camera.
[[nodiscard]] std::vector<std::size_t> instants_to_begin_with(
    const std::vector<LightCamera>& cameras);

// The unit vector that is least under a symmetric matrix.
[[nodiscard]] Eigen::VectorXd least_direction(const Eigen::MatrixXd& symmetric);

}  // namespace calvin::rig
