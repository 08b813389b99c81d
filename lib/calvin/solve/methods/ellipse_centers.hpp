// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Round dots of which the centres of their images were measured. Internal.
//
// The image of a circle's centre is not the centre of the circle's image: J. Heikkila, Geometric
// Camera Calibration Using Circular Control Points, PAMI 22(10), 2000. He takes the offset from the
// conic of a pinhole; here it is that of the disc through the whole lens.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "calvin/camera/camera.hpp"
#include "calvin/core/image.hpp"
#include "calvin/core/result.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/solve/solution.hpp"
#include "calvin/solve/view.hpp"

namespace calvin {

// The centroid of the image of a disc less the image of its centre, px. The disc lies in the plane
// z = const of the board frame, `center` and `diameter` are m. Absent where a part of it is not
// seen.
[[nodiscard]] std::optional<Pixel> center_bias(const Camera& camera, const SE3& camera_from_board,
                                               const Eigen::Vector3d& center, double diameter);

// kInvalidArgument unless every view is of dots with a diameter that lie in the plane z = 0.
[[nodiscard]] Status have_diameters(std::span<const View> views);

// The views with the images of the centres in place of the centres of the images, as the poses of a
// solution have them; views that it has no pose of stay as they are.
[[nodiscard]] std::vector<View> without_center_bias(std::span<const View> views,
                                                    const Solution& solution);

}  // namespace calvin
