// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// When a code is believed: how unlikely it is that so many of its bits are right by chance.
#pragma once

#include <cmath>

namespace calvin::detect {

// nats: of as many wrong codes as e to this, none looks right by chance.
inline constexpr double kLeastEvidence = 9;
inline constexpr double kLeastRight = 0.8;  // of the bits; something may cover the others

// The exponent of Chernoff's bound, nats.
[[nodiscard]] inline double evidence_of(int seen, int right) {
  if (2 * right <= seen) return 0;
  const double p = right / static_cast<double>(seen);
  const double wrong = p < 1 ? (1 - p) * std::log(2 * (1 - p)) : 0;
  return seen * (p * std::log(2 * p) + wrong);
}

}  // namespace calvin::detect
