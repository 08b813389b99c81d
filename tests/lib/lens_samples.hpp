// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Coefficients to try every lens with: none, mild, strong, and everything at once; of a lens that
// has none here, the ends and the middle of what is typical of it.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>
#include <vector>

#include "calvin/camera/camera.hpp"
#include "calvin/camera/lens_table.hpp"

namespace calvin::samples {

struct Samples {
  std::vector<std::vector<double>> coefficients;
  double widest;  // angle from the axis at which all of them have a value, rad
};

// The angle from the axis up to which a lens sees, or nearly so, rad.
inline double widest_of(const LensTraits& lens, const std::vector<double>& coefficients) {
  if (lens.perspective) return 1.3;
  std::vector<double> parameters = {1, 1, 0, 0};
  parameters.insert(parameters.end(), coefficients.begin(), coefficients.end());
  const Camera camera = Camera::make(lens.model, {2, 2}, parameters).value();
  double angle = 0;
  while (angle < 3.1 && camera.project({std::sin(angle), 0, std::cos(angle)})) angle += 0.01;
  return 0.95 * angle;
}

inline Samples typical(const LensTraits& lens) {
  Samples samples = {{}, 3.2};
  for (const double share : {0.0, 0.5, 1.0}) {
    std::vector<double> coefficients;
    for (const auto& [low, high] : lens.typical) coefficients.push_back(low + share * (high - low));
    samples.widest = std::min(samples.widest, widest_of(lens, coefficients));
    samples.coefficients.push_back(std::move(coefficients));
  }
  return samples;
}

inline const Samples& lens(std::string_view model) {
  static std::map<std::string_view, Samples> samples = {
      {"pinhole", {{{}}, 1.3}},
      {"brown4", {{{0, 0, 0, 0}, {-0.28, 0.09, 5e-4, -7e-4}, {0.3, -0.2, -2e-3, 1e-3}}, 1.3}},
      {"brown5", {{{-0.28, 0.09, 5e-4, -7e-4, 0.01}, {-0.4, 0.2, 2e-3, -1e-3, -0.06}}, 1.3}},
      {"rational8",
       {{{0, 0, 0, 0, 0, 0, 0, 0},
         {-0.28, 0.09, 5e-4, -7e-4, 0.01, 0.02, -0.03, 0.02},
         {0.3, -0.1, -2e-3, 1e-3, 0.02, 0.58, -0.05, 0.01}},
        1.3}},
      {"thinprism12",
       {{{0, 0, 0, 0, 0, 0, 0, 0, 2e-3, -4e-4, -1e-3, 3e-4},
         {0.3, -0.1, -2e-3, 1e-3, 0.02, 0.58, -0.05, 0.01, -3e-3, 5e-4, 4e-3, -6e-4}},
        1.3}},
      {"tilted14",
       {{{-0.28, 0.09, 5e-4, -7e-4, 0.01, 0, 0, 0, 0, 0, 0, 0, 0.12, 0},
         {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, -0.08},
         {0.3, -0.1, -2e-3, 1e-3, 0.02, 0.58, -0.05, 0.01, -3e-3, 5e-4, 4e-3, -6e-4, 0.1, 0.07}},
        1.3}},
      {"fisheye",
       {{{0, 0, 0, 0}, {-0.02, 0.005, -0.003, 0.0005}, {0.036, -0.042, 0.016, -0.0021}}, 2.6}},
      {"ucm", {{{0.3}, {0.5}, {0.63}}, 1.95}},
      {"eucm", {{{0.3, 1.2}, {0.5, 0.8}, {0.63, 1.1}}, 1.9}},
      {"doublesphere", {{{0, 0.5}, {-0.2, 0.6}, {0.3, 0.4}, {-0.27, 0.57}}, 2.1}},
  };
  const LensTraits& traits = *find_lens(model);
  const auto it = samples.find(traits.model);
  return it != samples.end() ? it->second
                             : samples.emplace(traits.model, typical(traits)).first->second;
}

}  // namespace calvin::samples
