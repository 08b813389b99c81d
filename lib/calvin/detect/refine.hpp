// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Corners to a fraction of a pixel.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "calvin/detect/grid.hpp"

namespace calvin::detect {

// Moves the corners of a grid to where the edges meet in the 8-bit image, and tells their 1 sigma
// in px. False where many of them do not stay near their first place: then they were no corners. A
// single one that runs away keeps its first place. May throw cv::Exception.
[[nodiscard]] bool refine(const cv::Mat& sharp, Grid& grid, std::vector<double>& sigma);

}  // namespace calvin::detect
