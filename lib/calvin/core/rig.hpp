// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Rig: cameras that know where each of them stands. Data only: rig/ finds it, io/ has its file.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calvin/core/calibration.hpp"

namespace calvin {

// So much later than its timestamps say, against those of another camera, one took its pictures.
struct TimeOffset {
  double seconds = 0;
  double sigma = 0;  // s
};

struct RigCamera {
  Calibration calibration;  // its `camera` is the camera's name
  Pose rig_from_camera;
  // Row-major, 6 x 6: how far the camera is turned about the axes of the rig (rad), then where it
  // stands in the rig (m), from what is true. Empty for the camera that is the rig.
  std::vector<double> covariance;
  std::optional<double> rms;  // px, of the corners that it has seen
  // Against the first camera. Absent where its pictures were taken for timely.
  std::optional<TimeOffset> time_offset = {};
};

// A board where it was seen.
struct RigBoard {
  std::string board;  // its text
  Pose rig_from_board;
};

// Where a board is that is fixed to another one.
struct FixedBoard {
  std::string board;  // the texts of both
  std::string on;
  Pose on_from_board;
  // Row-major, 6 x 6: how far the board is turned about the axes of the other one (rad), then where
  // it is in its frame (m), from what is true.
  std::vector<double> covariance;
};

struct Rig {
  std::vector<RigCamera> cameras;
  // The name of the camera whose frame is the rig's, kBoardWorld, kPlacesWorld or kReferenceWorld.
  std::string world;
  // Whether lengths are metres. Else they have no unit: a light tells places up to a common factor.
  bool is_metric = true;
  std::optional<double> rms;            // px, of all corners
  std::uint64_t pairing_tolerance = 0;  // ns: pictures no farther apart were taken for one instant
  // Some of those by which the cameras were placed, for whoever looks at the rig.
  std::vector<RigBoard> boards;
  // Boards that are fixed to each other, where such ones were shown.
  std::vector<FixedBoard> fixed_boards = {};
};

// What two cameras have in common.
struct RigLink {
  std::size_t a = 0;  // cameras of the rig, a < b
  std::size_t b = 0;
  std::size_t views = 0;  // boards that both have seen at one time
  std::size_t agree = 0;  // of them, those that agree with where the cameras stand
  double distance = 0;    // m, between the cameras
  double distance_sigma = 0;
  double angle = 0;  // rad, between the optical axes
  // Of the distances between corners that both cameras have seen, by their rays, to those on the
  // board: the mean of the ratio less 1, and the root mean square of what is left, m. Absent where
  // rays are too nearly parallel.
  std::optional<double> bias;
  std::optional<double> spread;
  // px: how far corners are from the rows of each other in rectified pictures, root mean square.
  // Absent where no common view is in use.
  std::optional<double> epipolar_error;
};

// Where a camera stands by other means, as a survey of the room.
struct CameraPlace {
  std::string camera;             // its name
  std::array<double, 3> place{};  // m, in a right-handed frame
};

// How far two cameras are apart by other means, as a data sheet or a tape says.
struct CameraBaseline {
  std::string a;  // names; both empty: of the two cameras of a rig that has no others
  std::string b;
  double distance = 0;  // m
  double sigma = 0;     // m; 0: exactly
};

// A frame that a rig is to have. Its axes may be turned by quarters, one turn after the other, each
// about an axis as it is then: of a board x points to the right, y down and z into it, so that half
// a turn about x lets z point up where the board lies on the floor.
struct RigWorld {
  struct Turn {
    int axis = 0;      // 0: x, 1: y, 2: z
    int quarters = 0;  // counter-clockwise, as seen from where the axis points
  };

  std::string camera;  // its frame; empty: that of a board
  // Where a board was that was carried: at the instant next to that time of its pictures, s, at
  // the last one for infinity. Absent: at the first one.
  std::optional<double> time;
  std::vector<Turn> turns;
};

// The two cameras of a stereo pair, and the one pinhole that the rectified pictures of both have:
// rows correspond, or columns where the pair stands one above the other.
struct RectifiedPair {
  std::size_t left = 0;  // cameras of the rig; the upper one is the left one
  std::size_t right = 1;
  bool is_vertical = false;
  double baseline = 0;  // m
  // Row-major, 3 x 3: from the frame of each camera to that of its rectified pictures.
  std::array<double, 9> rectified_from_left{};
  std::array<double, 9> rectified_from_right{};
  ImageSize image_size;
  double fx = 0;  // px
  double fy = 0;
  double cx = 0;
  double cy = 0;
};

// The frame of the rig is that of a board: the one that all cameras have seen where it lies still,
// or the one that was chosen of those that were carried.
inline constexpr const char* kBoardWorld = "board";
// The frame of the rig is that in which the places of its cameras were known.
inline constexpr const char* kPlacesWorld = "places";
// The frame of the rig is one that the program has chosen whose file was read.
inline constexpr const char* kReferenceWorld = "reference";

}  // namespace calvin
