// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Scene: the cameras of a rig as shapes in space, for a picture of where they are and what they
// look at.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/rig.hpp"

namespace calvin {

struct SceneColour {
  double red = 0;  // 0..1
  double green = 0;
  double blue = 0;
  double alpha = 1;
};

// A line of any corners, or, where it is filled, a flat shape. m, frame of the rig.
struct ScenePath {
  std::vector<Eigen::Vector3d> points;
  SceneColour colour;
  double width = 1;  // of the line, in parts of a thin one
  bool is_closed = false;
  bool is_filled = false;
};

struct SceneLabel {
  Eigen::Vector3d at;
  std::string text;
  SceneColour colour;
};

struct Scene {
  std::vector<ScenePath> paths;
  std::vector<SceneLabel> labels;
  std::vector<std::string> notes;  // what is to be read beside: scales, numbers
  Eigen::Vector3d up = -Eigen::Vector3d::UnitY();
  Eigen::Vector3d behind = -Eigen::Vector3d::UnitZ();  // in the ground: where azimuths begin
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  double radius = 1;  // m, around the middle, that has all of it
  // What is to be in the picture from wherever one looks, but the ground: from the middle, how far
  // aside and how far up, m. Empty: the radius says it.
  std::vector<Eigen::Vector2d> rims = {};
};

// Every camera as a frustum as wide as its lens sees, flat in front, or round where the lens is
// wide, with its name, the upper side of its picture marked, and where its place is known with an
// error, an ellipsoid of that; the boards where they were seen; the axes of the rig; a grid on the
// ground, which is the board where the rig is that of a board. Upright as the cameras are on
// average. Cameras whose calibrations are of no camera have no frustum.
[[nodiscard]] Scene make_scene(const Rig& rig);

}  // namespace calvin
