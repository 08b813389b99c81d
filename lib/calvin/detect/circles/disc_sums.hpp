// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The sums over a window of pixels from which the fit of a disc takes a step.
#pragma once

#include "calvin/detect/checkerboard/corners/fit_window.hpp"
#include "calvin/detect/circles/disc_fit.hpp"

namespace calvin::detect {

// The unknowns: the centre, the elements of the inverse of the ellipse's matrix in units that move
// the rim by about a px, the logarithm of the width, and the levels.
enum DiscUnknown {
  kDiscX,
  kDiscY,
  kDiscXX,
  kDiscXY,
  kDiscYY,
  kDiscWidth,
  kDiscInside,
  kDiscOutside,
  kDiscUnknowns
};
inline constexpr int kDiscProducts = kDiscUnknowns * (kDiscUnknowns + 1) / 2;

// J^T J (upper triangle, row by row), J^T e and e^T e.
struct DiscNormal {
  float products[kDiscProducts];
  float gradient[kDiscUnknowns];
  float square;
};

// Which sums are taken over a window.
enum class DiscSums { kAll, kGradient };

// (x, y) is the centre of the fit from the middle of the window. Writes the errors of the window's
// pixels too. `products` are left as they are where the gradient alone is wanted.
void accumulate_disc(Window& window, const DiscFit& fit, float x, float y, DiscSums sums,
                     DiscNormal& normal) noexcept;

}  // namespace calvin::detect
