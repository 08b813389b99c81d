// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Kinds of random problems that a solver should always solve. Everything follows from the seed of
// the generator.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <ostream>
#include <string>
#include <vector>

#include "scenes.hpp"

namespace calvin::scenes {

struct Kind {
  const char* name;
  const char* model;
  int views;
  double least_tilt = 0;  // degrees
  double most_tilt = 45;
  double gross = 0;     // part of the corners that are 5 to 60 px off
  bool strong = false;  // a lens that distorts by a fifth of the picture and more

  friend std::ostream& operator<<(std::ostream& out, const Kind& kind) { return out << kind.name; }
};

inline const std::vector<Kind> kKinds = {
    {"TwoViews", "brown5", 2},
    {"ThreeViews", "brown5", 3},
    {"FiveViews", "brown5", 5},
    {"StrongDistortion", "brown5", 5, 0, 45, 0, true},
    {"TiltUnder5", "brown5", 5, 0, 5},
    {"Tilt50To70", "brown5", 5, 50, 70},
    {"Fisheye190Of5", "fisheye", 5},
    {"Fisheye190Of12", "fisheye", 12},
    {"Outliers10", "brown5", 10, 0, 45, 0.02},
    {"Outliers25", "brown5", 25, 0, 45, 0.02},
};

struct RandomProblem {
  Camera camera;
  std::vector<View> views;
  double cost = 0;  // px^2, of the corners at the truth
};

inline constexpr double kProblemNoise = 0.1;  // px

// Whether the rays of the image's border lead back to it: nothing folds back inside.
inline bool has_a_border(const Camera& camera) {
  constexpr int kSteps = 16;
  const double right = kSize.width - 1;
  const double bottom = kSize.height - 1;
  const auto returns = [&camera](Pixel p) {
    const auto ray = camera.unproject(p);
    const auto back = ray ? camera.project(*ray) : std::nullopt;
    return back && std::hypot(back->u - p.u, back->v - p.v) < 1e-6;
  };
  for (int i = 0; i <= kSteps; ++i) {
    const double u = right * i / kSteps;
    const double v = bottom * i / kSteps;
    if (!returns({u, 0}) || !returns({u, bottom}) || !returns({0, v}) || !returns({right, v})) {
      return false;
    }
  }
  return true;
}

// Barrel and pincushion, one all over the image.
inline Camera strongly_distorted(Random& random) {
  for (;;) {
    const double fx = kSize.width * uniform(random, 0.5, 0.75);
    Camera camera =
        Camera::make(
            "brown5", kSize,
            {fx, fx * uniform(random, 0.997, 1.003), kSize.width * uniform(random, .48, .52),
             kSize.height * uniform(random, .48, .52), uniform(random, -0.4, 0.3),
             uniform(random, -0.1, 0.2), uniform(random, -2e-3, 2e-3), uniform(random, -2e-3, 2e-3),
             uniform(random, -0.05, 0.02)})
            .value();
    const auto corner = camera.unproject({0, 0});
    if (!corner) continue;
    const double ideal = corner->head<2>().norm() / corner->z();
    const double seen = std::hypot(camera.cx() / camera.fx(), camera.cy() / camera.fy());
    if (std::abs(seen / ideal - 1) > 0.2 && has_a_border(camera)) return camera;
  }
}

inline RandomProblem random_problem(const Kind& kind, Random& random) {
  RandomProblem problem = {
      kind.strong ? strongly_distorted(random) : random_camera(kind.model, random), {}, 0};
  const Camera& camera = problem.camera;
  constexpr double kDegree = std::numbers::pi / 180;
  for (int i = 0; i < kind.views; ++i) {
    const double tilt = uniform(random, kind.least_tilt, kind.most_tilt) * kDegree;
    const SE3 pose = random_pose(camera, kBoard, random, tilt);
    View view = observe(camera, kBoard, pose, kProblemNoise, random);
    const auto points = kBoard.points();
    for (std::size_t k = 0; k < points.size(); ++k) {
      Pixel& p = view.observation.uv[k];
      const Pixel at = camera.project(pose * points[k]).value();
      problem.cost += std::pow(p.u - at.u, 2) + std::pow(p.v - at.v, 2);
      if (!(uniform(random, 0, 1) < kind.gross)) continue;
      const double angle = uniform(random, 0, 2 * std::numbers::pi);
      const double far = uniform(random, 5, 60);
      p = {std::clamp(p.u + far * std::cos(angle), 0.0, kSize.width - 1.0),
           std::clamp(p.v + far * std::sin(angle), 0.0, kSize.height - 1.0)};
    }
    problem.views.push_back(std::move(view));
  }
  return problem;
}

}  // namespace calvin::scenes
