// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Cameras of which it is known where they stand, and what they see of a board that is carried
// about before them.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "calvin/rig/solve_rig.hpp"
#include "scenes.hpp"

namespace calvin::scenes {

struct SimulatedRig {
  std::vector<Camera> cameras;
  std::vector<SE3> world_from_camera;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  // m, world: where the board is carried
  Eigen::Vector3d reach = Eigen::Vector3d::Zero();   // m, how far to each side
  Board board = kBoard;
  double noise = 0.1;  // px
};

// Looks from a place at another one, upright where z of the world points down.
SE3 looking(const Eigen::Vector3d& from, const Eigen::Vector3d& at);

// Two cameras side by side, with slightly different lenses.
SimulatedRig stereo_rig(Random& random);

// Cameras around a place; every third one is wide, every second one smaller.
SimulatedRig ring_rig(int count, Random& random);

// In a row: only neighbours see the same.
SimulatedRig chain_rig(int count, Random& random);

// Where the board may be held: towards one of the cameras, tilted by up to `tilt` rad.
SE3 held_board(const SimulatedRig& rig, double tilt, Random& random);

// A camera sees the printed side of a board alone, and not when it is nearly edge on.
bool faces(const SE3& camera_from_board);

// What a board that looks the same after half a turn is named as: either way.
void name_at_random(View& view, Random& random);

// What all cameras see of a board in many places. Instants in which one camera or none sees it are
// among them.
std::vector<RigCameraViews> seen_by(const SimulatedRig& rig, int instants, double tilt,
                                    Random& random);

// Where a board is in a hand that swings before the cameras of a stereo rig.
class Swing {
 public:
  explicit Swing(Random& random) {
    for (double& phase : phases_) phase = uniform(random, 0, 6);
  }
  [[nodiscard]] SE3 at(double t) const {  // s
    const auto swing = [&](std::size_t i, double rate) { return std::sin(rate * t + phases_[i]); };
    return {exp_so3({0.4 * swing(0, 1.1), 0.4 * swing(1, 0.9), 0.3}),
            {-0.05 + 0.06 * swing(2, 0.8), -0.05 + 0.05 * swing(3, 1.0), 0.75}};
  }

 private:
  double phases_[4];
};

// How far a camera of a solved rig is from where it stands, in units of its covariance: the square
// over 6, and the largest component.
struct PlaceError {
  double square = 0;
  double largest = 0;
  double turn = 0;   // rad
  double place = 0;  // m
};
PlaceError place_error(const RigCamera& found, const SE3& truth);

}  // namespace calvin::scenes
