// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Motion: where the board is, at any time, for a camera that does not exist.
#pragma once

#include <cstdint>
#include <vector>

#include "calvin/camera/camera.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/target/board.hpp"

namespace calvin {

enum class MotionKind {
  kRandom,  // independent poses that together reach all of the image, its borders included
  kOrbit,   // the camera circles the board, once in 10 s
  kHand,    // a smooth path as of a board held by hand
  kStatic,  // one pose
};

// Poses of the whole board within the image, with a free margin of about a square, for any camera
// (fisheye ones beyond 90 degrees too). A light moves through all of the image, 0.8 to 2.4 m away;
// it circles where a camera would. A wand is turned about as well, and its middle moves so that its
// ends may leave the image. Immutable; the same for the same arguments.
class Motion {
 public:
  Motion(MotionKind kind, const Camera& camera, const Board& board, std::uint64_t seed);

  // `at`: time in s; for kRandom the number of the pose, of which the whole part counts. Negative
  // and non-finite values are taken as 0.
  [[nodiscard]] SE3 camera_from_board(double at) const;

 private:
  // The board's centre is seen at `pixel`, at `distance` (m); the board is turned by `roll` about
  // the line of sight and then tilted by `tilt` about the axis at `axis` (all rad).
  struct Placement {
    Pixel pixel;
    double distance = 0;
    double tilt = 0;
    double axis = 0;
    double roll = 0;
  };

  [[nodiscard]] bool place(const Placement& placement, SE3& camera_from_board) const;
  [[nodiscard]] double fill(const std::vector<Eigen::Vector3d>& points,
                            const SE3& camera_from_board) const;
  [[nodiscard]] bool fit(Placement& placement, double fill_wanted, SE3& camera_from_board) const;
  [[nodiscard]] SE3 light_pose(double at) const;
  [[nodiscard]] SE3 random_light(std::uint64_t number) const;
  [[nodiscard]] SE3 random_pose(std::uint64_t number) const;
  [[nodiscard]] SE3 hand_pose(double seconds) const;
  [[nodiscard]] SE3 orbit_pose(double seconds) const;
  [[nodiscard]] SE3 frontal_pose(double distance) const;

  MotionKind kind_;
  Camera camera_;
  Board board_;
  std::uint64_t seed_;
  std::vector<Eigen::Vector3d> outline_;  // some points of the border, m
  std::vector<Eigen::Vector3d> lattice_;  // all corners of all squares, m
  Pixel centre_;              // of the image, or the principal point where that sees nothing
  double unit_distance_ = 1;  // m, at which the board's circle fills the shorter side
};

}  // namespace calvin
