// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The rectangles that cv::getOptimalNewCameraMatrix() fits its views to. Internal.
#pragma once

#include "calvin/camera/camera.hpp"
#include "calvin/remap/projection.hpp"

namespace calvin {

// The 9 x 9 points that OpenCV looks at: before version 4.8 up to one column and one row further
// than the last pixels, and up to these since then.
enum class OpenCvGrid { kPastTheEdge, kPixels };

// The grid of the OpenCV that the library was built with; without one, that of 4.8 and newer.
[[nodiscard]] OpenCvGrid opencv_grid() noexcept;

struct OpenCvRectangles {
  PlaneBox inner;  // within the border of the grid
  PlaneBox outer;  // around all points of the grid
};

// The rectangles of a camera. Models that OpenCV has are inverted as OpenCV does it: it stops after
// five steps and may be pixels off in the corners of a strong lens. Others are inverted exactly.
[[nodiscard]] OpenCvRectangles opencv_rectangles(const Camera& source, Projection projection,
                                                 OpenCvGrid grid);

}  // namespace calvin
