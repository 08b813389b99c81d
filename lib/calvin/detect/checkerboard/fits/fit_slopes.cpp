// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Polynomial surfaces through the fits of a board: the fall of light, and where corners are
// expected.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "calvin/detect/checkerboard/fits/fit_grid.hpp"
#include "calvin/detect/checkerboard/fits/lattice_surface.hpp"

namespace calvin::detect {

void set_slopes(const Lattice& lattice, FitGrid& fits) {
  // Where more pixels than this are cut off at white or black, level and contrast are too
  // uncertain.
  constexpr float kMostCut = 0.05F;  // share of the window's pixels
  if (fits.median(lattice, [](const SaddleFit& f) { return f.cut; }) > kMostCut) return;
  const auto surface_of = [&](auto number) {
    std::vector<PlacedValue> values;
    lattice.for_each([&](Cell c, const Node& /*node*/) {
      values.push_back({lattice.place(c), static_cast<double>(number(fits.at(c))), 1});
    });
    return surface_over<2>(lattice, values, 0);
  };
  const auto level = surface_of([](const SaddleFit& f) { return f.level; });
  const auto contrast = surface_of([](const SaddleFit& f) { return std::abs(f.contrast); });
  lattice.for_each([&](Cell c, const Node& /*node*/) {
    SaddleFit& f = fits.at(c);
    // The mean steps of a column and of a row, px, turn changes per step into a gradient per px.
    Direction step[2];
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const Cell ahead = lattice.has(c + kAround[axis]) ? c + kAround[axis] : c;
      const Cell behind = lattice.has(c - kAround[axis]) ? c - kAround[axis] : c;
      const LatticePlace from = lattice.place(behind);
      const LatticePlace to = lattice.place(ahead);
      const double steps = to.col - from.col + to.row - from.row;
      if (steps == 0) return;
      step[axis] = {static_cast<float>((fits.at(ahead).x - fits.at(behind).x) / steps),
                    static_cast<float>((fits.at(ahead).y - fits.at(behind).y) / steps)};
    }
    const float area = cross(step[0], step[1]);
    if (!(std::abs(area) > 1)) return;
    const auto gradient = [&](const Surface<2>& surface) {
      const LatticePlace at = lattice.place(c);
      const auto change = [&](Cell way) {
        return static_cast<float>(0.5 *
                                  (surface.at(moved(at, way, 1)) - surface.at(moved(at, way, -1))));
      };
      const float along = change({1, 0});
      const float down = change({0, 1});
      return Direction{(along * step[1].y - down * step[0].y) / area,
                       (down * step[0].x - along * step[1].x) / area};
    };
    f.slope = gradient(level);
    f.contrast_slope = gradient(contrast);
    if (f.contrast < 0) f.contrast_slope = -f.contrast_slope;
  });
}

ExpectedPlaces expect_places(const Lattice& lattice, FitGrid& fits, std::span<const Cell> cells) {
  const auto usual =
      static_cast<double>(fits.median(lattice, [](const SaddleFit& f) { return f.sigma; }));
  const auto surface_of = [&](auto number) {
    std::vector<PlacedValue> values;
    lattice.for_each([&](Cell c, const Node&) {
      const SaddleFit& f = fits.at(c);
      const auto sigma = static_cast<double>(f.sigma);
      values.push_back({lattice.place(c), number(f), usual * usual / (sigma * sigma)});
    });
    return surface_over<3>(lattice, values, usual * usual);
  };
  const auto x = surface_of([](const SaddleFit& f) { return f.x; });
  const auto y = surface_of([](const SaddleFit& f) { return f.y; });
  ExpectedPlaces expected;
  for (const Cell c : cells) {
    const LatticePlace at = lattice.place(c);
    expected.places.push_back({x.at(at), y.at(at)});
  }
  expected.sigma = static_cast<float>(std::sqrt(0.5 * (x.variance() + y.variance())));
  return expected;
}

}  // namespace calvin::detect
