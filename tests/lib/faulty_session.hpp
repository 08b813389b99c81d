// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A session of views with which something is wrong.
#pragma once

#include <functional>
#include <random>
#include <utility>
#include <vector>

#include "scenes.hpp"

namespace calvin::scenes {

inline constexpr double kNoise = 0.1;  // px
inline constexpr int kViews = 25;

// What happens to a session: `bend` moves the corners of the board (m), `spoil` those of a view.
struct Fault {
  std::function<Eigen::Vector3d(const Eigen::Vector3d&)> bend;
  std::function<void(View&, Random&)> spoil;
};

inline std::vector<View> session(const Camera& camera, const Fault& fault, Random& random,
                                 double sigma = kNoise, const Board& board = kBoard) {
  std::normal_distribution<double> noise(0, sigma);
  std::vector<View> views;
  for (const SE3& pose : random_poses(camera, board, random, kViews)) {
    View view = observe(camera, board, pose, 0, random);
    for (std::size_t i = 0; i < view.observation.uv.size(); ++i) {
      const Eigen::Vector3d printed =
          board.points()[static_cast<std::size_t>(view.observation.ids[i])];
      const Eigen::Vector3d point = fault.bend ? fault.bend(printed) : printed;
      const Pixel at = camera.project(pose * point).value();
      view.observation.uv[i] = {at.u + noise(random), at.v + noise(random)};
    }
    view.observation.sigma.assign(view.observation.uv.size(), sigma);
    if (fault.spoil) fault.spoil(view, random);
    views.push_back(std::move(view));
  }
  return views;
}

}  // namespace calvin::scenes
