// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The verdict on a converged fit: whether its residuals are noise, and the likely cause if not.
#pragma once

#include <string>
#include <string_view>

#include "calvin/core/export.hpp"

namespace calvin {

// Why a fit may be worse than its covariance says, though it converged.
struct Misfit {
  enum class Cause {
    kNone,    // the residuals are noise
    kNoise,   // the residuals are larger than the detector's sigmas say
    kModel,   // residuals belong to places in the image: the lens is richer than the model
    kBoard,   // residuals belong to corners: the board is not flat, or not as it was printed
    kMotion,  // views contradict each other: the board moved or bent while it was seen
  };
  // Why the promise cannot be trusted, or had to grow to more than a pixel and by much.
  Cause cause = Cause::kNone;
  // What was found; where it is in the covariance and `cause` is none, a remark.
  Cause noticed = Cause::kNone;
  double lens_residual = 0;     // px: what residuals in parts of the picture have beyond noise
  double board_residual = 0;    // px: what residuals of the corners of a board have beyond noise
  double split_half_ratio = 1;  // `halves` of docs/conventions.md; 1 where one view has none

  [[nodiscard]] bool found() const { return cause != Cause::kNone; }
};

// "none", "noise", "model", "board", "motion"; and a sentence for the user, empty for kNone.
[[nodiscard]] CALVIN_API std::string_view to_string(Misfit::Cause cause);
[[nodiscard]] CALVIN_API std::string advice(Misfit::Cause cause);

}  // namespace calvin
