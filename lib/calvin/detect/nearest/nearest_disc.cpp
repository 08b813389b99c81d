// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Candidates by their shapes in the picture and in smaller ones of it, each fitted and looked at.

#include "calvin/detect/nearest/nearest_disc.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "calvin/detect/circles/blob_shape.hpp"
#include "calvin/detect/circles/disc_fit.hpp"
#include "calvin/detect/circles/disc_search.hpp"
#include "calvin/detect/pyramid.hpp"

namespace calvin {

namespace {

using detect::DiscFit;
using detect::Ellipse;
using detect::Pyramid;

double distance(const Ellipse& e, Pixel from) { return std::hypot(e.x - from.u, e.y - from.v); }

// The discs of one kind whose centres may be within reach of a pixel of the part.
std::vector<Ellipse> candidates(Pyramid& pyramid, bool light, Pixel near, double reach) {
  constexpr std::size_t kMost = 60;  // of a level
  detect::DiscSearch search(kMost);
  std::vector<Ellipse> discs;
  for (int level = 0; level < pyramid.levels(); ++level) search.add(pyramid, level, light, discs);
  std::erase_if(discs, [&](const Ellipse& e) { return distance(e, near) > reach + 2; });
  return discs;
}

// Whether what was fitted is a disc, and not a square or a stain.
bool is_disc(const ImageView& image, const DiscFit& fit) {
  constexpr float kLeastContrast = 10;    // grey levels
  constexpr double kMostResidual = 0.12;  // of the contrast
  constexpr double kMostSigma = 0.5;      // px
  constexpr double kMostSquare = 0.09;    // of the radius
  constexpr double kLongest = 4;          // times the width: a circle from 75 degrees aside
  const Ellipse& e = fit.ellipse;
  const float contrast = std::abs(e.outside - e.inside);
  return contrast >= kLeastContrast &&
         fit.residual <= kMostResidual * static_cast<double>(contrast) && fit.sigma > 0 &&
         fit.sigma <= kMostSigma &&
         e.longest_square() <= kLongest * kLongest * e.shortest_square() &&
         detect::rim_squareness(image, e).value_or(0) <= kMostSquare;
}

std::optional<DiscFit> fitted(const ImageView& image, const Ellipse& start) {
  constexpr int kSteps = 12;
  constexpr double kOff = 0.7;         // px, of a rim that was looked for
  constexpr double kMostMove = 0.5;    // of the radius
  constexpr double kMostLarger = 1.8;  // of the radius
  DiscFit fit;
  fit.ellipse = start;
  if (const auto closer = detect::closer_ellipse(image, start)) {
    fit.ellipse = *closer;
    fit.off = kOff;
  }
  if (!detect::fit_disc(image, kSteps, fit)) return std::nullopt;
  const double larger = fit.ellipse.radius() / start.radius();
  if (distance(fit.ellipse, {start.x, start.y}) > kMostMove * start.radius() ||
      larger > kMostLarger || larger < 1 / kMostLarger ||
      fit.ellipse.is_light() != start.is_light() || !is_disc(image, fit)) {
    return std::nullopt;
  }
  return fit;
}

// px, 1 sigma per coordinate: how far a circle's centre may be from that of its ellipse, which at a
// tilt t is radius^2 sin t cos t / focal length; for a lens of 50 degrees, at tilts up to 60.
double centre_bias_of(const Ellipse& e, int width) {
  constexpr double kTilts = 0.25;  // RMS of sin t cos t, over the square root of 2
  return kTilts * e.longest_square() / std::max(width, 1);
}

}  // namespace

std::optional<FoundPoint> nearest_disc(const ImagePart& part, Pixel near, double reach) {
  if (part.image.pixels.empty()) return std::nullopt;
  const ImageView image = part.image.view();
  const Pixel there = {near.u - part.x, near.v - part.y};
  Pyramid pyramid;
  pyramid.build(image, Pyramid::kMaxLevels, {4 * detect::kBlobReach, 4 * detect::kBlobReach});
  std::optional<FoundPoint> nearest;
  double least = reach;
  for (const bool light : {false, true}) {
    for (const Ellipse& start : candidates(pyramid, light, there, reach)) {
      const auto fit = fitted(image, start);
      if (!fit) continue;
      const double away = distance(fit->ellipse, there);
      if (away > least) continue;
      least = away;
      nearest = {{fit->ellipse.x + part.x, fit->ellipse.y + part.y},
                 std::hypot(fit->sigma, centre_bias_of(fit->ellipse, part.whole_width)),
                 FoundPoint::Kind::kDisc};
    }
  }
  return nearest;
}

}  // namespace calvin
