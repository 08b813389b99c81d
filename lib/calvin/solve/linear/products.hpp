// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The inner loops of the least squares, by the widest vectors of the machine. Internal.
#pragma once

#include <cstddef>

namespace calvin {

// The scalar products of columns with each other. Column i starts at a + i * n; n is a multiple of
// kLanes, a is aligned. out(i, j) is at out + i * stride + j, for j <= i and within the 4x4 tiles
// on the diagonal; `count` is the number of columns.
void column_products(const double* a, std::size_t n, int count, double* out, std::size_t stride);

// x = L^-1 x for a lower L of size x size, row-major, its diagonal as reciprocals. x has `size`
// rows, `stride` apart, of `n` values and what the last vector holds behind them; stride is a
// multiple of kLanes, x is aligned.
void solve_lower_rows(const double* lower, int size, double* x, std::size_t stride, std::size_t n);

// s -= x^T x over the lower triangle and some of what is above it; s is n x n with the same stride
// as x, a multiple of kLanes.
void subtract_products(const double* x, int size, std::size_t stride, std::size_t n, double* s);

}  // namespace calvin
