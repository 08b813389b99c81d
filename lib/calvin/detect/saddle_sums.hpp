// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The sums over a window of pixels from which a saddle's fit takes a step.
#pragma once

#include "calvin/detect/fit_window.hpp"
#include "calvin/detect/saddle_fit.hpp"

namespace calvin::detect {

// The unknowns, in this order: the gain, where there is one; the widths by their logarithms, the
// directions by angles. The place comes last, so that its covariance is to be had from the last of
// the triangular factor.
enum Unknown {
  kGain,
  kAlong,
  kDown,
  kLevel,
  kContrast,
  kAlongWidth,
  kDownWidth,
  kX,
  kY,
  kUnknowns
};
inline constexpr int kProducts = kUnknowns * (kUnknowns + 1) / 2;

// What is summed over a window: for a saddle with a gain, for one without, or for the latter the
// gradient alone.
enum class Sums { kParted, kPlain, kGradient };

// J^T W J (upper triangle, row by row), J^T W e and e^T W e. Where there is no gain its numbers are
// left as they are.
struct Normal {
  float products[kProducts];
  float gradient[kUnknowns];
  float square;
  float count;  // of pixels that tell something
};

// Of the diagonal in Normal::products.
constexpr int diagonal(int unknown) { return unknown * kUnknowns - unknown * (unknown - 1) / 2; }

// `x`, `y`: of the fit's corner from the window's middle. The errors of the window's pixels are
// written too.
void accumulate(Window& window, const SaddleFit& fit, float radius, float x, float y, Sums sums,
                Normal& normal) noexcept;

}  // namespace calvin::detect
