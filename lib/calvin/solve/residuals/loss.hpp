// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Loss functions: how much a corner that is far off may pull. Internal.
#pragma once

#include <cmath>

namespace calvin {

// The cost of a corner as a function of its weighted distance from its projection, px.
struct Loss {
  enum class Kind { kSquare, kHuber, kCauchy };
  Kind kind = Kind::kSquare;
  double scale = 1;  // px, where the cost leaves the parabola

  struct Value {
    double cost;    // px^2
    double weight;  // d cost / d (distance^2)
  };
  [[nodiscard]] Value operator()(double squared) const {
    const double c2 = scale * scale;
    switch (kind) {
      case Kind::kHuber:
        if (squared > c2) {
          const double distance = std::sqrt(squared);
          return {2 * scale * distance - c2, scale / distance};
        }
        break;
      case Kind::kCauchy:
        return {c2 * std::log1p(squared / c2), c2 / (c2 + squared)};
      case Kind::kSquare:
        break;
    }
    return {squared, 1};
  }
};

}  // namespace calvin
