// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a camera sees of a plane, ray by ray, by another way than the renderer's: each ray is cut
// with the plane in the camera frame.
#pragma once

#include <random>

#include "calvin/camera/camera.hpp"
#include "calvin/geometry/se3.hpp"

namespace calvin::scenes {

// `level(x, y)` is that of a place of the board, m.
template <typename Level>
double level_seen(const Camera& camera, const SE3& pose, double background, const Level& level,
                  Pixel pixel) {
  const auto ray = camera.unproject(pixel);
  if (!ray) return background;
  const Eigen::Vector3d normal = pose.rotation.col(2);
  const double distance = normal.dot(pose.translation) / normal.dot(*ray);
  if (!(distance > 0)) return background;
  const Eigen::Vector3d on_board = pose.inverse() * (distance * *ray);
  return level(on_board.x(), on_board.y());
}

// One sample at random in each of 32 x 32 cells of a pixel: an edge leaves less than 0.5 grey
// levels, 1 sigma, of uncertainty.
template <typename Level>
double mean_seen(const Camera& camera, const SE3& pose, double background, const Level& level,
                 int u, int v) {
  constexpr int kSub = 32;
  static std::mt19937 random(17);
  const auto jitter = [] { return static_cast<double>(random()) / 4294967296.0; };
  double sum = 0;
  for (int j = 0; j < kSub; ++j) {
    for (int i = 0; i < kSub; ++i) {
      const Pixel at = {u - 0.5 + (i + jitter()) / kSub, v - 0.5 + (j + jitter()) / kSub};
      sum += level_seen(camera, pose, background, level, at);
    }
  }
  return sum / (kSub * kSub);
}

}  // namespace calvin::scenes
