// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The sums over a window of pixels from which a saddle's fit takes a step.
#pragma once

#include "calvin/detect/checkerboard/corners/fit_window.hpp"
#include "calvin/detect/checkerboard/corners/saddle_fit.hpp"
#include "calvin/detect/small_factor.hpp"

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

// Which sums are taken over a window: those of a saddle with a gain, those of a saddle without, or
// of the latter the gradient alone.
enum class Sums { kParted, kPlain, kGradient };

// J^T W J (upper triangle, row by row), J^T W e and e^T W e. Numbers of a gain that is not
// estimated are left as they are.
struct Normal {
  float products[kProducts];
  float gradient[kUnknowns];
  float square;
  float count;  // of pixels that are not cut off at white or black
};

// The index of a diagonal element in Normal::products.
constexpr int diagonal(int unknown) { return SmallFactor<float, kUnknowns>::diagonal(unknown); }

// Sums over a window; (x, y) is the corner of the fit from the middle of the window. Writes the
// errors of the window's pixels too. `is_sharp`: pixels are squares, not points, where the saddle
// has no gain.
void accumulate(Window& window, const SaddleFit& fit, float radius, float x, float y, Sums sums,
                bool is_sharp, Normal& normal) noexcept;

}  // namespace calvin::detect
