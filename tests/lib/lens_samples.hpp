// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Coefficients to try every lens with: none, mild, strong, and everything at once.
#pragma once

#include <map>
#include <string_view>
#include <vector>

namespace calvin::samples {

struct Samples {
  std::vector<std::vector<double>> coefficients;
  double widest;  // angle from the axis at which all of them have a value, rad
};

inline const Samples& lens(std::string_view model) {
  static const std::map<std::string_view, Samples> kSamples = {
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
  return kSamples.at(model);
}

}  // namespace calvin::samples
