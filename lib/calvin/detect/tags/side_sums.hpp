// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The sums over the pixels along a side of a tag from which its fit takes a step.
#pragma once

#include "calvin/detect/tags/side_lines.hpp"

namespace calvin::detect {

enum SideUnknown {
  kSideOffset,
  kSideSlope,
  kSideWidth,  // its logarithm
  kSideIn,
  kSideInSlope,
  kSideOut,
  kSideOutSlope,
  kSideBend,
  kSideUnknowns
};
inline constexpr int kSideProducts = kSideUnknowns * (kSideUnknowns + 1) / 2;

// The numbers of side_fit.hpp; an edge beside the side is at + slope t.
struct SideModel {
  float offset = 0;
  float slope = 0;
  float bend = 0;
  float width = 0.8F;
  float in = 0;
  float in_slope = 0;
  float out = 0;
  float out_slope = 0;
  float border[2] = {0, 0};
  float second[2] = {0, 0};
  float gap[2] = {0, 0};
};

// J^T J (upper triangle, row by row), J^T e and e^T e, over the pixels with a weight.
struct SideNormal {
  float products[kSideProducts];
  float gradient[kSideUnknowns];
  float square;
};

// Which sums are taken.
enum class SideSums { kAll, kGradient };

// Writes the errors of all pixels, too. `products` are left as they are where the gradient alone is
// wanted.
void accumulate_side(SidePixels& pixels, const SideModel& model, SideSums sums,
                     SideNormal& normal) noexcept;

}  // namespace calvin::detect
