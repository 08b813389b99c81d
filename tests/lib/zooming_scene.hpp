// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Views of a board through a lens that zooms by four from the first to the last.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "scenes.hpp"

namespace calvin::scenes {

struct ZoomingLens {
  Pixel center;
  double aspect = 1;
  double bend = 0;  // in the corner of the image, from barrel to as much pincushion

  // `s`: 0..1 of the way from the shortest to the longest focal length.
  [[nodiscard]] Camera at(double s) const {
    const double f = 900 * std::pow(4, s);
    const double q = std::pow(800 / f, 2);
    return Camera::make("brown4", kSize,
                        {aspect * f, f, center.u, center.v, bend * (2 * s - 1) / q, 0, 0, 0})
        .value();
  }
};

inline ZoomingLens random_zooming_lens(Random& random, double off_center, double bend) {
  const double cx = 640 + uniform(random, -off_center, off_center);
  const double cy = 480 + uniform(random, -off_center, off_center);
  return {{cx, cy}, 1, bend};
}

struct ZoomingScene {
  std::vector<Camera> cameras;  // of each view
  std::vector<SE3> poses;
  std::vector<View> views;
};

// Boards that are tilted by .5 to .9 rad.
inline ZoomingScene zooming_scene(const ZoomingLens& lens, int count, double noise,
                                  Random& random) {
  ZoomingScene scene;
  for (int i = 0; i < count; ++i) {
    const Camera camera = lens.at(static_cast<double>(i) / std::max(1, count - 1));
    scene.cameras.push_back(camera);
    scene.poses.push_back(random_pose(camera, kBoard, random, uniform(random, 0.5, 0.9)));
    scene.views.push_back(observe(camera, kBoard, scene.poses.back(), noise, random));
  }
  return scene;
}

}  // namespace calvin::scenes
