// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Zhang's closed form, and the two coefficients that follow from it linearly. Internal.
#pragma once

#include "calvin/core/result.hpp"
#include "calvin/solve/methods/method_result.hpp"

namespace calvin {

// Z. Zhang, A Flexible New Technique for Camera Calibration, PAMI 22(11), 2000: the camera from the
// homographies of three views of a plane (section 3.1 and appendix B; fewer for fewer unknowns),
// the poses (appendix C), and k1, k2 by linear least squares (section 3.3, equation 13): model
// brown4. kDegenerate where the homographies determine no camera, as of planes parallel to each
// other.
[[nodiscard]] Result<MethodResult> zhang_method(const MethodInput& input);

}  // namespace calvin
