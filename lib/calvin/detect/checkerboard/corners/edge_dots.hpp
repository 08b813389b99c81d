// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The dots on the edges around a corner of a PuzzleBoard, as a picture shows them: taken out of the
// pixels of a window, they leave the squares of a plain checkerboard.
#pragma once

#include <array>

#include "calvin/detect/checkerboard/corners/corner.hpp"

namespace calvin::detect {

struct Window;
struct SaddleFit;

// An ellipse about a point of an edge.
struct EdgeDot {
  bool light = false;
  bool on_along = false;  // it lies on the edge `along`, else on `down`
  Direction center;       // px, from the corner
  Direction along_edge;   // px, the half-axis along the edge
  Direction across;       // px, that across it
};

struct EdgeDots {
  int count = 0;
  std::array<EdgeDot, 4> all;
};

// Takes the dots of a fit out of a window's pixels, by the level, the contrast and the widths that
// the fit has; its corner is at (x, y) from the middle of the window.
void remove_dots(const SaddleFit& fit, float x, float y, Window& window) noexcept;

}  // namespace calvin::detect
