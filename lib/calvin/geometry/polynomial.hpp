// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Roots of small real polynomials.
#pragma once

#include <span>

namespace calvin {

// The smallest s > 0 with c[0] + c[1] s + c[2] s^2 + ... = 0; infinity where there is none.
// A root at which the sign does not change, such as a double one, does not count.
[[nodiscard]] double smallest_positive_root(std::span<const double> coefficients);

}  // namespace calvin
