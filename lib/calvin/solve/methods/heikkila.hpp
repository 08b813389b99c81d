// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Heikkila's and Silven's four steps: what is theirs of them. Internal.
#pragma once

#include <string>

#include "calvin/camera/camera.hpp"
#include "calvin/core/result.hpp"
#include "calvin/solve/methods/method_result.hpp"

namespace calvin {

// The first of the four steps of J. Heikkila, O. Silven, A Four-step Camera Calibration Procedure
// with Implicit Image Correction, CVPR 1997: the direct linear transformation of views of points in
// space, the cameras averaged (theirs is that of the last view). Planes, for which their toolbox
// asks the data sheet, get the focal length that their views have with the axis through the centre
// of the image. Model pinhole. Steps 2 and 3 are the least squares of solve(), with the bias of
// round dots taken off between; step 4 is inverse_of(). kDegenerate where the views determine no
// camera.
[[nodiscard]] Result<MethodResult> heikkila_method(const MethodInput& input);

// The fourth step in words: the inverse of the camera, its coefficients and how far it is off.
[[nodiscard]] std::string inverse_remark(const Camera& camera);

}  // namespace calvin
