// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Dots as discorpy places them: centres of mass of what is beyond a threshold. Its published
// numbers are those of these places, which are coarser than what the detector of grids finds.
// Internal.
#pragma once

#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/core/observation.hpp"

namespace calvin::detect {

struct ThresholdedDot {
  Pixel center;     // px
  double area = 0;  // px^2
};

// The steps of discorpy's prep.binarization() and of its choice by size and shape: a median of 2 x
// 2 px, by which all places are half a pixel farther from the top left than what is seen there; the
// threshold of N. Otsu (IEEE Trans. SMC 9(1), 1979) of the middle of the picture; what touches the
// border, stands out by one pixel or is a hole goes; areas within 30 % of the median of the middle,
// axes within 30 % of each other. Dots may be dark or bright.
[[nodiscard]] std::vector<ThresholdedDot> thresholded_dots(const ImageView& image);

// The observation with each point at the thresholded dot that it lies in, those in none left out.
[[nodiscard]] Observation at_thresholded_dots(const ImageView& image, const Observation& seen);

}  // namespace calvin::detect
