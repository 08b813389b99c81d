// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Candidates by their saddles, in the picture and in smaller ones of it where edges are wide; each
// is fitted in windows that grow as long as nothing else is in them.

#include "calvin/detect/nearest/nearest_corner.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "calvin/detect/checkerboard/corners/corner.hpp"
#include "calvin/detect/checkerboard/corners/fit_radius.hpp"
#include "calvin/detect/checkerboard/corners/saddle_fit.hpp"
#include "calvin/detect/checkerboard/corners/saddle_points.hpp"
#include "calvin/detect/pyramid.hpp"

namespace calvin {

namespace {

using detect::Pyramid;
using detect::RingSize;
using detect::SaddleFit;

constexpr int kLevels = 3;     // of the pyramid: edges may be as wide as 4 px
constexpr double kEdge = 1.3;  // px, width of the edges of a level, 1 sigma

// A fit of edges that are known roughly begins there, in px of the part.
SaddleFit start_of(const detect::Corner& corner, int level) {
  SaddleFit fit;
  fit.x = static_cast<double>(Pyramid::to_image(corner.x, level));
  fit.y = static_cast<double>(Pyramid::to_image(corner.y, level));
  fit.along = corner.rising;
  fit.down = corner.falling;
  fit.along_width = fit.down_width = static_cast<float>(kEdge * (1 << level));
  return fit;
}

// Whether what was fitted is a corner, and not what two leaves of a tree make of the sky.
bool is_corner(const SaddleFit& fit) {
  constexpr float kLeastSwing = 6;       // grey levels
  constexpr float kMostNoise = 0.25F;    // of the contrast
  constexpr float kMostResidual = 0.5F;  // likewise
  constexpr float kMostSigma = 0.5F;     // px
  return fit.swing() >= kLeastSwing && fit.noise <= kMostNoise * fit.swing() &&
         fit.residual <= kMostResidual * fit.swing() && fit.sigma > 0 && fit.sigma <= kMostSigma;
}

// The fit in the largest window that nothing else is in: one with a next edge, or a finger, in it
// fits worse. Absent where no window has a corner.
std::optional<SaddleFit> best_fit(const ImageView& image, const SaddleFit& start) {
  constexpr float kGrowth = 1.35F;
  constexpr float kWorse = 1.3F;     // of the residual in the smallest window, and a grey level
  constexpr float kGreyLevel = 1;    // grey levels
  constexpr float kMostMove = 0.6F;  // of the radius, from where the search began
  std::optional<SaddleFit> best;
  float least = 0;
  for (float radius = 1.6F * std::max(detect::kLeastRadius, 2 * start.along_width);
       radius <= std::max(detect::kLastRadius, 8 * start.along_width); radius *= kGrowth) {
    SaddleFit fit = best.value_or(start);
    if (!detect::fit_saddle(image, radius, 12, fit) || !is_corner(fit) ||
        std::hypot(fit.x - start.x, fit.y - start.y) > static_cast<double>(kMostMove * radius)) {
      if (best) break;
      continue;
    }
    if (best && fit.residual > kWorse * least + kGreyLevel) break;
    if (!best) least = fit.residual;
    best = fit;
  }
  return best;
}

// The places of a level where four squares may meet, those nearest to `near` (px of the part)
// first.
std::vector<SaddleFit> candidates(const ImageView& image, int level, Pixel near, double reach) {
  constexpr std::uint8_t kResponse = 5;  // grey levels
  constexpr std::size_t kMost = 60;
  constexpr float kAsymmetry = 0.55F;  // as of any corner of a board
  std::vector<SaddleFit> found;
  detect::SaddleSearch search;
  for (const RingSize ring : {RingSize::kSmall, RingSize::kLarge}) {
    for (const detect::SaddlePoint& p : search.find(image, ring, kResponse, kMost)) {
      detect::Corner corner;
      corner.x = static_cast<float>(p.x);
      corner.y = static_cast<float>(p.y);
      if (!detect::check_ring(image, p.x, p.y, ring, kAsymmetry, corner)) continue;
      found.push_back(start_of(corner, level));
    }
  }
  const auto distance = [near](const SaddleFit& fit) {
    return std::hypot(fit.x - near.u, fit.y - near.v);
  };
  // A peak lies within a pixel of its level from its corner.
  const double slack = 2.0 * (1 << level);
  std::erase_if(found, [&](const SaddleFit& fit) { return distance(fit) > reach + slack; });
  std::ranges::sort(found, {}, distance);
  return found;
}

std::optional<FoundPoint> corner_in(const ImagePart& part, Pixel near, double reach) {
  Pyramid pyramid;
  pyramid.build(part.image.view(), kLevels,
                {2 * detect::kRingReach + 2, 2 * detect::kRingReach + 2});
  const Pixel there = {near.u - part.x, near.v - part.y};
  for (int level = 0; level < pyramid.levels(); ++level) {
    std::optional<FoundPoint> nearest;
    double least = reach;
    for (const SaddleFit& start : candidates(pyramid.level(level), level, there, reach)) {
      const auto fit = best_fit(part.image.view(), start);
      if (!fit) continue;
      const double distance = std::hypot(fit->x - there.u, fit->y - there.v);
      if (distance > least) continue;
      least = distance;
      nearest = {{fit->x + part.x, fit->y + part.y}, static_cast<double>(fit->sigma)};
    }
    if (nearest) return nearest;
  }
  return std::nullopt;
}

}  // namespace

std::optional<FoundPoint> nearest_corner(const ImagePart& part, Pixel near, double reach) {
  return part.image.pixels.empty() ? std::nullopt : corner_in(part, near, reach);
}

}  // namespace calvin
