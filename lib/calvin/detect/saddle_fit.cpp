// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "calvin/detect/saddle_fit.cpp"
#include <hwy/foreach_target.h>
// The order matters: Highway includes this file again for each target from the line above.
#include <hwy/highway.h>
// Likewise.
#include "calvin/detect/saddle_model-inl.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calvin/detect/fit_window.hpp"
#include "calvin/detect/saddle_fit.hpp"

#ifndef CALVIN_DETECT_SADDLE_FIT_TYPES
#define CALVIN_DETECT_SADDLE_FIT_TYPES
namespace calvin::detect {

// The unknowns, in this order: the widths by their logarithms, the directions by angles. The place
// comes last, so that its covariance is to be had from the last of the triangular factor.
enum Unknown {
  kAlong,
  kDown,
  kLevel,
  kContrast,
  kAlongWidth,
  kDownWidth,
  kGain,
  kX,
  kY,
  kUnknowns
};
inline constexpr int kProducts = kUnknowns * (kUnknowns + 1) / 2;
// The two of each product, in this order.
struct Pairs {
  int first[kProducts];
  int second[kProducts];
};
inline constexpr Pairs kPairs = [] {
  Pairs pairs{};
  int k = 0;
  for (int p = 0; p < kUnknowns; ++p) {
    for (int q = p; q < kUnknowns; ++q, ++k) {
      pairs.first[k] = p;
      pairs.second[k] = q;
    }
  }
  return pairs;
}();
inline constexpr float kWhite = 255;

// J^T W J (upper triangle, row by row), J^T W e and e^T W e.
struct Normal {
  float products[kProducts];
  float gradient[kUnknowns];
  float square;
  float count;  // of pixels that tell something
};

}  // namespace calvin::detect
#endif

HWY_BEFORE_NAMESPACE();
namespace calvin::detect::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Adds to J^T J and J^T e. Written out for the compiler, which keeps arrays in memory that it does
// not see all indices of.
template <class V, std::size_t... K, std::size_t... P>
HWY_INLINE void add_products(const V* j, V e, V* products, V* gradient,
                             std::index_sequence<K...> /*products*/,
                             std::index_sequence<P...> /*unknowns*/) {
  ((products[K] = hn::MulAdd(j[kPairs.first[K]], j[kPairs.second[K]], products[K])), ...);
  ((gradient[P] = hn::MulAdd(j[P], e, gradient[P])), ...);
}

// `x`, `y`: of the fit's corner from the window's middle.
void accumulate(Window& window, const SaddleFit& fit, float radius, float x, float y,
                Normal& normal) {
  const hn::ScalableTag<float> d;
  using V = hn::Vec<decltype(d)>;
  const auto set = [&](float v) { return hn::Set(d, v); };
  constexpr float kRoot = 0.70710678F;  // a Gaussian's sigma is 1/sqrt(2) of the erf's scale
  const V along_x = set(fit.along.x), along_y = set(fit.along.y);
  const V down_x = set(fit.down.x), down_y = set(fit.down.y);
  const V wide_a = set(kRoot / fit.along_width), wide_b = set(kRoot / fit.down_width);
  const V half_bend_a = set(0.5F * fit.along_bend), half_bend_b = set(0.5F * fit.down_bend);
  const V level = set(fit.level), contrast = set(fit.contrast);
  const V one = set(1);

  V products[kProducts];
  V gradient[kUnknowns];
  V square = hn::Zero(d);
  V count = hn::Zero(d);
  for (V& p : products) p = hn::Zero(d);
  for (V& g : gradient) g = hn::Zero(d);

  const auto lanes = static_cast<int>(hn::Lanes(d));
  for (int i = 0; i < window.count; i += lanes) {
    const V dx = hn::Sub(hn::LoadU(d, window.x + i), set(x));
    const V dy = hn::Sub(hn::LoadU(d, window.y + i), set(y));
    const V ua = hn::MulAdd(along_x, dx, hn::Mul(along_y, dy));
    const V ub = hn::MulAdd(down_x, dx, hn::Mul(down_y, dy));
    const V straight_a = hn::Sub(hn::Mul(along_x, dy), hn::Mul(along_y, dx));
    const V straight_b = hn::Sub(hn::Mul(down_y, dx), hn::Mul(down_x, dy));
    const V a = hn::Mul(hn::NegMulAdd(half_bend_a, hn::Mul(ua, ua), straight_a), wide_a);
    const V b = hn::Mul(hn::NegMulAdd(half_bend_b, hn::Mul(ub, ub), straight_b), wide_b);
    const Saddle<V> saddle =
        fit.has_gain ? parted_saddle(d, a, b, fit.gain, wide_a, wide_b) : plain_saddle(d, a, b);
    const V local = hn::MulAdd(set(fit.contrast_slope.x), dx,
                               hn::MulAdd(set(fit.contrast_slope.y), dy, contrast));
    const V base = hn::MulAdd(set(fit.slope.x), dx, hn::MulAdd(set(fit.slope.y), dy, level));
    const V model = hn::MulAdd(local, saddle.value, base);

    // The last vector may reach beyond the window. A white pixel only tells that it is no darker, a
    // black one that it is no brighter.
    const auto inside = hn::FirstN(d, static_cast<std::size_t>(window.count - i));
    const V grey = hn::LoadU(d, window.grey + i);
    const V below = hn::IfThenElse(hn::Ge(grey, set(kWhite)), hn::Min(model, grey), model);
    const V seen = hn::IfThenElse(hn::Le(grey, hn::Zero(d)), hn::Max(below, grey), below);
    const auto told = hn::And(inside, hn::Eq(seen, model));
    const V error = hn::IfThenElseZero(told, hn::Sub(grey, model));
    hn::StoreU(error, d, window.error + i);
    count = hn::Add(count, hn::IfThenElseZero(told, one));
    // The disc is one about the corner, not about a pixel: its rim has pixels in part, the square
    // root of their weight falls from 1 to 0.
    const V square_distance = hn::MulAdd(dx, dx, hn::Mul(dy, dy));
    const V rim = hn::MulAdd(square_distance, set(-0.5F / radius), set(0.5F * radius + 0.5F));
    const V in = hn::IfThenElseZero(told, hn::Min(hn::Max(rim, hn::Zero(d)), one));
    const V e = hn::Mul(in, error);
    const V scale = hn::Mul(in, local);
    const V by_a = hn::Mul(hn::Mul(scale, wide_a), saddle.by_a);
    const V by_b = hn::Mul(hn::Mul(scale, wide_b), saddle.by_b);
    V j[kUnknowns];
    j[kX] = hn::Sub(hn::Mul(by_a, along_y), hn::Mul(by_b, down_y));
    j[kY] = hn::Sub(hn::Mul(by_b, down_x), hn::Mul(by_a, along_x));
    j[kAlong] = hn::Neg(hn::Mul(by_a, ua));
    j[kDown] = hn::Mul(by_b, ub);
    j[kLevel] = in;
    j[kContrast] = hn::Mul(in, saddle.value);
    j[kAlongWidth] = hn::Neg(hn::Mul(scale, saddle.width_a));
    j[kDownWidth] = hn::Neg(hn::Mul(scale, saddle.width_b));
    j[kGain] = hn::Mul(scale, saddle.gain);
    add_products(j, e, products, gradient, std::make_index_sequence<kProducts>(),
                 std::make_index_sequence<kUnknowns>());
    square = hn::MulAdd(e, e, square);
  }
  for (int k = 0; k < kProducts; ++k)
    normal.products[k] = hn::GetLane(hn::SumOfLanes(d, products[k]));
  for (int p = 0; p < kUnknowns; ++p)
    normal.gradient[p] = hn::GetLane(hn::SumOfLanes(d, gradient[p]));
  normal.square = hn::GetLane(hn::SumOfLanes(d, square));
  normal.count = hn::GetLane(hn::SumOfLanes(d, count));
}

}  // namespace calvin::detect::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include <limits>

namespace calvin::detect {

namespace {

HWY_EXPORT(accumulate);

constexpr float kLeastContrast = 3;      // grey levels
constexpr float kLeastWidth = 0.2F;      // px
constexpr float kLargestWidth = 8;       // px
constexpr float kWidthPrior = 0.5F;      // 1 sigma of a step of a width's logarithm
constexpr float kGainPrior = 2;          // px, 1 sigma of a step of the gain
constexpr float kMostGain = 5;           // px
constexpr float kLongestStep = 1.2F;     // px
constexpr float kSettledGain = 0.05F;    // px, of a step
constexpr float kSettledWidth = 0.015F;  // of a step of its logarithm
constexpr float kLongestTurn = 0.3F;     // rad, in a step
constexpr float kDamping = 1e-3F;        // Levenberg's, of the diagonal
constexpr float kFarthest = 0.6F;        // of the radius, from where the fit began
constexpr double kOffMiddle = 0.9;       // px, from where a window is gathered anew
constexpr float kLeastSine = 0.15F;      // between the edges
// A pixel tells of an edge as far as its blur reaches, and as one does not know the edge's place.
constexpr float kNearEdge = 3;  // widths
constexpr float kNearEdgePx = 2.5F;
constexpr float kRounding = 1.0F / 12;  // grey levels^2, the variance of a whole number's rounding

// The first level and contrast; its sign from the squares themselves.
void start(const Window& window, SaddleFit& fit, float x, float y) {
  float sum[2] = {0, 0};
  int count[2] = {0, 0};
  for (int i = 0; i < window.count; ++i) {
    const Direction p = {window.x[i] - x, window.y[i] - y};
    const int bright = cross(fit.along, p) * cross(p, fit.down) > 0 ? 1 : 0;
    sum[bright] += window.grey[i];
    ++count[bright];
  }
  const float in = sum[1] / static_cast<float>(std::max(count[1], 1));
  const float out = sum[0] / static_cast<float>(std::max(count[0], 1));
  fit.level = 0.5F * (in + out);
  fit.contrast = 0.6F * (in - out);
}

Direction turned(Direction direction, float angle) {
  const Direction to = {direction.x - angle * direction.y, direction.y + angle * direction.x};
  const float length = std::hypot(to.x, to.y);
  return {to.x / length, to.y / length};
}

// `step`: of the width's logarithm, so that it stays positive.
float widened(float width, float step) {
  return std::clamp(width * std::exp(std::clamp(step, -0.5F, 0.5F)), kLeastWidth, kLargestWidth);
}

// What differs between pixels opposite of the corner is noise: a saddle looks the same turned by
// 180 degrees, whatever its optics, ink or exposure did to it. Returns the variance.
// `pixels`: the sum of their weights; `count`: of those that tell something, the others have no
// error.
float noise_variance(const Window& window, float square, float pixels, float count) {
  constexpr int kOddUnknowns = 2;  // the place
  if (!window.whole) return square / std::max(pixels - static_cast<float>(kUnknowns), 1.0F);
  // A whole window lists its pixels in an order that is point-symmetric about its middle, which is
  // the corner to half a pixel.
  const float sum = odd_square(window);
  return 0.5F * sum / std::max(0.5F * count - kOddUnknowns, 1.0F);
}

// L L^T = A, of which the upper triangle is given row by row; L by its columns.
struct Factor {
  float l[kUnknowns][kUnknowns];  // [column][row]

  [[nodiscard]] bool compute(const float* upper) {
    int k = 0;
    for (int column = 0; column < kUnknowns; ++column) {
      for (int row = column; row < kUnknowns; ++row) l[column][row] = upper[k++];
    }
    for (int column = 0; column < kUnknowns; ++column) {
      if (!(l[column][column] > 0)) return false;
      const float scale = 1 / std::sqrt(l[column][column]);
      for (int row = column; row < kUnknowns; ++row) l[column][row] *= scale;
      for (int next = column + 1; next < kUnknowns; ++next) {
        for (int row = next; row < kUnknowns; ++row) {
          l[next][row] -= l[column][next] * l[column][row];
        }
      }
    }
    return true;
  }
  void solve(const float* right, float* x) const {
    std::copy_n(right, kUnknowns, x);
    for (int column = 0; column < kUnknowns; ++column) {
      x[column] /= l[column][column];
      for (int row = column + 1; row < kUnknowns; ++row) x[row] -= l[column][row] * x[column];
    }
    for (int column = kUnknowns - 1; column >= 0; --column) {
      for (int row = column + 1; row < kUnknowns; ++row) x[column] -= l[column][row] * x[row];
      x[column] /= l[column][column];
    }
  }
  // The mean of the variances of x and of y in A^-1.
  [[nodiscard]] float place_variance() const {
    const float a = 1 / l[kX][kX];
    const float b = 1 / l[kY][kY];
    const float off = l[kX][kY] * a * b;
    return 0.5F * (a * a + off * off + b * b);
  }
};

// Of the diagonal in Normal::products.
constexpr int diagonal(int unknown) { return unknown * kUnknowns - unknown * (unknown - 1) / 2; }

// The step, and the factor of the information about the unknowns.
bool solve(Normal& normal, float pixels, float* change, Factor& factor) {
  const float variance = normal.square / pixels + 1;
  for (const int width : {kAlongWidth, kDownWidth}) {
    normal.products[diagonal(width)] += variance / (kWidthPrior * kWidthPrior);
  }
  normal.products[diagonal(kGain)] += variance / (kGainPrior * kGainPrior);
  for (int p = 0; p < kUnknowns; ++p) normal.products[diagonal(p)] *= 1 + kDamping;
  if (!factor.compute(normal.products)) return false;
  factor.solve(normal.gradient, change);
  return std::all_of(change, change + kUnknowns, [](float c) { return std::isfinite(c); });
}

// Applies a step; returns how far the corner moved, px.
float apply(const float* change, float& x, float& y, SaddleFit& fit) {
  const float moved = std::hypot(change[kX], change[kY]);
  const float turned_by = std::max(std::abs(change[kAlong]), std::abs(change[kDown]));
  const float share = std::min(
      {1.0F, kLongestStep / std::max(moved, 1e-6F), kLongestTurn / std::max(turned_by, 1e-6F)});
  x += share * change[kX];
  y += share * change[kY];
  fit.along = turned(fit.along, share * change[kAlong]);
  fit.down = turned(fit.down, share * change[kDown]);
  fit.level += share * change[kLevel];
  fit.contrast += share * change[kContrast];
  fit.along_width = widened(fit.along_width, share * change[kAlongWidth]);
  fit.down_width = widened(fit.down_width, share * change[kDownWidth]);
  if (fit.has_gain) fit.gain = std::clamp(fit.gain + share * change[kGain], -kMostGain, kMostGain);
  return moved;
}

// The steps in a window about the pixel in which the corner is.
bool fit_in_window(const ImageView& image, float radius, int steps, float settled, SaddleFit& fit) {
  const int middle_x = static_cast<int>(std::lround(fit.x));
  const int middle_y = static_cast<int>(std::lround(fit.y));
  if (middle_x < 0 || middle_y < 0 || middle_x >= image.width || middle_y >= image.height) {
    return false;
  }
  Window window;
  const float band =
      kNearEdge * std::max(fit.along_width, fit.down_width) + kNearEdgePx + std::abs(fit.gain);
  radius = gather(image, middle_x, middle_y, radius, band, fit.along, fit.down, window);
  if (window.count < 2 * kUnknowns) return false;
  auto x = static_cast<float>(fit.x - middle_x);
  auto y = static_cast<float>(fit.y - middle_y);
  if (fit.contrast == 0) start(window, fit, x, y);

  Normal normal{};
  float pixels = 0;
  float change[kUnknowns];
  Factor factor{};
  float least = std::numeric_limits<float>::infinity();  // mean square
  SaddleFit before;
  float before_x = x;
  float before_y = y;
  for (int i = 0; i < steps; ++i) {
    HWY_DYNAMIC_DISPATCH(accumulate)(window, fit, radius, x, y, normal);
    pixels = normal.products[diagonal(kLevel)];
    if (pixels < 2 * kUnknowns) return false;
    // A step too far is taken back by half: with a gain, level and contrast are loose.
    if (fit.has_gain && normal.square > pixels * least && i + 1 < steps) {
      fit = before;
      x = before_x;
      y = before_y;
      for (float& c : change) c *= 0.5F;
      (void)apply(change, x, y, fit);
      continue;
    }
    least = normal.square / pixels;
    before = fit;
    before_x = x;
    before_y = y;
    if (!solve(normal, pixels, change, factor)) return false;
    const float moved = apply(change, x, y, fit);
    if (!(std::abs(x) <= kFarthest * radius && std::abs(y) <= kFarthest * radius) ||
        std::abs(cross(fit.along, fit.down)) < kLeastSine) {
      return false;
    }
    const float widened_by = std::max(std::abs(change[kAlongWidth]), std::abs(change[kDownWidth]));
    if (moved < settled && widened_by < kSettledWidth && std::abs(change[kGain]) < kSettledGain) {
      break;
    }
  }
  fit.x = middle_x + static_cast<double>(x);
  fit.y = middle_y + static_cast<double>(y);
  fit.residual = std::sqrt(normal.square / pixels);
  fit.cut = 1 - normal.count / static_cast<float>(window.count);
  fit.noise = std::sqrt(noise_variance(window, normal.square, pixels, normal.count) + kRounding);
  fit.sigma = fit.noise * std::sqrt(factor.place_variance());
  return fit.swing() >= kLeastContrast && std::isfinite(fit.sigma);
}

}  // namespace

bool fit_saddle(const ImageView& image, float radius, int steps, SaddleFit& fit,
                float settled) noexcept {
  radius = std::min(radius, static_cast<float>(kMaxFitRadius));
  if (!(std::abs(fit.x) < 1e6) || !(std::abs(fit.y) < 1e6)) return false;
  const double u = fit.x;
  const double v = fit.y;
  if (!fit_in_window(image, radius, steps, settled, fit)) return false;
  // A corner that was elsewhere: its noise is that about its own middle.
  const auto off = [](double from, double to) { return std::abs(to - std::round(from)); };
  if (std::max(off(u, fit.x), off(v, fit.y)) < kOffMiddle) return true;
  return fit_in_window(image, radius, steps, settled, fit) &&
         std::max(off(u, fit.x), off(v, fit.y)) <= static_cast<double>(kFarthest * radius);
}

}  // namespace calvin::detect

#endif  // HWY_ONCE
