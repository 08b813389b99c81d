// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Compares what three distances leave of the corners.

#include "calvin/detect/tags/search/tag_spacing.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "calvin/detect/maps/lens_map.hpp"

namespace calvin::detect {

namespace {

// px, how far corners are from where a lens and a pitch would have them.
std::optional<double> misfit_of(ImageSize size, std::span<const TagCorner> corners, double pitch) {
  std::vector<Pixel> plane;
  std::vector<Pixel> seen;
  for (const TagCorner& c : corners) {
    plane.push_back({pitch * c.tag.col + c.right, pitch * c.tag.row + c.below});
    seen.push_back(c.at);
  }
  const auto map = LensMap::fit(plane, seen, image_center(size));
  return map ? std::optional(map->misfit()) : std::nullopt;
}

}  // namespace

double fit_pitch(ImageSize size, std::span<const TagCorner> corners, double guess) {
  constexpr double kStep = 0.04;
  const auto before = misfit_of(size, corners, guess - kStep);
  const auto at = misfit_of(size, corners, guess);
  const auto after = misfit_of(size, corners, guess + kStep);
  if (!before || !at || !after) return guess;
  // Squares of misfits are a parabola.
  const auto square = [](double x) { return x * x; };
  const double bend = square(*before) - 2 * square(*at) + square(*after);
  const double moved = 0.5 * (square(*before) - square(*after)) / bend;
  constexpr double kFarthest = 2;  // steps, as far as it is one
  return bend > 0 ? guess + kStep * std::clamp(moved, -kFarthest, kFarthest) : guess;
}

Gap gap_of(double pitch, double least) {
  constexpr double kUsual = 20;
  constexpr double kFinest = 100;
  constexpr double kNear = 0.012;
  if (least > 0 && pitch - 1 - least < kNear) return {least, true};
  const double usual = std::round((pitch - 1) * kUsual) / kUsual;
  if (usual > 0 && std::abs(pitch - 1 - usual) < kNear) return {usual, true};
  return {std::max(std::max(std::round((pitch - 1) * kFinest), 1.0) / kFinest, least), false};
}

AprilGrid with_seen_gaps(const AprilGrid& grid, const Observation& seen) {
  const Grid order = grid.grid();
  std::vector<TagCorner> corners;
  for (std::size_t i = 0; i < seen.ids.size(); ++i) {
    const GridPlace place = order.place(seen.ids[i]);
    corners.push_back({{place.col / 2, place.row / 2}, place.col % 2, place.row % 2, seen.uv[i]});
  }
  AprilGrid with_gaps = grid;
  with_gaps.spacing = gap_of(fit_pitch(seen.image_size, corners, 1 + grid.spacing), 0).share;
  return with_gaps;
}

}  // namespace calvin::detect
