// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Bakstein's complete direct linear transformation of planes. Internal.
#pragma once

#include "calvin/core/result.hpp"
#include "calvin/solve/methods/method_result.hpp"

namespace calvin {

// H. Bakstein, A Complete DLT-based Camera Calibration with a Virtual 3D Calibration Object, 1999:
// a plane by itself leaves the direct linear transformation open. A first camera, with its axis
// through the centre of the image, puts the planes of all views into the frame of the camera, where
// they make one object in space; that gives a better camera, and so on in turns. The turns need not
// come to the true camera, and end where the points no longer come nearer to it. At least 2 views
// of a plane; model pinhole. kDegenerate where it comes to no camera.
[[nodiscard]] Result<MethodResult> bakstein_method(const MethodInput& input);

}  // namespace calvin
