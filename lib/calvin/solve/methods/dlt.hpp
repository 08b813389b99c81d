// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The direct linear transformation: a camera from each view of points in space. Internal.
#pragma once

#include "calvin/core/result.hpp"
#include "calvin/solve/methods/method_result.hpp"
#include "calvin/solve/start/projection_matrix.hpp"

namespace calvin {

// K in px, with the centre of the top-left pixel at (0, 0), and the pose of one view, which
// `number` names in the message. kDegenerate as dlt_method() says.
[[nodiscard]] Result<DecomposedProjection> dlt_of_view(const PointSet& view, std::size_t number,
                                                       ImageSize size);

// Every view is solved by itself (projection_matrix()), and the cameras are averaged (Y. Personnaz,
// P. Sturm, Calibration of a Stereo-Vision System by the Non-Linear Optimization of the Motion of a
// Calibration Object, 2002): model pinhole, with the skew that comes out where one is asked for.
// kDegenerate for a view of points in a plane, of too few, or of points in a left-handed frame.
[[nodiscard]] Result<MethodResult> dlt_method(const MethodInput& input);

}  // namespace calvin
