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
    const V edge = error.value(d, x, hn::Div(hn::Set(d, 1), error.p), slope);
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
  const V first = load(pixels.first);
  const V second = load(pixels.second);
  const V scale = set(0.70710678F / m.width);
  const auto from = [&](const float* edge) {
    return hn::Sub(s, hn::MulAdd(set(edge[1]), t, set(edge[0])));
  };
  Edges<V> edges{second, hn::Zero(d), hn::Zero(d)};
  edges.add(d, set(1), s, scale);
  edges.add(d, hn::Neg(first), from(m.border), scale);
  edges.add(d, hn::Sub(first, second), from(m.second), scale);
  if (m.beyond != 0) edges.add(d, set(-m.beyond), from(m.gap), scale);
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

template <class V, std::size_t... K, std::size_t... P>
HWY_INLINE void add_side(const V* j, V e, V* products, V* gradient, std::index_sequence<K...> /*k*/,
                         std::index_sequence<P...> /*p*/) {
  ((products[K] = hn::MulAdd(j[kSidePairs.first[K]], j[kSidePairs.second[K]], products[K])), ...);
  ((gradient[P] = hn::MulAdd(j[P], e, gradient[P])), ...);
}

void accumulate_side(SidePixels& pixels, const SideModel& model, SideNormal& normal) {
  using D = hn::ScalableTag<float>;
  using V = hn::Vec<D>;
  const D d;
  V products[kSideProducts];
  V gradient[kSideUnknowns];
  for (V& p : products) p = hn::Zero(d);
  for (V& g : gradient) g = hn::Zero(d);
  V square = hn::Zero(d);
  const auto lanes = static_cast<int>(hn::Lanes(d));
  for (int i = 0; i < pixels.count; i += lanes) {
    V j[kSideUnknowns];
    V e;
    side_rows(d, pixels, model, i, j, e);
    square = hn::MulAdd(e, e, square);
    add_side(j, e, products, gradient, std::make_index_sequence<kSideProducts>(),
             std::make_index_sequence<kSideUnknowns>());
  }
  for (int k = 0; k < kSideProducts; ++k) {
    normal.products[k] = hn::GetLane(hn::SumOfLanes(d, products[k]));
  }
  for (int p = 0; p < kSideUnknowns; ++p) {
    normal.gradient[p] = hn::GetLane(hn::SumOfLanes(d, gradient[p]));
  }
  normal.square = hn::GetLane(hn::SumOfLanes(d, square));
}

}  // namespace calvin::detect::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace calvin::detect {

namespace {

HWY_EXPORT(accumulate_side);

constexpr std::size_t kLongestVector = 64;  // lanes

}  // namespace

void SidePixels::clear() {
  count = 0;
  for (auto* numbers : {&t, &n, &grey, &first, &second, &weight, &error}) numbers->clear();
}

void SidePixels::add(float along, float across, float level) {
  t.push_back(along);
  n.push_back(across);
  grey.push_back(level);
  ++count;
}

void SidePixels::finish() {
  const auto used = static_cast<std::size_t>(count);
  weight.assign(used, 1);
  for (auto* numbers : {&t, &n, &grey, &first, &second, &weight, &error}) {
    numbers->resize(used + kLongestVector, 0);
  }
}

void accumulate_side(SidePixels& pixels, const SideModel& model, SideNormal& normal) noexcept {
  HWY_DYNAMIC_DISPATCH(accumulate_side)(pixels, model, normal);
}

}  // namespace calvin::detect

#endif  // HWY_ONCE
