// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Corners that a lattice has not: those that were lost in the first fits, and those at the ends of
// its lines.

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "calvin/detect/checkerboard/fits/node_fit.hpp"
#include "calvin/detect/checkerboard/fits/refine.hpp"

namespace calvin::detect {

namespace {

// Where the place is expected, noise has no places to choose from, and 30 pixels tell a contrast to
// a fifth of their noise.
constexpr float kMostResidualInNoise = 1.25F;  // of the contrast
constexpr float kLargestError = 0.2F;          // of the spacing, from where neighbours predict it
// How well others tell the place of a corner that was lost in noise, at best.
constexpr float kExpectedPlace = 0.04F;  // of the spacing, 1 sigma

}  // namespace

// The fit of a node that lies where others let it be expected, in noise to `sigma` px; one of its
// neighbours was fitted as `near`.
SaddleFit Refinement::lost_fit(const ImageView& image, const Lattice& lattice, Cell c,
                               const SaddleFit& near, float sigma) {
  if (!in_noise_) {
    SaddleFit f = quick_fit(image, lattice, c, kFirstRadius, fit_of(lattice.at(c)), 8);
    if (!std::isfinite(f.noise)) return f;
    f.along_bend = near.along_bend;
    f.down_bend = near.down_bend;
    fit(c) = f;
    return last_fit(image, lattice, c);
  }
  fit(c) = near;
  return expected_fit(image, lattice, c, sigma);
}

std::vector<Refinement::Lost> Refinement::lost_corners(const Lattice& lattice,
                                                       std::span<const Cell> board) {
  std::vector<Cell> cells;
  for (const Cell c : cells_) {
    if (!lattice.has(c)) cells.push_back(c);
  }
  const std::size_t seen = cells.size();
  for (const Cell c : board) {
    const bool is_new = std::ranges::find(cells, c) == cells.end();
    if (in_noise_ && fits_.has(c) && !lattice.has(c) && is_new) cells.push_back(c);
  }
  const auto surface = in_noise_ ? expect_places(lattice, fits_, cells) : ExpectedPlaces{};
  std::vector<Lost> lost;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    lost.push_back({cells[i], i < seen, in_noise_ ? surface.places[i] : Pixel{}, surface.sigma});
  }
  return lost;
}

// Whether what was fitted where a corner was lost is one. Where nearly all of a board is there, and
// all in noise, a corner is like the others: noise of the same size hides it, and nothing covers
// it.
bool Refinement::is_recovered(const SaddleFit& f, const Lost& lost, const Node& node,
                              float usual_residual) const {
  constexpr float kClear = 0.35F;  // of the contrast: what would cover a corner leaves more
  constexpr float kLouder = 2;     // of the median residual, of a clear one
  const float contrast = f.swing();
  const bool is_clear = f.residual <= kClear * contrast;
  const bool is_alike = f.residual <= (is_clear ? kLouder : kNoisy) * usual_residual;
  const bool is_quiet = lost.seen && !is_noisy(f, most_noise());
  const float most_residual = in_noise_ ? kMostResidualInNoise : kMostResidual;
  return std::isfinite(f.noise) && (is_quiet || is_alike) &&
         contrast >= kLeastSwingShare * node.contrast / 2 && f.residual <= most_residual * contrast;
}

void Refinement::recover(const ImageView& image, Lattice& lattice, const Lost& lost,
                         float usual_residual) {
  const Cell c = lost.cell;
  const auto expected = lattice.expect(c);
  const auto step =
      std::find_if(kAround.begin(), kAround.end(), [&](Cell s) { return lattice.has(c + s); });
  if (!expected || step == kAround.end()) return;
  Node node = lattice.at(c + *step);
  node.x = in_noise_ ? static_cast<float>(lost.place.u) : expected->x;
  node.y = in_noise_ ? static_cast<float>(lost.place.v) : expected->y;
  lattice.put(c, node);
  const float sigma = std::max(lost.sigma, kExpectedPlace * expected->spacing);
  const SaddleFit f = lost_fit(image, lattice, c, at(c + *step), sigma);
  if (is_recovered(f, lost, node, usual_residual) &&
      distance(f, node) < kLargestError * expected->spacing) {
    fit(c) = f;
    take(f, lattice.at(c));
  } else {
    lattice.remove(c);
  }
}

void Refinement::recover_lost(const ImageView& image, Lattice& lattice,
                              std::span<const Cell> board) {
  const std::vector<Lost> lost = lost_corners(lattice, board);
  const int before = lattice.count();
  const bool is_one_board = in_noise_ && !board.empty();
  const float usual =
      is_one_board ? fits_.median(lattice, [](const SaddleFit& f) { return f.residual; }) : 0;
  // A corner that was found lets the next ones be expected.
  int last = 0;
  do {
    last = lattice.count();
    for (const Lost& l : lost) {
      if (!lattice.has(l.cell)) recover(image, lattice, l, usual);
    }
  } while (in_noise_ && lattice.count() > last);
  if (lattice.count() == before) return;
  drop_uncertain(lattice);
  stray_corners_.remove_from(lattice, slack(lattice), image_center(image.size()));
}

bool Refinement::add(const ImageView& image, const Lattice& lattice, Cell c, Cell near) {
  constexpr float kNoisiestAdded = 3;     // of the median
  constexpr float kLeastOfAdded = 0.05F;  // of the contrast: without noise the median is none
  fits_.include(c);
  const SaddleFit& beside = at(near);
  SaddleFit f = quick_fit(image, lattice, c, kFirstRadius, fit_of(lattice.at(c)), 8);
  if (!std::isfinite(f.noise)) return false;
  f.along_bend = beside.along_bend;
  f.down_bend = beside.down_bend;
  f.slope = beside.slope;
  f.contrast_slope = beside.contrast_slope;
  fit(c) = f;
  fit(c) = last_fit(image, lattice, c);
  return !is_noisy(at(c), std::max(kNoisiestAdded * usual_noise_, kLeastOfAdded));
}

bool Refinement::refine_added(const ImageView& image, std::span<const Cell> added,
                              Lattice& lattice) {
  const FitGrid fits_before = fits_;
  const Lattice before = lattice;
  set_bends(lattice, fits_);
  set_slopes(lattice, fits_);
  refit(lattice, [&](Cell c) { return last_fit(image, lattice, c); });
  std::ignore = correct_bends_in(image, lattice);
  drop_uncertain(lattice);
  stray_corners_.remove_from(lattice, slack(lattice), image_center(image.size()));
  const auto failed = std::ranges::count_if(added, [&](Cell c) { return !lattice.has(c); });
  if (lattice.count() + failed == before.count()) return true;
  fits_ = fits_before;
  lattice = before;
  return false;
}

}  // namespace calvin::detect
