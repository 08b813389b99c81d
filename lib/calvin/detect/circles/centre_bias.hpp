// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How far the centre of an ellipse is from the image of the disc's centre.
//
// J. Heikkila, "Geometric Camera Calibration Using Circular Control Points", PAMI 22(10), 2000,
// takes it from the camera and the board's pose by a formula, J. Kannala and S. Brandt, "A Generic
// Camera Model and Calibration Method", PAMI 28(8), 2006, by an integral over the disc. Here the
// rim of the disc is taken through any map and an ellipse is fitted to its image, as one was to the
// picture.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "calvin/detect/circles/ellipse.hpp"
#include "calvin/detect/maps/lens_map.hpp"

namespace calvin::detect {

// The centre of the ellipse as which the map shows a disc about a point of the plane, less the
// image of that point, px; the disc has the size that the ellipse has. Absent where the map has no
// such disc.
[[nodiscard]] std::optional<Eigen::Vector2d> centre_bias(const LensMap& map, const Pixel& at,
                                                         const Ellipse& seen);

}  // namespace calvin::detect
