// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A look at four squares, a fit that knows the edges of its neighbours, and tests of it.

#include "calvin/detect/checkerboard/fits/guesses.hpp"

#include <algorithm>
#include <cmath>

#include "calvin/detect/checkerboard/corners/fit_radius.hpp"
#include "calvin/detect/checkerboard/corners/grey_at.hpp"
#include "calvin/detect/checkerboard/fits/node_fit.hpp"

namespace calvin::detect {

namespace {

// Whether all four squares of a corner are in view `away` px from it, or as far as the border of
// the image lets one look. A fit whose window is cut off there takes three of them for four.
bool shows_four_squares(const ImageView& image, const SaddleFit& fit, float away) {
  constexpr float kLeastSight = 2.5F;   // px, to the border; of a sharp corner
  constexpr float kSharpSight = 1;      // px, and
  constexpr float kSharpWidths = 2.5F;  // widths
  constexpr float kClearly = 0.3F;      // of what the fit lets expect
  const auto u = static_cast<float>(fit.x);
  const auto v = static_cast<float>(fit.y);
  const float border = std::min(std::min(u, v), std::min(static_cast<float>(image.width - 1) - u,
                                                         static_cast<float>(image.height - 1) - v));
  const float width = std::max(fit.along_width, fit.down_width);
  if (border < std::min(kLeastSight, kSharpSight + kSharpWidths * width)) return false;
  const float sight = std::min(border, away);
  for (const float a : {-1.0F, 1.0F}) {
    for (const float b : {-1.0F, 1.0F}) {
      Direction way = {a * fit.along.x + b * fit.down.x, a * fit.along.y + b * fit.down.y};
      const float length = std::hypot(way.x, way.y);
      way = {sight * way.x / length, sight * way.y / length};
      const auto grey = grey_at(image, u + way.x, v + way.y);
      if (!grey) return false;
      constexpr float kRoot = 0.70710678F;
      const float expected = std::erf(kRoot * std::abs(cross(fit.along, way)) / fit.along_width) *
                             std::erf(kRoot * std::abs(cross(fit.down, way)) / fit.down_width);
      const float sign = fit.contrast > 0 ? a * b : -a * b;
      if (sign * (*grey - fit.middle()) < kClearly * expected * fit.swing()) return false;
    }
  }
  return true;
}

// Whether a place may be near a corner of these colours, by the squares around it: most guesses are
// none, and a fit takes far longer to tell.
bool may_be_corner(const ImageView& image, const Node& node, bool even, float away) {
  constexpr float kLeast = 0.08F;  // of the contrast, a sixth of what it is at a corner
  float saddle = 0;  // how much brighter the squares between +along and +down are, grey levels
  for (const float a : {-1.0F, 1.0F}) {
    for (const float b : {-1.0F, 1.0F}) {
      const auto grey = grey_at(image, node.x + away * (a * node.along.x + b * node.down.x),
                                node.y + away * (a * node.along.y + b * node.down.y));
      if (!grey) return true;
      saddle += 0.25F * a * b * *grey;
    }
  }
  return (even ? saddle : -saddle) > kLeast * node.contrast;
}

// Whether the ring around a fit that is too noisy for a corner says that it is one all the same.
bool has_ring(const ImageView& image, const SaddleFit& fit, float spacing) {
  constexpr float kMostAsymmetry = 0.8F;
  constexpr float kSmall = 9;  // px, of squares in which the larger ring meets the next edges
  const int x = static_cast<int>(std::lround(fit.x));
  const int y = static_cast<int>(std::lround(fit.y));
  const bool has_room = x >= kRingReach && y >= kRingReach && x < image.width - kRingReach &&
                        y < image.height - kRingReach;
  Corner corner;
  const RingSize size = spacing < kSmall ? RingSize::kSmall : RingSize::kLarge;
  return !has_room || check_ring(image, x, y, size, kMostAsymmetry, corner);
}

}  // namespace

bool confirm_guess(const ImageView& image, const Lattice& lattice, Cell c, Node& node) {
  constexpr float kContrast = 0.35F;  // of a neighbour's
  constexpr float kResidual = 0.35F;  // of the contrast
  constexpr float kNoise = 0.1F;      // of the contrast: symmetric, whatever the ring says
  constexpr float kFar = 0.3F;        // of the spacing, from where it is expected
  constexpr float kFarther = 0.45F;   // of a good one: no other corner of its colours is so near
  constexpr float kGood = 0.1F;       // of the contrast
  constexpr float kAway = 0.35F;      // of the spacing
  constexpr float kOfAside = 0.6F;
  const float spacing = spacing_at(lattice, c);
  // The middle between what is printed in a square and the corner, where anything is.
  const float away = std::min(kAway, kOfAside * lattice.surroundings().aside) * spacing;
  if (!may_be_corner(image, node, Lattice::is_even(c), away)) return false;
  const float clear = clear_at(lattice, c);
  float radius = std::clamp(kShare * clear, kLeastRadius, kLastRadius);
  const float closest = closest_radius(clear);
  // A finger next to the corner is not in a smaller window.
  for (bool again = false; !again || radius >= closest; again = true, radius *= kSmaller) {
    SaddleFit f = fit_of(node);
    f.along_width = f.down_width = std::max(2.0F, node.width);
    f.room = room_at(lattice, c);
    if (!fit_saddle(image, radius, 10, f)) return false;
    if (f.residual > kOfNoise * f.noise) fit_parted(image, radius, 10, f);
    const bool is_good = f.residual < kGood * f.swing() && f.noise < kGood * f.swing();
    if (!colours_fit(f, c) || 2 * f.swing() < kContrast * node.contrast ||
        distance(f, node) > (is_good ? kFarther : kFar) * spacing) {
      return false;
    }
    if (f.residual > kResidual * f.swing() || !shows_four_squares(image, f, away) ||
        (is_noisy(f, kNoise) && !has_ring(image, f, spacing))) {
      continue;
    }
    take(f, node);
    node.guessed = false;
    return true;
  }
  return false;
}

void confirm_guesses(const ImageView& image, Lattice& lattice) {
  constexpr float kPrune = 0.5F;  // of the spacing
  bool any = false;
  lattice.for_each([&](Cell c, const Node& node) {
    if (!node.guessed) return;
    any = true;
    if (!confirm_guess(image, lattice, c, lattice.at(c))) lattice.refuse(c);
  });
  if (any) lattice.prune(kPrune);
}

}  // namespace calvin::detect
