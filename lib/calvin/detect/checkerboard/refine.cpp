// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// First fits, fits with the bends of the board, and the removal of corners that fail the tests.

#include "calvin/detect/checkerboard/refine.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calvin/detect/checkerboard/corners/fit_radius.hpp"

namespace calvin::detect {

namespace {

constexpr float kFirstRadius = 8;     // px, of the first fit
constexpr float kCloseRadius = 4.5F;  // px, of a fit with something else near it
constexpr float kSmaller = 0.75F;  // ratio of a window to the one before, which had something in it
constexpr float kPrune = 0.3F;     // of the spacing
constexpr int kFewestNodes = 4;
constexpr float kRoughly = 0.1F;         // px, last step of a fit that a better one follows
constexpr float kLevelRadius = 5;        // px, in a smaller level
constexpr float kLeastContrast = 0.25F;  // of the median
// A corner that a hand or a shadow covers in part is not symmetric, which shows as noise.
constexpr float kNoisiest = 3;       // of the median
constexpr float kNoisy = 1.5F;       // of the median: something else is in the window
constexpr float kMostNoise = 0.15F;  // of the contrast
// The noise is told by the pixels of the rim too, which have no weight in the fit: where the next
// edge lies just beyond the window, as of squares that were cut off, it is large and the residual
// is not.
constexpr float kFitsWell = 0.08F;  // of the contrast
// A fit this much less certain than the others has something else in its window.
constexpr float kUncertain = 20;             // of the median sigma
constexpr float kUncertainInNoise = 6;       // likewise, beside a fixed part
constexpr float kUncertainInNoisePx = 0.3F;  // px
constexpr float kOfNoise = 1.4F;             // of the noise: a larger residual has another reason
constexpr float kMostResidual = 0.9F;        // of the contrast
constexpr float kLargestWidth = 8;           // px, of an edge
constexpr float kLargestMove = 0.35F;        // of the spacing, between levels
constexpr float kLargestError = 0.2F;        // of the spacing, from where neighbours predict it

// The distance from a node to the nearest of the next grid lines, px.
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

SaddleFit fit_of(const Node& node) {
  SaddleFit fit;
  fit.x = static_cast<double>(node.x);
  fit.y = static_cast<double>(node.y);
  fit.along = node.along;
  fit.down = node.down;
  fit.along_width = fit.down_width = node.width;
  return fit;
}

// Whether something else than a corner is in the window of a fit. `most`: noise, of the contrast.
bool is_noisy(const SaddleFit& fit, float most) {
  return !(fit.noise <= most * fit.swing()) &&
         !(std::isfinite(fit.noise) && fit.residual <= kFitsWell * fit.swing());
}

bool colours_fit(const SaddleFit& fit, Cell c) { return (fit.contrast > 0) == Lattice::is_even(c); }

void take(const SaddleFit& fit, Node& node) {
  node.x = static_cast<float>(fit.x);
  node.y = static_cast<float>(fit.y);
  node.along = fit.along;
  node.down = fit.down;
  node.contrast = 2 * fit.swing();
  node.width = std::max(fit.along_width, fit.down_width);
  node.sigma = fit.sigma;
}

float distance(const SaddleFit& fit, const Node& node) {
  return std::hypot(static_cast<float>(fit.x) - node.x, static_cast<float>(fit.y) - node.y);
}

// Fits once more with squares that light or ink has parted; keeps the better fit.
void fit_parted(const ImageView& image, float radius, int steps, SaddleFit& fit) {
  constexpr float kOfSwing = 0.06F;  // the residual that no noise explains
  constexpr float kPartedWidth = 2;  // px, from which the steps find the gap
  if (fit.has_gain || fit.residual < kOfSwing * fit.swing()) return;
  // From the beginning: what was fitted without it may be a far too wide edge.
  SaddleFit parted = fit;
  parted.contrast = 0;
  parted.along_width = parted.down_width = kPartedWidth;
  parted.has_gain = true;
  if (fit_saddle(image, radius, 2 * steps, parted, kRoughly) && parted.residual < fit.residual &&
      parted.noise < kOfNoise * fit.noise) {
    fit = parted;
  }
}

// Whether all four squares of a corner are in view, as far from it as the border of the image lets
// one look. A fit whose window is cut off there takes three of them for four.
bool shows_four_squares(const ImageView& image, const SaddleFit& fit, float spacing) {
  constexpr float kLeastSight = 2.5F;  // px
  constexpr float kFarthest = 0.35F;   // of the spacing
  constexpr float kClearly = 0.4F;     // of the contrast
  const auto u = static_cast<float>(fit.x);
  const auto v = static_cast<float>(fit.y);
  const float border = std::min(std::min(u, v), std::min(static_cast<float>(image.width - 1) - u,
                                                         static_cast<float>(image.height - 1) - v));
  const float sight = std::min(border, kFarthest * spacing);
  if (sight < kLeastSight) return false;
  for (const float a : {-1.0F, 1.0F}) {
    for (const float b : {-1.0F, 1.0F}) {
      Direction way = {a * fit.along.x + b * fit.down.x, a * fit.along.y + b * fit.down.y};
      const float length = std::hypot(way.x, way.y);
      const int x = static_cast<int>(std::lround(u + sight * way.x / length));
      const int y = static_cast<int>(std::lround(v + sight * way.y / length));
      if (x < 0 || y < 0 || x >= image.width || y >= image.height) return false;
      const float grey = static_cast<float>(image.at(x, y)) - fit.middle();
      if (a * b * grey * (fit.contrast > 0 ? 1.0F : -1.0F) < kClearly * fit.swing()) return false;
    }
  }
  return true;
}

// Whether the ring around a fit that is too noisy for a corner says that it is one all the same.
bool has_ring(const ImageView& image, const SaddleFit& fit) {
  constexpr float kAsymmetry = 0.8F;
  const int x = static_cast<int>(std::lround(fit.x));
  const int y = static_cast<int>(std::lround(fit.y));
  const bool has_room = x >= kRingReach && y >= kRingReach && x < image.width - kRingReach &&
                        y < image.height - kRingReach;
  Corner corner;
  return !has_room || check_ring(image, x, y, RingSize::kLarge, kAsymmetry, corner);
}

// Whether there is a corner where a node was guessed, by a fit that knows its edges.
bool confirm_guess(const ImageView& image, const Lattice& lattice, Cell c, Node& node) {
  constexpr float kContrast = 0.35F;  // of a neighbour's
  constexpr float kResidual = 0.35F;  // of the contrast
  constexpr float kNoise = 0.1F;      // of the contrast: symmetric, whatever the ring says
  const float spacing = spacing_at(lattice, c);
  float radius = std::clamp(kShare * spacing, kLeastRadius, kLastRadius);
  // A finger next to the corner is not in a smaller window.
  for (bool again = false; !again || radius >= kCloseRadius; again = true, radius *= kSmaller) {
    SaddleFit f = fit_of(node);
    f.along_width = f.down_width = std::max(2.0F, node.width);
    if (!fit_saddle(image, radius, 10, f)) return false;
    if (f.residual > kOfNoise * f.noise) fit_parted(image, radius, 10, f);
    if (!colours_fit(f, c) || 2 * f.swing() < kContrast * node.contrast ||
        distance(f, node) > 0.3F * spacing) {
      return false;
    }
    if (f.residual > kResidual * f.swing() || !shows_four_squares(image, f, spacing) ||
        (f.noise > kNoise * f.swing() && !has_ring(image, f))) {
      continue;
    }
    take(f, node);
    node.guessed = false;
    return true;
  }
  return false;
}

}  // namespace

void Refinement::begin(const Lattice& lattice) {
  fits_.reset(lattice.extent());
  cells_.clear();
  lattice.for_each([&](Cell c, const Node& node) {
    fit(c) = fit_of(node);
    cells_.push_back(c);
  });
}

void Refinement::to_image(const Pyramid& pyramid, int level, Lattice& lattice, bool fitted) {
  begin(lattice);
  const auto scale = static_cast<float>(1 << level);
  lattice.for_each([&](Cell c, const Node& node) {
    if (node.guessed) {
      lattice.remove(c);
      return;
    }
    if (!fitted) return;
    const float spacing = spacing_at(lattice, c);
    SaddleFit f = fit(c);
    const float radius = std::clamp(kShare * spacing, kLeastRadius, kLevelRadius);
    const bool good =
        fit_saddle(pyramid.level(level), radius, 6, f, kRoughly, Pixels::kPoints) &&
        colours_fit(f, c) &&
        std::hypot(f.x - fit(c).x, f.y - fit(c).y) < std::max(1.5F, kLargestMove * spacing);
    // A fit that runs away is dropped: the fit in the image will tell.
    if (good) fit(c) = f;
  });
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
    node.width = std::min(node.width, kLargestWidth);
  });
}

void Refinement::confirm_guesses(const ImageView& image, Lattice& lattice) {
  lattice.for_each([&](Cell c, const Node& node) {
    if (node.guessed && !confirm_guess(image, lattice, c, lattice.at(c))) lattice.remove(c);
  });
  lattice.prune(0.5F);
}

void Refinement::drop_misfits(Lattice& lattice) {
  const float least =
      kLeastContrast * fits_.median(lattice, [](const SaddleFit& f) { return f.swing(); });
  usual_noise_ = fits_.median(lattice, [](const SaddleFit& f) { return f.noise / f.swing(); });
  const float most = std::max(kNoisiest * usual_noise_, kMostNoise);
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

// A fit of a node by itself; its noise is infinite where there is no corner.
SaddleFit Refinement::quick_fit(const ImageView& image, const Lattice& lattice, Cell c,
                                float radius, float width, int steps) const {
  const Node& node = lattice.at(c);
  const float spacing = spacing_at(lattice, c);
  SaddleFit f = fit_of(node);
  f.along_width = f.down_width = width;
  radius = std::clamp(kShare * spacing, kLeastRadius, radius);
  bool good = fit_saddle(image, radius, steps, f, kRoughly);
  if (good && f.residual > kOfNoise * f.noise) fit_parted(image, radius, steps, f);
  good = good && colours_fit(f, c) && distance(f, node) < std::max(1.5F, kLargestMove * spacing);
  if (!good) f.noise = std::numeric_limits<float>::infinity();
  return f;
}

bool Refinement::confirm(const ImageView& image, Lattice& lattice) const {
  const CellRange e = lattice.extent();
  // How far the outermost nodes have moved, px: [last column][last row].
  Direction shift[2][2];
  for (const int col : {0, 1}) {
    for (const int row : {0, 1}) {
      const Cell c = {col == 0 ? e.first.col : e.last.col, row == 0 ? e.first.row : e.last.row};
      const Node& node = lattice.at(c);
      const SaddleFit f = quick_fit(image, lattice, c, kFirstRadius, node.width, 6);
      if (!(f.noise <= kMostNoise * f.swing())) return false;
      shift[col][row] = {static_cast<float>(f.x) - node.x, static_cast<float>(f.y) - node.y};
    }
  }
  lattice.for_each([&](Cell c, const Node& /*node*/) {
    const float s = static_cast<float>(c.col - e.first.col) / static_cast<float>(e.cols() - 1);
    const float t = static_cast<float>(c.row - e.first.row) / static_cast<float>(e.rows() - 1);
    const auto mean = [&](float Direction::*of) {
      return (1 - s) * ((1 - t) * shift[0][0].*of + t * shift[0][1].*of) +
             s * ((1 - t) * shift[1][0].*of + t * shift[1][1].*of);
    };
    lattice.at(c).x += mean(&Direction::x);
    lattice.at(c).y += mean(&Direction::y);
  });
  return true;
}

// The first fit, from where the node was found.
SaddleFit Refinement::first_fit(const ImageView& image, const Lattice& lattice, Cell c) const {
  const float width = lattice.at(c).width;
  SaddleFit best = quick_fit(image, lattice, c, kFirstRadius, width, 8);
  // A badly placed node needs a larger window, one with something else near it a smaller one.
  for (const bool wide : {true, false}) {
    if (best.noise <= kMostNoise * best.swing()) break;
    const SaddleFit f =
        wide ? quick_fit(image, lattice, c, kLastRadius, std::max(2.5F, 1.5F * width), 12)
             : quick_fit(image, lattice, c, kCloseRadius, width, 8);
    if (f.noise < best.noise) best = f;
  }
  return best;
}

// The last fit, with the bends and slopes from the first fits, in the largest window that has
// nothing else in it: no next edge, no finger, no end of the paper.
SaddleFit Refinement::last_fit(const ImageView& image, const Lattice& lattice, Cell c) const {
  const float spacing = spacing_at(lattice, c);
  const SaddleFit& first = at(c);
  const float width = std::max(first.along_width, first.down_width);
  float radius = last_radius(spacing, width);
  SaddleFit best = first;
  best.noise = std::numeric_limits<float>::infinity();
  for (bool again = false; !again || radius >= kCloseRadius; again = true, radius *= kSmaller) {
    SaddleFit f = first;
    if (!fit_saddle(image, radius, 8, f)) continue;
    // Squares that are parted sharply look like noise if the corner is not in a pixel's middle.
    if (f.noise > kNoisy * usual_noise_ * f.swing()) fit_parted(image, radius, 8, f);
    if (!colours_fit(f, c)) continue;
    if (f.noise < best.noise) best = f;
    if (f.noise <= kNoisy * usual_noise_ * f.swing()) break;
  }
  return best;
}

void Refinement::recover_lost(const ImageView& image, Lattice& lattice) {
  const int before = lattice.count();
  for (const Cell c : cells_) {
    const auto expected = lattice.has(c) ? std::nullopt : lattice.expect(c);
    if (!expected) continue;
    const auto step =
        std::find_if(kAround.begin(), kAround.end(), [&](Cell s) { return lattice.has(c + s); });
    if (step == kAround.end()) continue;
    Node node = lattice.at(c + *step);
    node.x = expected->x;
    node.y = expected->y;
    lattice.put(c, node);
    SaddleFit f = quick_fit(image, lattice, c, kFirstRadius, node.width, 8);
    if (std::isfinite(f.noise)) {
      const SaddleFit& near = at(c + *step);
      f.along_bend = near.along_bend;
      f.down_bend = near.down_bend;
      fit(c) = f;
      f = last_fit(image, lattice, c);
    }
    const float contrast = f.swing();
    const float most = std::max(kNoisiest * usual_noise_, kMostNoise);
    if (!is_noisy(f, most) && contrast >= kLeastContrast * node.contrast / 2 &&
        f.residual <= kMostResidual * contrast &&
        distance(f, node) < kLargestError * expected->spacing) {
      fit(c) = f;
      take(f, lattice.at(c));
    } else {
      lattice.remove(c);
    }
  }
  if (lattice.count() == before) return;
  drop_uncertain(lattice);
  stray_corners_.remove_from(lattice);
}

template <typename F>
void Refinement::refit(Lattice& lattice, F fit_again) {
  lattice.for_each([&](Cell c, const Node& /*node*/) {
    fit(c) = fit_again(c);
    if (!std::isfinite(fit(c).noise)) lattice.remove(c);
  });
  drop_misfits(lattice);
  lattice.for_each([&](Cell c, const Node& /*node*/) { take(fit(c), lattice.at(c)); });
}

bool Refinement::refine(const ImageView& image, Lattice& lattice) {
  const int before = lattice.count();
  begin(lattice);
  refit(lattice, [&](Cell c) { return first_fit(image, lattice, c); });
  lattice.prune(kPrune);
  if (lattice.count() < kFewestNodes) return false;
  set_bends(lattice, fits_);
  set_slopes(lattice, fits_);
  refit(lattice, [&](Cell c) { return last_fit(image, lattice, c); });
  drop_uncertain(lattice);
  stray_corners_.remove_from(lattice);
  if (lattice.count() < before) recover_lost(image, lattice);
  return 2 * lattice.count() >= before;
}

bool Refinement::refine_again(const ImageView& image, const FitGrid& before, Lattice& lattice) {
  const int count = lattice.count();
  begin(lattice);
  lattice.for_each([&](Cell c, const Node& node) {
    fit(c) = before.at(c);
    fit(c).x = static_cast<double>(node.x);
    fit(c).y = static_cast<double>(node.y);
  });
  usual_noise_ = fits_.median(lattice, [](const SaddleFit& f) { return f.noise / f.swing(); });
  refit(lattice, [&](Cell c) { return last_fit(image, lattice, c); });
  drop_uncertain(lattice);
  stray_corners_.remove_from(lattice);
  if (lattice.count() < count) return false;
  // Bends and slopes for the next frame. The fits have used those of the frame before, and are
  // moved to where fits with their own bends would be.
  set_bends(lattice, fits_);
  set_slopes(lattice, fits_);
  return true;
}

}  // namespace calvin::detect
