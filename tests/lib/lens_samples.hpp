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
      {"fisheye",
       {{{0, 0, 0, 0}, {-0.02, 0.005, -0.003, 0.0005}, {0.036, -0.042, 0.016, -0.0021}}, 2.6}},
  };
  return kSamples.at(model);
}

}  // namespace calvin::samples
