// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Rendered boards with corners of squares, of which the corners are known, and pictures without
// any, for the detectors.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "calvin/camera/camera.hpp"
#include "calvin/core/observation.hpp"
#include "calvin/target/board.hpp"

namespace bench {

// How a class of pictures is made; what is 0 or false is left out.
struct SceneClass {
  const char* name = "";
  const char* board = "";  // empty: 9x6, and 11x8 in every third picture
  double noise = 2;        // grey levels
  double blur = 1;         // px, 1 sigma, on top of the pixel's own square
  double motion = 0;       // px, length of the blur at most
  double rolling = 0;      // px that the board moves at most while the rows are read
  double square_from = 0;  // px, side of a square; 0: as the board fills the picture
  double square_to = 0;
  double fill_from = 0.3;  // of the picture, by the board
  double fill_to = 0.9;
  double tilt = 0.7;  // rad, at most
  double light = 0;   // share by which the light changes across the picture
  double dark = 30;   // grey levels
  double bright = 220;
  double exposure = 1;
  int ink = 0;   // px by which the dark squares grow
  int jpeg = 0;  // quality
  bool clutter = false;
  bool fisheye = false;
  bool covered = false;  // by fingers
  bool carded = false;   // by a card with a straight edge
  bool cut = false;      // by the border of the picture

  [[nodiscard]] bool whole() const { return !covered && !carded && !cut; }
};

[[nodiscard]] const std::vector<SceneClass>& scene_classes();

struct Scene {
  calvin::Board board;
  cv::Mat image;              // 8-bit grey
  cv::Mat clean;              // the same in floating point, before noise
  calvin::Observation truth;  // the corners that can be seen
  // Square meets square here too, but something covers it: a point found is neither right nor
  // wrong.
  std::vector<calvin::Pixel> covered;
};

[[nodiscard]] Scene make_scene(const SceneClass& kind, calvin::ImageSize size, std::uint64_t seed);

// A picture without the board 9x6: clutter, tiles, textiles, text, keys, or a board of another
// size.
[[nodiscard]] cv::Mat make_negative(calvin::ImageSize size, std::uint64_t seed);

}  // namespace bench
