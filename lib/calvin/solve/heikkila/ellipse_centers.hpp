// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Round dots of which the centres of their images were measured. Internal.
//
// The image of a circle's centre is not the centre of the circle's image: J. Heikkila, Geometric
// Camera Calibration Using Circular Control Points, PAMI 22(10), 2000. His toolbox takes the offset
// from the conic before a pinhole, which is conic_bias(); solve() takes that of the disc through
// the whole lens, center_bias().
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/core/image.hpp"
#include "calvin/core/result.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/solve/solution.hpp"
#include "calvin/solve/view.hpp"

namespace calvin {

struct Disc {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();   // m, board frame
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // of length 1
  double diameter = 0;                                // m
};

// The centroid of the image of a disc less the image of its centre, px. Absent where a part of it
// is not seen.
[[nodiscard]] std::optional<Pixel> center_bias(const Camera& camera, const SE3& camera_from_board,
                                               const Disc& disc);

// The same before a pinhole of this focal length: the centre of the conic, px. The distortion is
// left out, as Heikkila and Silven do (1997). Absent where the disc is not all before the camera.
[[nodiscard]] std::optional<Pixel> conic_bias(const Camera& camera, const SE3& camera_from_board,
                                              const Disc& disc);

using DiscBias = std::optional<Pixel> (*)(const Camera&, const SE3&, const Disc&);

// kInvalidArgument unless every view is of dots with a diameter, which lie in the plane z = 0 or
// have normals.
[[nodiscard]] Status have_diameters(std::span<const View> views);

// The views with the images of the centres in place of the centres of the images, as the poses of a
// solution have them; views that it has no pose of stay as they are.
[[nodiscard]] std::vector<View> without_center_bias(std::span<const View> views,
                                                    const Solution& solution,
                                                    DiscBias bias = center_bias);

}  // namespace calvin
