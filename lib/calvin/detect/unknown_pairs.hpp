// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which unknowns each element of the upper triangle of normal equations is of, row by row.
#pragma once

namespace calvin::detect {

template <int kUnknowns>
struct UnknownPairs {
  static constexpr int kProducts = kUnknowns * (kUnknowns + 1) / 2;
  int first[kProducts] = {};
  int second[kProducts] = {};

  constexpr UnknownPairs() {
    int k = 0;
    for (int p = 0; p < kUnknowns; ++p) {
      for (int q = p; q < kUnknowns; ++q, ++k) {
        first[k] = p;
        second[k] = q;
      }
    }
  }
};

}  // namespace calvin::detect
