// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The distortion alone, by one picture of a plane or several: what discorpy does with a grid of
// dots or lines. N. T. Vo, R. C. Atwood, M. Drakopoulos, "Radial lens distortion correction with
// sub-pixel accuracy for X-ray micro-tomography", Optics Express 23(25), 2015. Internal.
#pragma once

#include "calvin/core/result.hpp"
#include "calvin/solve/methods/method_result.hpp"

namespace calvin {

// Of brown4, brown5 and rational8 the centre and the radial coefficients; no tangential ones. The
// focal length is not known and stands at the width of the image; poses are those of such a camera,
// as near as there are any. Paper and discorpy fit parabolas to rows and columns, then a polynomial
// to distances from the centre; here one least squares has all points, and a homography for each
// view in place of a perspective correction before. Without refinement the steps are theirs, of one
// view (distortion_by_parabolas()), and the camera is that of the model which follows their
// polynomial: the remark says within how many px. kInvalidArgument for another model, kDegenerate
// as fit_radial_planes() says.
[[nodiscard]] Result<MethodResult> discorpy_method(const MethodInput& input);

}  // namespace calvin
