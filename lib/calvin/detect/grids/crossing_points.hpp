// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Places where two lines cross.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/image.hpp"
#include "calvin/detect/circles/ellipse.hpp"

namespace calvin::detect {

// A place that is as dark as a line, with four dark places in opposite pairs on the ring around it.
struct CrossingPoint {
  double x = 0;  // px
  double y = 0;
  Eigen::Vector2d along;  // unit vectors, the directions of the lines
  Eigen::Vector2d down;
  float inside = 0;   // grey levels, of the lines
  float outside = 0;  // and between them
};

// In an image of step 1; of lines that are at most some 4 px wide and 12 px apart at the least. The
// `most` darkest ones; `light`: the lightest ones, of light lines.
[[nodiscard]] std::vector<CrossingPoint> find_crossings(const ImageView& image, bool light,
                                                        std::size_t most);

// Crossings that have others before or behind them on both lines, as ellipses: those of circles on
// the grid with a quarter of the distance from one line to the next as radius.
[[nodiscard]] std::vector<Ellipse> circles_about(const std::vector<CrossingPoint>& crossings);

}  // namespace calvin::detect
