// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Settings of zoom lenses that do not exist, calibrated from noisy corners.
#pragma once

#include <cmath>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "calvin/camera/zoom_table.hpp"
#include "scenes.hpp"
#include "zoom_lenses.hpp"

namespace calvin::scenes {

// What a camera sees of a large board that is held before all parts of the picture, and beyond its
// border, with that noise per coordinate, px.
inline std::vector<View> covering_views(const Camera& camera, int count, double noise,
                                        Random& random) {
  static const Board kLarge = Checkerboard{14, 9, 0.025};
  const auto points = kLarge.points();
  const auto ids = kLarge.ids();
  const BoardArea area = kLarge.extent();
  const Eigen::Vector3d middle((area.left + area.right) / 2, (area.top + area.bottom) / 2, 0);
  const ImageSize size = camera.image_size();
  std::normal_distribution<double> normal(0, noise);
  std::vector<View> views;
  while (static_cast<int>(views.size()) < count) {
    const auto ray = camera.unproject(
        {uniform(random, 0.1, 0.9) * size.width, uniform(random, 0.1, 0.9) * size.height});
    if (!ray) continue;
    const double shown = uniform(random, 0.6, 1.2) * size.width;
    const double side = uniform(random, 0, 2 * std::numbers::pi);
    const double tilt = uniform(random, 0.2, 0.9);
    const Eigen::Matrix3d rotation =
        rotation_between(Eigen::Vector3d::UnitZ(), *ray) *
        exp_so3({tilt * std::cos(side), tilt * std::sin(side), 0}) *
        exp_so3({0, 0, uniform(random, -std::numbers::pi, std::numbers::pi)});
    const SE3 pose = {rotation, *ray * (camera.fx() * area.width() / shown) - rotation * middle};
    View view;
    view.board = kLarge;
    view.observation.board = kLarge.text();
    view.observation.image_size = size;
    view.observation.timestamp = 1000 * (views.size() + 1);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto at = camera.project(pose * points[i]);
      if (!at || at->u < 0 || at->v < 0 || at->u > size.width - 1 || at->v > size.height - 1) {
        continue;
      }
      view.observation.ids.push_back(ids[i]);
      view.observation.uv.push_back({at->u + normal(random), at->v + normal(random)});
      view.observation.sigma.push_back(noise);
    }
    if (view.observation.ids.size() >= 40) views.push_back(std::move(view));
  }
  return views;
}

// A setting as it is calibrated: from views of a board with that noise, px.
inline Calibration calibrated(const ZoomLens& lens, double zoom, int views, double noise,
                              Random& random) {
  SolveOptions options;
  options.model = lens.model;
  options.checks = false;
  options.warp = false;
  const auto seen = covering_views(lens.at(zoom), views, noise, random);
  Calibration calibration = solve(seen, lens.size, options).value().calibration;
  calibration.zoom = zoom;
  return calibration;
}

// A table of settings that are calibrated so.
inline ZoomTable calibrated_table(const ZoomLens& lens, int settings, int views, double noise,
                                  Random& random) {
  std::vector<Calibration> all;
  for (const double zoom : lens.settings(settings)) {
    all.push_back(calibrated(lens, zoom, views, noise, random));
  }
  return make_zoom_table(std::move(all)).value();
}

}  // namespace calvin::scenes
