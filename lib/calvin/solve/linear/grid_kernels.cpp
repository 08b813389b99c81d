// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Sums over columns and over places, compiled for every kind of vector.

#include "calvin/solve/linear/grid_kernels.hpp"

#include "calvin/core/vector_targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "calvin/solve/linear/grid_kernels.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

#include "calvin/solve/linear/aligned.hpp"

HWY_BEFORE_NAMESPACE();
namespace calvin::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Whole = hn::CappedTag<double, kLanes>;
using One = hn::CappedTag<double, 1>;  // for what is left behind the last whole vector

// Calls visit(tag, first place) for all places.
template <typename Visit>
void for_places(std::size_t places, Visit visit) {
  std::size_t at = 0;
  for (; at + hn::Lanes(Whole()) <= places; at += hn::Lanes(Whole())) visit(Whole(), at);
  for (; at < places; ++at) visit(One(), at);
}

void add_products(const double* turn, const double* columns, std::size_t places, int count,
                  double* out) {
  for (int j = 0; j < count; ++j) {
    const double* column = columns + static_cast<std::size_t>(j) * places;
    double* to = out + 3 * static_cast<std::size_t>(j);
    const Whole d;
    hn::Vec<Whole> sums[3] = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    std::size_t at = 0;
    for (; at + hn::Lanes(d) <= places; at += hn::Lanes(d)) {
      const auto value = hn::LoadU(d, column + at);
      for (std::size_t i = 0; i < 3; ++i) {
        sums[i] = hn::MulAdd(hn::LoadU(d, turn + i * places + at), value, sums[i]);
      }
    }
    for (std::size_t i = 0; i < 3; ++i) {
      to[i] += hn::GetLane(hn::SumOfLanes(d, sums[i]));
      for (std::size_t rest = at; rest < places; ++rest) {
        to[i] += turn[i * places + rest] * column[rest];
      }
    }
  }
}

void subtract(const double* turn, const double* by, std::size_t places, int count,
              double* columns) {
  for_places(places, [&](auto d, std::size_t at) {
    const auto x = hn::LoadU(d, turn + at);
    const auto y = hn::LoadU(d, turn + places + at);
    const auto z = hn::LoadU(d, turn + 2 * places + at);
    for (int j = 0; j < count; ++j) {
      const double* factors = by + 3 * static_cast<std::size_t>(j);
      double* column = columns + static_cast<std::size_t>(j) * places + at;
      auto value = hn::LoadU(d, column);
      value = hn::NegMulAdd(hn::Set(d, factors[0]), x, value);
      value = hn::NegMulAdd(hn::Set(d, factors[1]), y, value);
      value = hn::NegMulAdd(hn::Set(d, factors[2]), z, value);
      hn::StoreU(value, d, column);
    }
  });
}

void covariances(const double* u, const double* v, std::size_t places, int count,
                 const double* covariance, double* uu, double* uv, double* vv) {
  for_places(places, [&](auto d, std::size_t at) {
    auto of_uu = hn::Zero(d);
    auto of_uv = hn::Zero(d);
    auto of_vv = hn::Zero(d);
    for (int j = 0; j < count; ++j) {
      const double* row = covariance + static_cast<std::size_t>(j) * count;
      const auto own_u = hn::LoadU(d, u + static_cast<std::size_t>(j) * places + at);
      const auto own_v = hn::LoadU(d, v + static_cast<std::size_t>(j) * places + at);
      // Half of the terms of the parameter by itself, all of those with the parameters before it.
      const auto half = hn::Set(d, row[j] / 2);
      auto sum_u = hn::Mul(half, own_u);
      auto sum_v = hn::Mul(half, own_v);
      for (int k = 0; k < j; ++k) {
        const auto factor = hn::Set(d, row[k]);
        const std::size_t other = static_cast<std::size_t>(k) * places + at;
        sum_u = hn::MulAdd(factor, hn::LoadU(d, u + other), sum_u);
        sum_v = hn::MulAdd(factor, hn::LoadU(d, v + other), sum_v);
      }
      of_uu = hn::MulAdd(sum_u, own_u, of_uu);
      of_vv = hn::MulAdd(sum_v, own_v, of_vv);
      of_uv = hn::MulAdd(sum_u, own_v, hn::MulAdd(sum_v, own_u, of_uv));
    }
    hn::StoreU(hn::Add(of_uu, of_uu), d, uu + at);
    hn::StoreU(of_uv, d, uv + at);
    hn::StoreU(hn::Add(of_vv, of_vv), d, vv + at);
  });
}

}  // namespace
}  // namespace calvin::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace calvin {

HWY_EXPORT(add_products);
HWY_EXPORT(subtract);
HWY_EXPORT(covariances);

void add_turn_products(const double* turn, const double* columns, std::size_t places, int count,
                       double* out) {
  HWY_DYNAMIC_DISPATCH(add_products)(turn, columns, places, count, out);
}

void subtract_turns(const double* turn, const double* by, std::size_t places, int count,
                    double* columns) {
  HWY_DYNAMIC_DISPATCH(subtract)(turn, by, places, count, columns);
}

void project_covariance(const double* u, const double* v, std::size_t places, int count,
                        const double* covariance, double* uu, double* uv, double* vv) {
  HWY_DYNAMIC_DISPATCH(covariances)(u, v, places, count, covariance, uu, uv, vv);
}

}  // namespace calvin
#endif
