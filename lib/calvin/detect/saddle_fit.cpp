// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "calvin/detect/saddle_fit.cpp"
#include <hwy/foreach_target.h>
// The order matters: Highway includes this file again for each target from the line above.
#include <hwy/highway.h>

#include "calvin/detect/saddle_fit.hpp"

#ifndef CALVIN_DETECT_SADDLE_FIT_TYPES
#define CALVIN_DETECT_SADDLE_FIT_TYPES
namespace calvin::detect {

// The unknowns, in this order.
// The widths by their logarithms, the directions by angles.
enum Unknown { kX, kY, kAlong, kDown, kLevel, kContrast, kAlongWidth, kDownWidth, kUnknowns };
inline constexpr int kProducts = kUnknowns * (kUnknowns + 1) / 2;
// The window's, and a vector more.
inline constexpr int kMaxPixels = (2 * kMaxFitRadius + 1) * (2 * kMaxFitRadius + 1) + 64;

// The pixels of a window, from its middle one.
struct Window {
  int count = 0;
  bool whole = true;  // not cut by the border of the image
  alignas(64) float x[kMaxPixels];
  alignas(64) float y[kMaxPixels];
  alignas(64) float grey[kMaxPixels];
  alignas(64) float error[kMaxPixels];  // of the fit
};

// J^T J (upper triangle, row by row), J^T e and e^T e.
struct Normal {
  float products[kProducts];
  float gradient[kUnknowns];
  float square;
};

}  // namespace calvin::detect
#endif

HWY_BEFORE_NAMESPACE();
namespace calvin::detect::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// erf(x) and its derivative, within 5e-4: Abramowitz and Stegun, 7.1.27.
template <class D, class V>
HWY_INLINE V error_function(D d, V x, V& derivative) {
  const auto set = [&](float v) { return hn::Set(d, v); };
  const V t = hn::Min(hn::Abs(x), set(4.0F));
  const V one = set(1);
  V p = hn::MulAdd(set(0.078108F), t, set(0.000972F));
  p = hn::MulAdd(p, t, set(0.230389F));
  p = hn::MulAdd(p, t, set(0.278393F));
  V slope = hn::MulAdd(set(4 * 0.078108F), t, set(3 * 0.000972F));
  slope = hn::MulAdd(slope, t, set(2 * 0.230389F));
  slope = hn::MulAdd(slope, t, set(0.278393F));
  const V inverse = hn::Div(one, hn::MulAdd(p, t, one));
  const V square = hn::Mul(inverse, inverse);
  const V fourth = hn::Mul(square, square);
  derivative = hn::Mul(hn::Mul(set(4), slope), hn::Mul(fourth, inverse));
  return hn::CopySign(hn::Sub(one, fourth), x);
}

// `x`, `y`: of the fit's corner from the window's middle.
void accumulate(Window& window, const SaddleFit& fit, float x, float y, Normal& normal) {
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
    V slope_a;
    V slope_b;
    const V ta = error_function(d, a, slope_a);
    const V tb = error_function(d, b, slope_b);
    const V local = hn::MulAdd(set(fit.contrast_slope.x), dx,
                               hn::MulAdd(set(fit.contrast_slope.y), dy, contrast));
    const V base = hn::MulAdd(set(fit.slope.x), dx, hn::MulAdd(set(fit.slope.y), dy, level));
    const V saddle = hn::Mul(ta, tb);
    const V model = hn::MulAdd(local, saddle, base);

    // The last vector may reach beyond the window.
    const auto inside = hn::FirstN(d, static_cast<std::size_t>(window.count - i));
    const V in = hn::IfThenElseZero(inside, one);
    const V e = hn::Mul(in, hn::Sub(hn::LoadU(d, window.grey + i), model));
    hn::StoreU(e, d, window.error + i);
    const V scale = hn::Mul(in, local);
    const V by_a = hn::Mul(hn::Mul(scale, wide_a), hn::Mul(tb, slope_a));
    const V by_b = hn::Mul(hn::Mul(scale, wide_b), hn::Mul(ta, slope_b));
    V j[kUnknowns];
    j[kX] = hn::Sub(hn::Mul(by_a, along_y), hn::Mul(by_b, down_y));
    j[kY] = hn::Sub(hn::Mul(by_b, down_x), hn::Mul(by_a, along_x));
    j[kAlong] = hn::Neg(hn::Mul(by_a, ua));
    j[kDown] = hn::Mul(by_b, ub);
    j[kLevel] = in;
    j[kContrast] = hn::Mul(in, saddle);
    j[kAlongWidth] = hn::Neg(hn::Mul(by_a, straight_a));
    j[kDownWidth] = hn::Neg(hn::Mul(by_b, straight_b));
    int k = 0;
    for (int p = 0; p < kUnknowns; ++p) {
      gradient[p] = hn::MulAdd(j[p], e, gradient[p]);
      for (int q = p; q < kUnknowns; ++q, ++k) products[k] = hn::MulAdd(j[p], j[q], products[k]);
    }
    square = hn::MulAdd(e, e, square);
  }
  for (int k = 0; k < kProducts; ++k)
    normal.products[k] = hn::GetLane(hn::SumOfLanes(d, products[k]));
  for (int p = 0; p < kUnknowns; ++p)
    normal.gradient[p] = hn::GetLane(hn::SumOfLanes(d, gradient[p]));
  normal.square = hn::GetLane(hn::SumOfLanes(d, square));
}

}  // namespace calvin::detect::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace calvin::detect {

namespace {

HWY_EXPORT(accumulate);

constexpr float kLeastContrast = 3;     // grey levels
constexpr float kLeastWidth = 0.2F;     // px
constexpr float kLargestWidth = 8;      // px
constexpr float kWidthPrior = 0.5F;     // 1 sigma of a step of a width's logarithm
constexpr float kLongestStep = 1.2F;    // px
constexpr float kLongestTurn = 0.3F;    // rad, in a step
constexpr float kSettled = 0.01F;       // px, of a step
constexpr float kDamping = 1e-3F;       // Levenberg's, of the diagonal
constexpr float kLeastSine = 0.15F;     // between the edges
constexpr float kRounding = 1.0F / 12;  // grey levels^2, the variance of a whole number's rounding

using Matrix = Eigen::Matrix<float, kUnknowns, kUnknowns>;
using Vector = Eigen::Matrix<float, kUnknowns, 1>;

void gather(const ImageView& image, int x, int y, float radius, Window& window) {
  const int reach = static_cast<int>(radius + 0.3F);
  const float limit = (radius + 0.3F) * (radius + 0.3F);
  window.count = 0;
  window.whole = x >= reach && y >= reach && x + reach < image.width && y + reach < image.height;
  for (int dy = std::max(-reach, -y); dy <= std::min(reach, image.height - 1 - y); ++dy) {
    const int half = static_cast<int>(std::sqrt(limit - static_cast<float>(dy * dy)));
    const std::uint8_t* row = image.data + (y + dy) * image.stride + x;
    const int first = std::max(-half, -x);
    const int last = std::min(half, image.width - 1 - x);
    for (int dx = first; dx <= last; ++dx) {
      window.x[window.count] = static_cast<float>(dx);
      window.y[window.count] = static_cast<float>(dy);
      window.grey[window.count++] = row[dx];
    }
  }
  // What the last vector reads beyond them is multiplied by 0, so it must be a number.
  constexpr int kLongestVector = 64;
  std::fill_n(window.x + window.count, kLongestVector, 0.0F);
  std::fill_n(window.y + window.count, kLongestVector, 0.0F);
  std::fill_n(window.grey + window.count, kLongestVector, 0.0F);
}

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
float noise_variance(const Window& window, float square) {
  constexpr int kOddUnknowns = 2;  // the place
  const auto count = static_cast<float>(window.count);
  if (!window.whole) return square / (count - static_cast<float>(kUnknowns));
  // A whole window lists its pixels in an order that is point-symmetric about its middle, which is
  // the corner to half a pixel.
  float sum = 0;
  for (int i = 0; i < window.count / 2; ++i) {
    const float odd = window.error[i] - window.error[window.count - 1 - i];
    sum += odd * odd;
  }
  return 0.5F * sum / (0.5F * count - kOddUnknowns);
}

bool solve(const Normal& normal, int pixels, Vector& change, Matrix& information) {
  int k = 0;
  for (int p = 0; p < kUnknowns; ++p) {
    for (int q = p; q < kUnknowns; ++q, ++k) {
      information(p, q) = information(q, p) = normal.products[k];
    }
  }
  const float variance = normal.square / static_cast<float>(pixels) + 1;
  information(kAlongWidth, kAlongWidth) += variance / (kWidthPrior * kWidthPrior);
  information(kDownWidth, kDownWidth) += variance / (kWidthPrior * kWidthPrior);
  Matrix damped = information;
  damped.diagonal() *= 1 + kDamping;
  const Eigen::Map<const Vector> gradient(normal.gradient);
  change = damped.llt().solve(gradient);
  return change.allFinite();
}

// Applies a step; returns how far the corner moved, px.
float apply(const Vector& change, float& x, float& y, SaddleFit& fit) {
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
  return moved;
}

}  // namespace

bool fit_saddle(const ImageView& image, float radius, int steps, SaddleFit& fit) noexcept {
  radius = std::min(radius, static_cast<float>(kMaxFitRadius));
  if (!(std::abs(fit.x) < 1e6) || !(std::abs(fit.y) < 1e6)) return false;
  const int middle_x = static_cast<int>(std::lround(fit.x));
  const int middle_y = static_cast<int>(std::lround(fit.y));
  if (middle_x < 0 || middle_y < 0 || middle_x >= image.width || middle_y >= image.height) {
    return false;
  }
  Window window;
  gather(image, middle_x, middle_y, radius, window);
  if (window.count < 2 * kUnknowns) return false;
  auto x = static_cast<float>(fit.x - middle_x);
  auto y = static_cast<float>(fit.y - middle_y);
  if (fit.contrast == 0) start(window, fit, x, y);

  Normal normal;
  Vector change;
  Matrix information;
  for (int i = 0; i < steps; ++i) {
    HWY_DYNAMIC_DISPATCH(accumulate)(window, fit, x, y, normal);
    if (!solve(normal, window.count, change, information)) return false;
    const float moved = apply(change, x, y, fit);
    if (!(std::abs(x) <= 0.6F * radius && std::abs(y) <= 0.6F * radius) ||
        std::abs(cross(fit.along, fit.down)) < kLeastSine) {
      return false;
    }
    if (moved < kSettled) break;
  }
  fit.x = middle_x + static_cast<double>(x);
  fit.y = middle_y + static_cast<double>(y);
  fit.residual = std::sqrt(normal.square / static_cast<float>(window.count));
  fit.noise = std::sqrt(noise_variance(window, normal.square) + kRounding);
  const Matrix covariance = information.llt().solve(Matrix::Identity());
  fit.sigma = fit.noise * std::sqrt(0.5F * (covariance(kX, kX) + covariance(kY, kY)));
  return std::abs(fit.contrast) >= kLeastContrast && std::isfinite(fit.sigma);
}

}  // namespace calvin::detect

#endif  // HWY_ONCE
