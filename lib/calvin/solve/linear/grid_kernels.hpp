// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The arithmetic of a grid of places, by the widest vectors of the machine. Internal.
//
// What belongs to a grid is in columns with a value for each of its `places`; a column follows the
// one before it without a gap.
#pragma once

#include <cstddef>

namespace calvin {

// Adds the scalar product of the i-th of three columns `turn` with the j-th of `count` columns to
// out[3 * j + i].
void add_turn_products(const double* turn, const double* columns, std::size_t places, int count,
                       double* out);

// Takes the sum of by[3 * j + i] times the i-th of three columns `turn` from the j-th of `count`
// columns.
void subtract_turns(const double* turn, const double* by, std::size_t places, int count,
                    double* columns);

// The covariance of (u, v) at each place: `u` and `v` have a column of derivatives for each of
// `count` parameters, whose symmetric covariance is given column by column.
void project_covariance(const double* u, const double* v, std::size_t places, int count,
                        const double* covariance, double* uu, double* uv, double* vv);

}  // namespace calvin
