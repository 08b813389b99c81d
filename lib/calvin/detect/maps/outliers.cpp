// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Maps of all points, then of those that the last one explained.

#include "calvin/detect/maps/outliers.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "calvin/detect/maps/lens_map.hpp"
#include "calvin/geometry/median.hpp"

namespace calvin::detect {

namespace {

// How far the image of a place is from a point, of the distance to the image of the next place.
double off_of_spacing(const LensMap& lens, const Pixel& place, const Pixel& at) {
  const Pixel here = lens.image_of(place);
  const auto distance = [&](const Pixel& p) { return std::hypot(p.u - here.u, p.v - here.v); };
  const double spacing = std::min(distance(lens.image_of({place.u + 1, place.v})),
                                  distance(lens.image_of({place.u, place.v + 1})));
  return distance(at) / spacing;
}

// The map of some of the points.
std::optional<LensMap> map_of(std::span<const Pixel> plane, std::span<const Pixel> image,
                              const std::vector<std::size_t>& some, const Pixel& middle) {
  std::vector<Pixel> from;
  std::vector<Pixel> to;
  for (const std::size_t i : some) {
    from.push_back(plane[i]);
    to.push_back(image[i]);
  }
  return LensMap::fit(from, to, middle, 0, 0);
}

}  // namespace

std::vector<std::size_t> grid_outliers(std::span<const Pixel> plane, std::span<const Pixel> image,
                                       const Pixel& middle, double most) {
  constexpr int kRounds = 8;
  constexpr double kMedians = 3;      // a map of all is off where some are out of place
  constexpr double kFarMedians = 10;  // in the map of the others
  constexpr std::size_t kFewest = 9;  // points that tell a map
  std::vector<std::size_t> kept(plane.size());
  std::iota(kept.begin(), kept.end(), std::size_t{0});
  std::vector<std::size_t> out;
  for (int round = 0; round < kRounds && kept.size() >= kFewest; ++round) {
    const auto lens = map_of(plane, image, kept, middle);
    if (!lens) return {};
    std::vector<double> off(plane.size());
    for (std::size_t i = 0; i < off.size(); ++i) {
      off[i] = off_of_spacing(*lens, plane[i], image[i]);
    }
    const double usual = median_of(off);
    const double trimmed = std::clamp(kMedians * usual, most / 3, most);
    const double far = std::clamp(kFarMedians * usual, most / 2, most);
    const std::vector<std::size_t> before = std::exchange(kept, {});
    out.clear();
    for (std::size_t i = 0; i < off.size(); ++i) {
      if (off[i] <= trimmed) kept.push_back(i);
      if (!(off[i] <= far)) out.push_back(i);
    }
    if (kept == before) break;
  }
  return out;
}

}  // namespace calvin::detect
