// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Cholesky factors of small matrices, row-major. A factor holds the reciprocals of its diagonal,
// because solving with it multiplies by them. Internal.
#pragma once

#include <cmath>

namespace calvin {

// The lower L with L L^T = m, whose diagonal is first multiplied by 1 + lambda; the lower triangles
// are read and written. False where m is not positive definite.
template <int kSize>
[[nodiscard]] bool cholesky_of(const double* m, double lambda, double* l) {
  for (int j = 0; j < kSize; ++j) {
    double pivot = m[j * kSize + j] * (1 + lambda);
    for (int k = 0; k < j; ++k) pivot -= l[j * kSize + k] * l[j * kSize + k];
    if (!(pivot > 0) || !std::isfinite(pivot)) return false;
    const double scale = 1 / std::sqrt(pivot);
    l[j * kSize + j] = scale;
    for (int i = j + 1; i < kSize; ++i) {
      double sum = m[i * kSize + j];
      for (int k = 0; k < j; ++k) sum -= l[i * kSize + k] * l[j * kSize + k];
      l[i * kSize + j] = sum * scale;
    }
  }
  return true;
}

// The factor of a block of an arrowhead problem: 6x6 (a pose) or 3x3 (a free point).
[[nodiscard]] inline bool cholesky(const double* m, int size, double lambda, double* l) {
  return size == 6 ? cholesky_of<6>(m, lambda, l) : size == 3 && cholesky_of<3>(m, lambda, l);
}

// x = L^-T x.
template <int kSize>
void solve_upper(const double* l, double* x) {
  for (int i = kSize - 1; i >= 0; --i) {
    for (int k = i + 1; k < kSize; ++k) x[i] -= l[k * kSize + i] * x[k];
    x[i] *= l[i * kSize + i];
  }
}

// x = L^-1 x.
template <int kSize>
void solve_lower(const double* l, double* x) {
  for (int i = 0; i < kSize; ++i) {
    for (int k = 0; k < i; ++k) x[i] -= l[i * kSize + k] * x[k];
    x[i] *= l[i * kSize + i];
  }
}

// x = L^-T x for a block of an arrowhead problem.
inline void solve_upper(const double* l, int size, double* x) {
  size == 6 ? solve_upper<6>(l, x) : solve_upper<3>(l, x);
}

}  // namespace calvin
