// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Convex hulls of points in an image.
#pragma once

#include <vector>

#include "calvin/core/image.hpp"

namespace calvin {

// The corners of the convex hull, px, clockwise as seen in the image (y down), without collinear
// ones (A. M. Andrew, Another Efficient Algorithm for Convex Hulls, IPL 9(5), 1979). Fewer than
// three where the points lie on one line. Points must be finite.
[[nodiscard]] std::vector<Pixel> convex_hull(std::vector<Pixel> points);

// Area of a simple polygon, px^2, positive for the order that convex_hull() gives.
[[nodiscard]] double polygon_area(const std::vector<Pixel>& polygon) noexcept;

// Whether a point lies in a convex polygon (its border included) ordered as convex_hull() does.
[[nodiscard]] bool contains(const std::vector<Pixel>& polygon, Pixel point) noexcept;

}  // namespace calvin
