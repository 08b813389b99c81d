// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The normal equations of the edges along a side of a tag, a vector of pixels at a time.

#include "calvin/core/vector_targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "calvin/detect/tags/side_sums.cpp"
#include <hwy/foreach_target.h>
// The order matters: Highway includes this file again for each target from the line above.
#include <hwy/highway.h>
// Included once for each target, too.
#include "calvin/detect/error_function-inl.hpp"
#include "calvin/detect/lane_sums-inl.hpp"

#include <algorithm>
#include <utility>

#include "calvin/detect/tags/side_sums.hpp"
#include "calvin/detect/unknown_pairs.hpp"

HWY_BEFORE_NAMESPACE();
namespace calvin::detect::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

inline constexpr UnknownPairs<kSideUnknowns> kSidePairs;

// What edges make of a pixel: their sum, and its derivatives by the place across the side and by
// the logarithm of the width.
template <class V>
struct Edges {
  V value;
  V by_place;
  V by_width;

  // Adds an edge of a height at a distance of the pixel.
  template <class D>
  HWY_INLINE void add(D d, V height, V distance, V scale) {
    const V half = hn::Set(d, 0.5F);
    const V x = hn::Mul(distance, scale);
    const ErrorFunction<V> error(d, x);
    V slope;
    // A step of Newton's makes a quick inverse of at least 8 bits one of twice as many.
    const V near = hn::ApproximateReciprocal(error.p);
    const V inverse = hn::Mul(near, hn::NegMulAdd(near, error.p, hn::Set(d, 2)));
    const V edge = error.value(d, x, inverse, slope);
    value = hn::MulAdd(height, hn::MulAdd(half, edge, half), value);
    const V steep = hn::Mul(hn::Mul(height, half), hn::Mul(slope, scale));
    by_place = hn::Add(by_place, steep);
    by_width = hn::NegMulAdd(steep, distance, by_width);
  }
};

// Row `i` of J and the following ones, and their errors.
template <class D, class V>
HWY_INLINE void side_rows(D d, SidePixels& pixels, const SideModel& m, int i, V* j, V& e) {
  const auto set = [d](float v) { return hn::Set(d, v); };
  const auto load = [&](const std::vector<float>& from) { return hn::LoadU(d, from.data() + i); };
  const V t = load(pixels.t);
  const V bent = hn::NegMulAdd(t, t, set(1));
  const V line = hn::MulAdd(set(m.slope), t, set(m.offset));
  const V s = hn::Sub(load(pixels.n), hn::MulAdd(set(m.bend), bent, line));
  const V first = pixels.rows > 0 ? load(pixels.first) : hn::Zero(d);
  const V second = pixels.rows > 1 ? load(pixels.second) : first;
  const V scale = set(0.70710678F / m.width);
  const auto from = [&](const float* edge) {
    return hn::Sub(s, hn::MulAdd(set(edge[1]), t, set(edge[0])));
  };
  Edges<V> edges{second, hn::Zero(d), hn::Zero(d)};
  edges.add(d, set(1), s, scale);
  if (pixels.rows > 0) edges.add(d, hn::Neg(first), from(m.border), scale);
  if (pixels.rows > 1) edges.add(d, hn::Sub(first, second), from(m.second), scale);
  if (pixels.has_beyond) edges.add(d, hn::Neg(load(pixels.beyond)), from(m.gap), scale);
  const V in = hn::MulAdd(set(m.in_slope), t, set(m.in));
  const V contrast = hn::Sub(hn::MulAdd(set(m.out_slope), t, set(m.out)), in);
  const V model = hn::MulAdd(contrast, edges.value, in);
  // The last vector may reach beyond the pixels: there no pixel has a weight.
  const V weight = load(pixels.weight);
  const V error = hn::Sub(load(pixels.grey), model);
  hn::StoreU(error, d, pixels.error.data() + i);
  e = hn::Mul(error, weight);
  const V by_place = hn::Mul(weight, hn::Mul(contrast, edges.by_place));
  const V outside = hn::Mul(weight, edges.value);
  j[kSideOffset] = hn::Neg(by_place);
  j[kSideSlope] = hn::Neg(hn::Mul(by_place, t));
  j[kSideWidth] = hn::Mul(weight, hn::Mul(contrast, edges.by_width));
  j[kSideIn] = hn::Sub(weight, outside);
  j[kSideInSlope] = hn::Mul(hn::Sub(weight, outside), t);
  j[kSideOut] = outside;
  j[kSideOutSlope] = hn::Mul(outside, t);
  j[kSideBend] = hn::Neg(hn::Mul(by_place, bent));
}

// Two vectors of pixels are summed at a time: there are more sums than registers.
inline constexpr int kSideTogether = 2;

template <class V, std::size_t... K, std::size_t... P>
HWY_INLINE void add_side(const V (*j)[kSideUnknowns], const V* e, [[maybe_unused]] V* products,
                         V* gradient, std::index_sequence<K...> /*k*/,
                         std::index_sequence<P...> /*p*/) {
  ((products[K] =
        hn::MulAdd(j[1][kSidePairs.first[K]], j[1][kSidePairs.second[K]],
                   hn::MulAdd(j[0][kSidePairs.first[K]], j[0][kSidePairs.second[K]], products[K]))),
   ...);
  ((gradient[P] = hn::MulAdd(j[1][P], e[1], hn::MulAdd(j[0][P], e[0], gradient[P]))), ...);
}

template <int kSummed>  // of the products: all or none
void accumulate_side_of(SidePixels& pixels, const SideModel& model, SideNormal& normal) {
  using D = hn::ScalableTag<float>;
  using V = hn::Vec<D>;
  const D d;
  V products[kSideProducts];
  V gradient[kSideUnknowns];
  for (int k = 0; k < kSummed; ++k) products[k] = hn::Zero(d);
  for (V& g : gradient) g = hn::Zero(d);
  V square = hn::Zero(d);
  const auto lanes = static_cast<int>(hn::Lanes(d));
  for (int i = 0; i < pixels.count; i += kSideTogether * lanes) {
    V j[kSideTogether][kSideUnknowns];
    V e[kSideTogether];
    for (int k = 0; k < kSideTogether; ++k) {
      side_rows(d, pixels, model, i + k * lanes, j[k], e[k]);
      square = hn::MulAdd(e[k], e[k], square);
    }
    add_side(j, e, products, gradient, std::make_index_sequence<kSummed>(),
             std::make_index_sequence<kSideUnknowns>());
  }
  sums_of_lanes(d, products, kSummed, normal.products);
  sums_of_lanes(d, gradient, kSideUnknowns, normal.gradient);
  normal.square = hn::GetLane(hn::SumOfLanes(d, square));
}

void accumulate_side(SidePixels& pixels, const SideModel& model, SideSums sums,
                     SideNormal& normal) {
  return sums == SideSums::kGradient ? accumulate_side_of<0>(pixels, model, normal)
                                     : accumulate_side_of<kSideProducts>(pixels, model, normal);
}

}  // namespace calvin::detect::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace calvin::detect {

namespace {

HWY_EXPORT(accumulate_side);

}  // namespace

void accumulate_side(SidePixels& pixels, const SideModel& model, SideSums sums,
                     SideNormal& normal) noexcept {
  HWY_DYNAMIC_DISPATCH(accumulate_side)(pixels, model, sums, normal);
}

}  // namespace calvin::detect

#endif  // HWY_ONCE
