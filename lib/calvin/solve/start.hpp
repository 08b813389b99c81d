// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where a solve begins: guesses of the camera from the views alone. Internal.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/solve/points.hpp"

namespace calvin {

// fx fy cx cy, px; no distortion.
using Guess = std::array<double, 4>;

// Pixel coordinates of the centre of the image.
[[nodiscard]] inline Pixel image_center(ImageSize size) {
  return {(size.width - 1) / 2.0, (size.height - 1) / 2.0};
}

// From the homographies of the views, for lenses near enough to a pinhole: Zhang's closed form,
// and with the principal point at the centre of the image, the focal length by least squares over
// all views and the median over single ones (which a wrong view does not move). Those of the three
// whose signs and sizes are possible; OpenCV's initCameraMatrix2D takes roots of absolute values
// instead and so returns a wrong camera where it should fail.
[[nodiscard]] std::vector<Guess> closed_form_guesses(std::span<const PointSet> views,
                                                     ImageSize size);

// Focal lengths from very wide to tele, principal point at the centre; `perspective` leaves out
// what no perspective lens has.
[[nodiscard]] std::vector<Guess> focal_grid(ImageSize size, bool perspective);

}  // namespace calvin
