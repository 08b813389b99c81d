// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The factors L D L^T of a small symmetric matrix. A picture has a thousand steps of fits with
// eight unknowns or nine: loops whose lengths the compiler sees, and writes out, take a quarter of
// the time of others.
#pragma once

namespace calvin::detect {

template <typename T, int kSize>
class SmallFactor {
 public:
  // The index of an element of the diagonal in an upper triangle, row by row.
  static constexpr int diagonal(int row) { return row * kSize - row * (row - 1) / 2; }

  // Of a matrix given by its upper triangle, row by row. False where it is not positive definite.
  [[nodiscard]] bool compute(const T* upper) {
#pragma GCC unroll 16
    for (int col = 0; col < kSize; ++col) {
      const T* from = upper + diagonal(col);
      T share[kSize];  // of the columns before, in this one
      T pivot = from[0];
#pragma GCC unroll 16
      for (int k = 0; k < col; ++k) {
        share[k] = l_[k][col] * inverse_[k];
        pivot -= share[k] * l_[k][col];
      }
      if (!(pivot > 0)) return false;
      inverse_[col] = 1 / pivot;
#pragma GCC unroll 16
      for (int row = col + 1; row < kSize; ++row) {
        T element = from[row - col];
#pragma GCC unroll 16
        for (int k = 0; k < col; ++k) element -= share[k] * l_[k][row];
        l_[col][row] = element;
      }
    }
    return true;
  }

  // Solves for a right side, in its place.
  void solve(T* x) const {
#pragma GCC unroll 16
    for (int col = 0; col < kSize; ++col) {
      x[col] *= inverse_[col];
#pragma GCC unroll 16
      for (int row = col + 1; row < kSize; ++row) x[row] -= l_[col][row] * x[col];
    }
#pragma GCC unroll 16
    for (int row = kSize - 1; row > 0; --row) {
#pragma GCC unroll 16
      for (int col = row - 1; col >= 0; --col) x[col] -= l_[col][row] * inverse_[col] * x[row];
    }
  }

  // The mean of the last two elements of the diagonal of the inverse.
  [[nodiscard]] T mean_of_last_variances() const {
    const T share = l_[kSize - 2][kSize - 1] * inverse_[kSize - 2];
    return (inverse_[kSize - 2] + (share * share + 1) * inverse_[kSize - 1]) / 2;
  }

 private:
  T l_[kSize][kSize] = {};  // [column][row], of L D
  T inverse_[kSize] = {};   // of D
};

}  // namespace calvin::detect
