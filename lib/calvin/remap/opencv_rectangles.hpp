// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What cv::getOptimalNewCameraMatrix() fits its views to. Internal.
#pragma once

#include "calvin/camera/camera.hpp"
#include "calvin/remap/projection.hpp"

namespace calvin {

// The 9 x 9 points that OpenCV looks at: before version 4.8 up to one column and one row further
// than the last pixels, and up to these since then.
enum class OpenCvGrid { kPastTheEdge, kPixels };

// That of the OpenCV that was there when the library was built, else the newer one.
[[nodiscard]] OpenCvGrid opencv_grid() noexcept;

// On the plane of a projection.
struct PlaneBox {
  Pixel low;
  Pixel high;
};
struct OpenCvRectangles {
  PlaneBox inner;  // within the picture of the border
  PlaneBox outer;  // around that of all points
};

// For the models that OpenCV has, with its inverse of the distortion, which stops after five steps
// and may be pixels off in the corners of a strong lens; for others with the inverse itself.
[[nodiscard]] OpenCvRectangles opencv_rectangles(const Camera& source, Projection projection,
                                                 OpenCvGrid grid);

}  // namespace calvin
