// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The normal equations of a saddle over its window's pixels, a vector at a time.

#include "calvin/core/vector_targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "calvin/detect/checkerboard/corners/saddle_sums.cpp"
#include <hwy/foreach_target.h>
// The order matters: Highway includes this file again for each target from the line above.
#include <hwy/highway.h>
// These are included once for each target, too.
#include "calvin/detect/checkerboard/corners/saddle_model-inl.hpp"
#include "calvin/detect/lane_sums-inl.hpp"

#include <algorithm>
#include <utility>

#include "calvin/detect/checkerboard/corners/saddle_sums.hpp"
#include "calvin/detect/unknown_pairs.hpp"

#ifndef CALVIN_DETECT_SADDLE_SUMS_PAIRS
#define CALVIN_DETECT_SADDLE_SUMS_PAIRS
namespace calvin::detect {

inline constexpr UnknownPairs<kUnknowns> kPairs;
inline constexpr float kWhite = 255;

}  // namespace calvin::detect
#endif

HWY_BEFORE_NAMESPACE();
namespace calvin::detect::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Two vectors of pixels are summed at a time: there are more sums than registers.
inline constexpr int kTogether = 2;

// Adds to J^T J and to J^T e, from the numbers kFrom and kFirst on. Written out for the compiler,
// which keeps arrays in memory that it does not see all indices of.
template <int kFrom, int kFirst, class V, std::size_t... K, std::size_t... P>
HWY_INLINE void add_products(const V (*j)[kUnknowns], const V* e, [[maybe_unused]] V* products,
                             V* gradient, std::index_sequence<K...> /*products*/,
                             std::index_sequence<P...> /*unknowns*/) {
  ((products[kFrom + K] =
        hn::MulAdd(j[1][kPairs.first[kFrom + K]], j[1][kPairs.second[kFrom + K]],
                   hn::MulAdd(j[0][kPairs.first[kFrom + K]], j[0][kPairs.second[kFrom + K]],
                              products[kFrom + K]))),
   ...);
  ((gradient[kFirst + P] = hn::MulAdd(j[1][kFirst + P], e[1],
                                      hn::MulAdd(j[0][kFirst + P], e[0], gradient[kFirst + P]))),
   ...);
}

// Which saddle a fit is of: the ordinary one, that of a sharp picture, that of squares parted.
enum class Model { kPlain, kSharp, kParted };

// Rows of J and errors of the pixels of a window, a vector at a time.
template <Model kModel, class D>
class SaddleRows {
 public:
  using V = hn::Vec<D>;

  SaddleRows(D d, Window& window, const SaddleFit& fit, float radius, float x, float y)
      : d_(d),
        window_(window),
        fit_(fit),
        radius_(radius),
        x_(x),
        y_(y),
        square_(hn::Zero(d)),
        count_(hn::Zero(d)) {}

  // Row `i` of J and the following ones, and their errors.
  HWY_INLINE void fill(int i, V* j, V& e) {
    const D d = d_;
    const auto set = [d](float v) { return hn::Set(d, v); };
    constexpr float kRoot = 0.70710678F;  // a Gaussian's sigma is 1/sqrt(2) of the erf's scale
    const V along_x = set(fit_.along.x), along_y = set(fit_.along.y);
    const V down_x = set(fit_.down.x), down_y = set(fit_.down.y);
    const V wide_a = set(kRoot / fit_.along_width), wide_b = set(kRoot / fit_.down_width);
    const V half_bend_a = set(0.5F * fit_.along_bend), half_bend_b = set(0.5F * fit_.down_bend);
    // Blur moves a bent edge towards its hollow side, by half its bend times the variance.
    const V blur_a = set(0.5F * fit_.along_bend * fit_.along_width * fit_.along_width);
    const V blur_b = set(0.5F * fit_.down_bend * fit_.down_width * fit_.down_width);
    const V dx = hn::Sub(hn::LoadU(d, window_.x + i), set(x_));
    const V dy = hn::Sub(hn::LoadU(d, window_.y + i), set(y_));
    const V ua = hn::MulAdd(along_x, dx, hn::Mul(along_y, dy));
    const V ub = hn::MulAdd(down_x, dx, hn::Mul(down_y, dy));
    const V straight_a = hn::Sub(hn::Mul(along_x, dy), hn::Mul(along_y, dx));
    const V straight_b = hn::Sub(hn::Mul(down_y, dx), hn::Mul(down_x, dy));
    const V bent_a = hn::NegMulAdd(half_bend_a, hn::Mul(ua, ua), hn::Sub(straight_a, blur_a));
    const V bent_b = hn::NegMulAdd(half_bend_b, hn::Mul(ub, ub), hn::Sub(straight_b, blur_b));
    const V a = hn::Mul(bent_a, wide_a);
    const V b = hn::Mul(bent_b, wide_b);
    const V shared = set(-dot(fit_.along, fit_.down));
    Saddle<V> saddle;
    if constexpr (kModel == Model::kParted) {
      saddle = parted_saddle(d, a, b, fit_.gain, wide_a, wide_b, shared);
    } else if constexpr (kModel == Model::kSharp) {
      const SharpEdge<V> edge_a(d, bent_a, kRoot / fit_.along_width, fit_.along.x, fit_.along.y);
      const SharpEdge<V> edge_b(d, bent_b, kRoot / fit_.down_width, fit_.down.x, fit_.down.y);
      saddle = sharp_saddle(d, edge_a, edge_b, shared);
    } else {
      saddle = plain_saddle(d, a, b, shared);
    }
    // Next to the corner, where both edges are blurred, blur moves bent edges further.
    constexpr float kCrossing = 0.35355339F;  // sqrt(2) / 4
    const V crossing = hn::MulAdd(set(kCrossing * fit_.along_bend * fit_.along_width), b,
                                  hn::Mul(set(kCrossing * fit_.down_bend * fit_.down_width), a));
    saddle.value = hn::NegMulAdd(saddle.both, crossing, saddle.value);
    const V local = hn::MulAdd(set(fit_.contrast_slope.x), dx,
                               hn::MulAdd(set(fit_.contrast_slope.y), dy, set(fit_.contrast)));
    const V base =
        hn::MulAdd(set(fit_.slope.x), dx, hn::MulAdd(set(fit_.slope.y), dy, set(fit_.level)));
    V error;
    const V in = weight(i, dx, dy, hn::MulAdd(local, saddle.value, base), error);
    e = hn::Mul(in, error);
    hn::StoreU(e, d, window_.error + i);
    square_ = hn::MulAdd(e, e, square_);
    const V scale = hn::Mul(in, local);
    const V by_a = hn::Mul(hn::Mul(scale, wide_a), saddle.by_a);
    const V by_b = hn::Mul(hn::Mul(scale, wide_b), saddle.by_b);
    j[kX] = hn::Sub(hn::Mul(by_a, along_y), hn::Mul(by_b, down_y));
    j[kY] = hn::Sub(hn::Mul(by_b, down_x), hn::Mul(by_a, along_x));
    const V turn = hn::Mul(hn::Mul(scale, saddle.shared), set(cross(fit_.along, fit_.down)));
    j[kAlong] = hn::NegMulSub(by_a, ua, turn);
    j[kDown] = hn::MulAdd(by_b, ub, turn);
    j[kLevel] = in;
    j[kContrast] = hn::Mul(in, saddle.value);
    j[kAlongWidth] = hn::Neg(hn::Mul(scale, saddle.width_a));
    j[kDownWidth] = hn::Neg(hn::Mul(scale, saddle.width_b));
    j[kGain] = hn::Mul(scale, saddle.gain);
  }

  [[nodiscard]] float square() const { return hn::GetLane(hn::SumOfLanes(d_, square_)); }
  [[nodiscard]] float count() const { return hn::GetLane(hn::SumOfLanes(d_, count_)); }

 private:
  // Returns the square roots of the weights, and the errors.
  HWY_INLINE V weight(int i, V dx, V dy, V model, V& error) {
    const D d = d_;
    const auto set = [d](float v) { return hn::Set(d, v); };
    // The last vectors may reach beyond the window. A white pixel is a lower bound only, a black
    // pixel an upper bound.
    const auto inside = hn::FirstN(d, static_cast<std::size_t>(std::max(window_.count - i, 0)));
    const V grey = hn::LoadU(d, window_.grey + i);
    const V below = hn::IfThenElse(hn::Ge(grey, set(kWhite)), hn::Min(model, grey), model);
    const V seen = hn::IfThenElse(hn::Le(grey, hn::Zero(d)), hn::Max(below, grey), below);
    const auto counted = hn::And(inside, hn::Eq(seen, model));
    error = hn::IfThenElseZero(counted, hn::Sub(grey, model));
    count_ = hn::Add(count_, hn::IfThenElseZero(counted, set(1)));
    // The disc is about the corner, not about a pixel: along its rim, which cuts pixels, the square
    // root of the weight falls from 1 to 0.
    const V square_distance = hn::MulAdd(dx, dx, hn::Mul(dy, dy));
    const V rim = hn::MulAdd(square_distance, set(-0.5F / radius_), set(0.5F * radius_ + 0.5F));
    return hn::IfThenElseZero(counted, hn::Min(hn::Max(rim, hn::Zero(d)), set(1)));
  }

  D d_;
  Window& window_;
  const SaddleFit& fit_;
  float radius_;
  float x_;
  float y_;
  V square_;
  V count_;
};

template <Model kModel, bool kWithProducts>
void accumulate_as(Window& window, const SaddleFit& fit, float radius, float x, float y,
                   Normal& normal) {
  constexpr int kFirst = kModel == Model::kParted ? 0 : 1;  // of the unknowns
  constexpr int kFrom = kWithProducts ? kFirst * kUnknowns : kProducts;
  using D = hn::ScalableTag<float>;
  using V = hn::Vec<D>;
  const D d;
  V products[kProducts];
  V gradient[kUnknowns];
  for (int k = kFrom; k < kProducts; ++k) products[k] = hn::Zero(d);
  for (V& g : gradient) g = hn::Zero(d);
  SaddleRows<kModel, D> rows(d, window, fit, radius, x, y);
  const auto lanes = static_cast<int>(hn::Lanes(d));
  for (int i = 0; i < window.count; i += kTogether * lanes) {
    V j[kTogether][kUnknowns];
    V e[kTogether];
    for (int k = 0; k < kTogether; ++k) rows.fill(i + k * lanes, j[k], e[k]);
    add_products<kFrom, kFirst>(j, e, products, gradient,
                                std::make_index_sequence<kProducts - kFrom>(),
                                std::make_index_sequence<kUnknowns - kFirst>());
  }
  sums_of_lanes(d, products + kFrom, kProducts - kFrom, normal.products + kFrom);
  sums_of_lanes(d, gradient + kFirst, kUnknowns - kFirst, normal.gradient + kFirst);
  normal.square = rows.square();
  normal.count = rows.count();
}

void accumulate(Window& window, const SaddleFit& fit, float radius, float x, float y, Sums sums,
                bool is_sharp, Normal& normal) {
  if (sums == Sums::kParted) {
    return accumulate_as<Model::kParted, true>(window, fit, radius, x, y, normal);
  }
  if (is_sharp) {
    return sums == Sums::kGradient
               ? accumulate_as<Model::kSharp, false>(window, fit, radius, x, y, normal)
               : accumulate_as<Model::kSharp, true>(window, fit, radius, x, y, normal);
  }
  return sums == Sums::kGradient
             ? accumulate_as<Model::kPlain, false>(window, fit, radius, x, y, normal)
             : accumulate_as<Model::kPlain, true>(window, fit, radius, x, y, normal);
}

}  // namespace calvin::detect::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace calvin::detect {

namespace {

HWY_EXPORT(accumulate);

}  // namespace

void accumulate(Window& window, const SaddleFit& fit, float radius, float x, float y, Sums sums,
                bool is_sharp, Normal& normal) noexcept {
  HWY_DYNAMIC_DISPATCH(accumulate)(window, fit, radius, x, y, sums, is_sharp, normal);
}

}  // namespace calvin::detect

#endif  // HWY_ONCE
