// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Products of columns and triangular solves, compiled for every kind of vector.

#include "calvin/solve/linear/products.hpp"

#include "calvin/core/vector_targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "calvin/solve/linear/products.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

#include <algorithm>

#include "calvin/solve/linear/aligned.hpp"

HWY_BEFORE_NAMESPACE();
namespace calvin::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<double, kLanes>;
using V = hn::Vec<D>;

constexpr int kTile = 4;

#if HWY_TARGET != HWY_SCALAR
// The sums over the lanes of four vectors: two by two they are folded into one, whose 128-bit
// blocks are then added up.
void store_sums(const V* sums, double* out) {
  const D d;
  const hn::CappedTag<double, 2> pair;
  for (int j = 0; j < kTile; j += 2) {
    const V folded = hn::Add(hn::InterleaveLower(d, sums[j], sums[j + 1]),
                             hn::InterleaveUpper(d, sums[j], sums[j + 1]));
    HWY_ALIGN double lanes[kLanes];
    hn::Store(folded, d, lanes);
    auto total = hn::Load(pair, lanes);
    for (std::size_t k = 2; k < hn::Lanes(d); k += 2) {
      total = hn::Add(total, hn::Load(pair, lanes + k));
    }
    hn::StoreU(total, pair, out + j);
  }
}
#endif

// kRows x kColumns products at once: every vector that is loaded serves several of them.
template <int kRows, int kColumns>
void tile(const double* a, const double* b, std::size_t n, double* out, std::size_t stride) {
  const D d;
  V sums[kRows * kColumns];
#pragma GCC unroll 16
  for (int i = 0; i < kRows * kColumns; ++i) sums[i] = hn::Zero(d);
  for (std::size_t at = 0; at < n; at += hn::Lanes(d)) {
    V x[kRows];
    V y[kColumns];
#pragma GCC unroll 4
    for (int i = 0; i < kRows; ++i) x[i] = hn::Load(d, a + static_cast<std::size_t>(i) * n + at);
#pragma GCC unroll 4
    for (int j = 0; j < kColumns; ++j) {
      y[j] = hn::Load(d, b + static_cast<std::size_t>(j) * n + at);
    }
#pragma GCC unroll 16
    for (int i = 0; i < kRows * kColumns; ++i) {
      sums[i] = hn::MulAdd(x[i / kColumns], y[i % kColumns], sums[i]);
    }
  }
  for (int i = 0; i < kRows; ++i) {
    double* line = out + static_cast<std::size_t>(i) * stride;
#if HWY_TARGET != HWY_SCALAR
    if constexpr (kColumns == kTile) {
      store_sums(sums + i * kTile, line);
      continue;
    }
#endif
    for (int j = 0; j < kColumns; ++j)
      line[j] = hn::GetLane(hn::SumOfLanes(d, sums[i * kColumns + j]));
  }
}

template <int kRows>
void tile_row(const double* a, std::size_t n, int row, int count, double* out, std::size_t stride) {
  const double* rows = a + static_cast<std::size_t>(row) * n;
  double* line = out + static_cast<std::size_t>(row) * stride;
  for (int j = 0; j < row + kRows; j += kTile) {
    const double* columns = a + static_cast<std::size_t>(j) * n;
    switch (std::min(kTile, count - j)) {
      case 4:
        tile<kRows, 4>(rows, columns, n, line + j, stride);
        break;
      case 3:
        tile<kRows, 3>(rows, columns, n, line + j, stride);
        break;
      case 2:
        tile<kRows, 2>(rows, columns, n, line + j, stride);
        break;
      default:
        tile<kRows, 1>(rows, columns, n, line + j, stride);
    }
  }
}

void products(const double* a, std::size_t n, int count, double* out, std::size_t stride) {
  int row = 0;
  for (; row + kTile <= count; row += kTile) tile_row<kTile>(a, n, row, count, out, stride);
  switch (count - row) {
    case 3:
      return tile_row<3>(a, n, row, count, out, stride);
    case 2:
      return tile_row<2>(a, n, row, count, out, stride);
    case 1:
      return tile_row<1>(a, n, row, count, out, stride);
    default:
      return;
  }
}

void solve_lower(const double* lower, int size, double* x, std::size_t stride, std::size_t n) {
  const D d;
  for (std::size_t at = 0; at < n; at += hn::Lanes(d)) {
    for (int i = 0; i < size; ++i) {
      double* row = x + static_cast<std::size_t>(i) * stride + at;
      V sum = hn::Load(d, row);
      for (int k = 0; k < i; ++k) {
        const V other = hn::Load(d, x + static_cast<std::size_t>(k) * stride + at);
        sum = hn::NegMulAdd(hn::Set(d, lower[i * size + k]), other, sum);
      }
      hn::Store(hn::Mul(sum, hn::Set(d, lower[i * size + i])), d, row);
    }
  }
}

// As many rows at once: every vector that is loaded serves all of them.
template <int kRows>
void subtract_from_rows(const double* x, int size, std::size_t stride, std::size_t row, double* s) {
  const D d;
  for (std::size_t at = 0; at < row + kRows; at += hn::Lanes(d)) {
    V sums[kRows];
#pragma GCC unroll 4
    for (std::size_t i = 0; i < kRows; ++i) sums[i] = hn::Load(d, s + (row + i) * stride + at);
    for (int k = 0; k < size; ++k) {
      const double* line = x + static_cast<std::size_t>(k) * stride;
      const V values = hn::Load(d, line + at);
#pragma GCC unroll 4
      for (std::size_t i = 0; i < kRows; ++i) {
        sums[i] = hn::NegMulAdd(hn::Set(d, line[row + i]), values, sums[i]);
      }
    }
#pragma GCC unroll 4
    for (std::size_t i = 0; i < kRows; ++i) hn::Store(sums[i], d, s + (row + i) * stride + at);
  }
}

void subtract(const double* x, int size, std::size_t stride, std::size_t n, double* s) {
  std::size_t row = 0;
  for (; row + kTile <= n; row += kTile) subtract_from_rows<kTile>(x, size, stride, row, s);
  for (; row < n; ++row) subtract_from_rows<1>(x, size, stride, row, s);
}

}  // namespace
}  // namespace calvin::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace calvin {

HWY_EXPORT(products);
HWY_EXPORT(solve_lower);
HWY_EXPORT(subtract);

void column_products(const double* a, std::size_t n, int count, double* out, std::size_t stride) {
  HWY_DYNAMIC_DISPATCH(products)(a, n, count, out, stride);
}

void solve_lower_rows(const double* lower, int size, double* x, std::size_t stride, std::size_t n) {
  HWY_DYNAMIC_DISPATCH(solve_lower)(lower, size, x, stride, n);
}

void subtract_products(const double* x, int size, std::size_t stride, std::size_t n, double* s) {
  HWY_DYNAMIC_DISPATCH(subtract)(x, size, stride, n, s);
}

}  // namespace calvin
#endif
