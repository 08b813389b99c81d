// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Beginnings, windows and tests of the fits of nodes.

#include "calvin/detect/checkerboard/node_fit.hpp"

#include <algorithm>
#include <cmath>

namespace calvin::detect {

float spacing_at(const Lattice& lattice, Cell c) {
  const Node& node = lattice.at(c);
  float least = 1e6F;
  for (const Cell step : kAround) {
    if (!lattice.has(c + step)) continue;
    const Node& next = lattice.at(c + step);
    // The distance from the edge that crosses the way to the next node.
    const Direction edge = step.row == 0 ? node.down : node.along;
    least = std::min(least, std::abs(cross(edge, {next.x - node.x, next.y - node.y})));
  }
  return least;
}

float closest_radius(float spacing) {
  constexpr float kClosest = 0.3F;        // of the spacing
  constexpr float kClosestRadius = 2.2F;  // px
  return std::clamp(kClosest * spacing, kClosestRadius, kCloseRadius);
}

SaddleFit fit_of(const Node& node) {
  SaddleFit fit;
  fit.x = static_cast<double>(node.x);
  fit.y = static_cast<double>(node.y);
  fit.along = node.along;
  fit.down = node.down;
  fit.along_width = fit.down_width = node.width;
  return fit;
}

SaddleFit parted_fit(SaddleFit fit) {
  constexpr float kPartedWidth = 2;  // px, from which the steps find the gap
  fit.contrast = 0;
  fit.along_width = fit.down_width = kPartedWidth;
  fit.has_gain = true;
  return fit;
}

void fit_parted(const ImageView& image, float radius, int steps, SaddleFit& fit) {
  constexpr float kOfSwing = 0.06F;   // the residual that no noise explains
  constexpr float kLeastGain = 0.1F;  // px: with less, one unknown more only hides other errors
  if (fit.has_gain || fit.residual < kOfSwing * fit.swing()) return;
  SaddleFit parted = parted_fit(fit);
  if (fit_saddle(image, radius, 2 * steps, parted, kRoughly) && parted.residual < fit.residual &&
      parted.noise < kOfNoise * fit.noise && std::abs(parted.gain) > kLeastGain) {
    fit = parted;
  }
}

bool is_noisy(const SaddleFit& fit, float most) {
  constexpr float kMore = 1.5F;  // of what is told by all residuals, not by opposite pixels
  return !(fit.noise <= (fit.at_border ? kMore : 1) * most * fit.swing());
}

bool colours_fit(const SaddleFit& fit, Cell c) { return (fit.contrast > 0) == Lattice::is_even(c); }

float distance(const SaddleFit& fit, const Node& node) {
  return std::hypot(static_cast<float>(fit.x) - node.x, static_cast<float>(fit.y) - node.y);
}

void take(const SaddleFit& fit, Node& node) {
  node.x = static_cast<float>(fit.x);
  node.y = static_cast<float>(fit.y);
  node.along = fit.along;
  node.down = fit.down;
  node.contrast = 2 * fit.swing();
  node.width = std::max(fit.along_width, fit.down_width);
  node.sigma = fit.sigma;
}

}  // namespace calvin::detect
