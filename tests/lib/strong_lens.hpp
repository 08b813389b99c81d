// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Cameras whose every coefficient shows in the picture, so that two solvers can be compared in each
// of them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scenes.hpp"

namespace calvin::scenes {

// As random_camera(), but the models with many coefficients are about 100 degrees wide and strongly
// distorted; and the spheres of doublesphere are well apart: at xi = 0 a change of f, alpha and xi
// are three combinations of the same two functions (the distance and z), and on either side of that
// there is a basin of its own.
inline Camera strong_camera(std::string_view model, Random& random) {
  const std::vector<std::string_view> names = parameter_names(model);
  if (model == "doublesphere") {
    for (;;) {
      Camera camera = random_camera(model, random);
      if (camera.parameters()[4] < -0.18) return camera;
    }
  }
  if (names.size() < 12 || model == "fisheye") return random_camera(model, random);
  const auto draw = [&random](double low, double high) { return uniform(random, low, high); };
  const double fx = kSize.width * draw(0.42, 0.46);
  std::vector<double> p = {fx, fx * draw(0.997, 1.003), kSize.width * draw(0.48, 0.52),
                           kSize.height * draw(0.48, 0.52)};
  for (const auto& [low, high] : std::vector<std::pair<double, double>>{{0.5, 0.6},    // k1
                                                                        {0.02, 0.04},  // k2
                                                                        {-1e-3, 1e-3},
                                                                        {-1e-3, 1e-3},
                                                                        {0.001, 0.002},  // k3
                                                                        {0.8, 0.9},      // k4
                                                                        {0.13, 0.15},
                                                                        {0.005, 0.006},
                                                                        {-2e-3, 2e-3},  // s1
                                                                        {-1e-3, 1e-3},
                                                                        {-2e-3, 2e-3},
                                                                        {-1e-3, 1e-3},
                                                                        {-0.05, 0.05},  // taux
                                                                        {-0.05, 0.05}}) {
    if (p.size() < names.size()) p.push_back(draw(low, high));
  }
  return Camera::make(model, kSize, p).value();
}

}  // namespace calvin::scenes
