// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// First fits, fits with the bends of the board, and the removal of corners that fail the tests.

#include "calvin/detect/checkerboard/fits/refine.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "calvin/detect/checkerboard/corners/fit_radius.hpp"
#include "calvin/detect/checkerboard/fits/node_fit.hpp"

namespace calvin::detect {

namespace {

constexpr float kPrune = 0.3F;  // of the spacing
constexpr int kFewestToRefine = 4;
constexpr float kLevelRadius = 5;  // px, in a smaller level
constexpr int kLevelSteps = 6;     // likewise
// px, likewise, that fits begin with: a pixel of a level is .29 wide by itself.
constexpr float kLeastLevelWidth = 0.4F;
// A corner that a hand or a shadow covers in part is not symmetric, which shows as noise.
constexpr float kNoisiest = 3;  // of the median
// A fit this much less certain than the others has something else in its window.
constexpr float kUncertain = 20;             // of the median sigma
constexpr float kUncertainInNoise = 6;       // likewise, beside a fixed part
constexpr float kUncertainInNoisePx = 0.3F;  // px
constexpr float kWidestEdge = 8;             // px, of an edge

}  // namespace

void Refinement::begin(const Lattice& lattice) {
  fits_.reset(lattice.extent());
  cells_.clear();
  lattice.for_each([&](Cell c, const Node& node) {
    fit(c) = fit_of(node);
    fit(c).room = room_at(lattice, c);
    cells_.push_back(c);
  });
}

void Refinement::fit_in_level(const ImageView& level, const Lattice& lattice) {
  SaddleFit last;
  lattice.for_each([&](Cell c, const Node& node) {
    const float spacing = spacing_at(lattice, c);
    const float radius = std::clamp(kShare * clear_at(lattice, c), kLeastRadius, kLevelRadius);
    SaddleFit f = fit(c);
    if (last.contrast != 0) take_widths(last, kLeastLevelWidth, f);
    const bool good = fit_saddle(level, radius, kLevelSteps, f, kRoughly, Pixels::kPoints) &&
                      colours_fit(f, c) &&
                      distance(f, node) < std::max(1.5F, kLargestMove * spacing);
    // A fit that runs away is dropped: the fit in the image will tell.
    if (!good) return unfitted_.push_back(c);
    fit(c) = f;
    if (!is_noisy(f, kMostNoise)) last = f;
  });
}

void Refinement::to_image(const Pyramid& pyramid, int level, Lattice& lattice, bool fitted) {
  begin(lattice);
  unfitted_.clear();
  const auto scale = static_cast<float>(1 << level);
  lattice.for_each([&](Cell c, const Node& node) {
    if (node.guessed) lattice.remove(c);
  });
  if (fitted) fit_in_level(pyramid.level(level), lattice);
  lattice.for_each([&](Cell c, const Node& /*node*/) {
    const SaddleFit& f = fit(c);
    Node& node = lattice.at(c);
    node.x = Pyramid::to_image(static_cast<float>(f.x), level);
    node.y = Pyramid::to_image(static_cast<float>(f.y), level);
    node.along = f.along;
    node.down = f.down;
    // The level's own pixels have blurred the edges too.
    const float own = (1 - 1 / (scale * scale)) / 12;
    const float width = std::max(f.along_width, f.down_width);
    node.width = scale * std::sqrt(std::max(width * width - own, 0.5F / (scale * scale)));
    node.width = std::min(node.width, kWidestEdge);
  });
  for (const Cell c : unfitted_) put_between_neighbours(lattice, c);
}

float Refinement::most_noise() const { return std::max(kNoisiest * usual_noise_, kMostNoise); }

void Refinement::drop_misfits(Lattice& lattice) {
  const float least =
      kLeastSwingShare * fits_.median(lattice, [](const SaddleFit& f) { return f.swing(); });
  usual_noise_ = fits_.median(lattice, [](const SaddleFit& f) { return f.noise / f.swing(); });
  const float most = most_noise();
  lattice.for_each([&](Cell c, const Node& /*node*/) {
    const SaddleFit& f = fit(c);
    const float contrast = f.swing();
    if (contrast < least || is_noisy(f, most) || f.residual > kMostResidual * contrast) {
      lattice.remove(c);
    }
  });
}

void Refinement::drop_uncertain(Lattice& lattice) {
  const float usual = fits_.median(lattice, [](const SaddleFit& f) { return f.sigma; });
  const float most = std::min(kUncertain * usual, kUncertainInNoise * usual + kUncertainInNoisePx);
  lattice.for_each([&](Cell c, const Node& node) {
    if (node.sigma > most) lattice.remove(c);
  });
}

double Refinement::blur(const Lattice& lattice) {
  const float along = fits_.median(lattice, [](const SaddleFit& f) { return f.along_width; });
  const float down = fits_.median(lattice, [](const SaddleFit& f) { return f.down_width; });
  return static_cast<double>(std::max(along, down));
}

bool Refinement::confirm(const ImageView& image, Lattice& lattice) const {
  const CellRange e = lattice.extent();
  // How far the outermost nodes have moved, px: [last column][last row].
  Direction shift[2][2];
  for (const int col : {0, 1}) {
    for (const int row : {0, 1}) {
      const Cell c = {col == 0 ? e.first.col : e.last.col, row == 0 ? e.first.row : e.last.row};
      const Node& node = lattice.at(c);
      const SaddleFit f = quick_fit(image, lattice, c, kFirstRadius, fit_of(node), 6);
      if (!(f.noise <= kMostNoise * f.swing())) return false;
      shift[col][row] = {static_cast<float>(f.x) - node.x, static_cast<float>(f.y) - node.y};
    }
  }
  const LatticePlace first = lattice.place(e.first);
  const LatticePlace last = lattice.place(e.last);
  lattice.for_each([&](Cell c, const Node& /*node*/) {
    const LatticePlace at = lattice.place(c);
    const auto s = static_cast<float>((at.col - first.col) / (last.col - first.col));
    const auto t = static_cast<float>((at.row - first.row) / (last.row - first.row));
    const auto mean = [&](float Direction::*of) {
      return (1 - s) * ((1 - t) * shift[0][0].*of + t * shift[0][1].*of) +
             s * ((1 - t) * shift[1][0].*of + t * shift[1][1].*of);
    };
    lattice.at(c).x += mean(&Direction::x);
    lattice.at(c).y += mean(&Direction::y);
  });
  return true;
}

// The last fit, with the bends and slopes from the first fits, in the largest window that has
// nothing else in it: no next edge, no finger, no end of the paper.
SaddleFit Refinement::last_fit(const ImageView& image, const Lattice& lattice, Cell c) const {
  const float clear = clear_at(lattice, c);
  const SaddleFit& first = at(c);
  const float width = std::max(first.along_width, first.down_width);
  float radius = last_radius(clear, width);
  const float closest = closest_radius(clear);
  SaddleFit best = first;
  best.noise = std::numeric_limits<float>::infinity();
  const EdgeDots dots = dots_at(lattice, c);
  for (bool again = false; !again || radius >= closest; again = true, radius *= kSmaller) {
    // So small a window tells little: it is for corners that would be lost.
    if (again && radius < kCloseRadius && !is_noisy(best, most_noise())) break;
    SaddleFit f = first;
    f.dots = dots;
    if (!fit_saddle(image, radius, 8, f)) continue;
    // Squares that are parted sharply look like noise if the corner is not in a pixel's middle.
    if (f.noise > kNoisy * usual_noise_ * f.swing()) fit_parted(image, radius, 8, f);
    if (!colours_fit(f, c)) continue;
    // Of two that are corners the more certain one: a smaller window has to be worth its pixels.
    if (is_noisy(best, most_noise()) ? f.noise < best.noise : f.sigma < best.sigma) best = f;
    if (f.noise <= kNoisy * usual_noise_ * f.swing()) break;
  }
  return best;
}

// An edge that is w wide is off by w / .8 times the noise over its swing where that is alike all
// along it; compression leaves it alike over some of it.
Slack Refinement::slack(const Lattice& lattice) {
  constexpr float kAlike = 0.4F / 0.798F;
  const auto good = [&](Cell c) { return std::isfinite(at(c).noise); };
  const auto place = [&](Cell c) {
    const SaddleFit& f = at(c);
    return f.noise / f.swing() * std::max(f.along_width, f.down_width) * kAlike;
  };
  return {fits_.median_where(lattice, good, place), fits_.median_where(lattice, good, [&](Cell c) {
            return place(c) / spacing_at(lattice, c);
          })};
}

// Whether the first fits tell little, or many of them have failed.
bool Refinement::is_in_noise(const Lattice& lattice) {
  constexpr float kMostSlack = 0.008F;  // of the spacing
  constexpr int kMostFailed = 8;        // one of so many
  int failed = 0;
  lattice.for_each([&](Cell c, const Node&) { failed += std::isfinite(at(c).noise) ? 0 : 1; });
  return kMostFailed * failed > lattice.count() || slack(lattice).of_spacing > kMostSlack;
}

// A fit to which the neighbours' places and the blur of the whole board tell how the edges run.
SaddleFit Refinement::expected_fit(const ImageView& image, const Lattice& lattice, Cell c,
                                   float sigma) const {
  const Node& node = lattice.at(c);
  const float spacing = spacing_at(lattice, c);
  SaddleFit f = fit_of(node);
  f.room = room_at(lattice, c);
  f.along_bend = at(c).along_bend;
  f.down_bend = at(c).down_bend;
  f.slope = at(c).slope;
  f.contrast_slope = at(c).contrast_slope;
  float clear = clear_at(lattice, c);
  if (std::isfinite(at(c).noise) && at(c).contrast != 0) f.dots = dots_at(lattice, c);
  if (f.dots.count > 0) {
    f.level = at(c).level;
    f.contrast = at(c).contrast;
    clear = spacing;
  }
  f.has_expected = true;
  f.expected = {node.along, node.down, usual_along_, usual_down_, f.x, f.y, sigma};
  expect_directions(lattice, c, f.expected);
  f.along = f.expected.along;
  f.down = f.expected.down;
  f.along_width = usual_along_;
  f.down_width = usual_down_;
  const float radius = last_radius(clear, std::max(usual_along_, usual_down_));
  const bool good = fit_saddle(image, radius, 10, f) && colours_fit(f, c) &&
                    distance(f, node) < std::max(1.5F, kLargestMove * spacing);
  if (!good) f.noise = std::numeric_limits<float>::infinity();
  return f;
}

void Refinement::refine_in_noise(const ImageView& image, Lattice& lattice) {
  const auto good = [&](Cell c) { return std::isfinite(at(c).noise); };
  usual_along_ = fits_.median_where(lattice, good, [&](Cell c) { return at(c).along_width; });
  usual_down_ = fits_.median_where(lattice, good, [&](Cell c) { return at(c).down_width; });
  refit(lattice, [&](Cell c) { return expected_fit(image, lattice, c); });
  lattice.prune(kPrune);
  if (lattice.count() < kFewestToRefine) return;
  set_bends(lattice, fits_);
  set_slopes(lattice, fits_);
  refit(lattice, [&](Cell c) { return expected_fit(image, lattice, c); });
}

bool Refinement::correct_bends_in(const ImageView& image, Lattice& lattice) {
  if (!are_bent(lattice, fits_)) return false;
  inner_fits_.reset(lattice.extent());
  lattice.for_each([&](Cell c, const Node&) { inner_fits_.at(c) = inner_fit(image, at(c)); });
  correct_bends(lattice, inner_fits_, fits_);
  lattice.for_each([&](Cell c, const Node& /*node*/) { take(at(c), lattice.at(c)); });
  return true;
}

bool Refinement::refine(const ImageView& image, Lattice& lattice, std::span<const Cell> board) {
  const int before = lattice.count();
  begin(lattice);
  SaddleFit last;
  lattice.for_each([&](Cell c, const Node&) { fit(c) = first_fit(image, lattice, c, last); });
  in_noise_ = is_in_noise(lattice);
  if (in_noise_) {
    refine_in_noise(image, lattice);
  } else {
    refit(lattice, [&](Cell c) { return at(c); });
    lattice.prune(kPrune);
    if (lattice.count() < kFewestToRefine) return false;
    set_bends(lattice, fits_);
    set_slopes(lattice, fits_);
    refit(lattice, [&](Cell c) { return last_fit(image, lattice, c); });
    std::ignore = correct_bends_in(image, lattice);
  }
  if (lattice.count() < kFewestToRefine) return false;
  drop_uncertain(lattice);
  stray_corners_.remove_from(lattice, slack(lattice), image_center(image.size()));
  const bool all_seen = std::ranges::all_of(board, [&](Cell c) { return lattice.has(c); });
  if (lattice.count() < before || (in_noise_ && !all_seen)) recover_lost(image, lattice, board);
  return 2 * lattice.count() >= before;
}

bool Refinement::refine_again(const ImageView& image, const FitGrid& before, Lattice& lattice) {
  const int count = lattice.count();
  begin(lattice);
  lattice.for_each([&](Cell c, const Node& node) {
    fit(c) = before.at(c);
    fit(c).room = room_at(lattice, c);
    fit(c).x = static_cast<double>(node.x);
    fit(c).y = static_cast<double>(node.y);
  });
  usual_noise_ = fits_.median(lattice, [](const SaddleFit& f) { return f.noise / f.swing(); });
  refit(lattice, [&](Cell c) { return last_fit(image, lattice, c); });
  const bool has_bends = correct_bends_in(image, lattice);
  drop_uncertain(lattice);
  stray_corners_.remove_from(lattice, slack(lattice), image_center(image.size()));
  if (lattice.count() < count) return false;
  // Bends and slopes for the next frame. The fits have used those of the frame before, and are
  // moved to where fits with their own bends would be.
  if (!has_bends) set_bends(lattice, fits_);
  set_slopes(lattice, fits_);
  return true;
}

}  // namespace calvin::detect
