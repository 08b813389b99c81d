// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Whether views differ enough to determine a camera, and the errors for views that do not.
// Internal.
#pragma once

#include <string>

#include "calvin/solve/fit/camera_fit.hpp"

namespace calvin {

// A kDegenerate error: `what` is wrong with the views, followed by what to show instead.
[[nodiscard]] tl::unexpected<Error> degenerate(std::string what);

// Whether the board is seen at as many tilts as the unknowns of the camera ask for.
[[nodiscard]] Status tilted_enough(const Fit& fit, const Parameterization& parameterization);

// Whether the board stays in one place of the image: many views then count as one, whatever a fit
// to their noise says.
[[nodiscard]] bool in_one_place(const Fit& fit, ImageSize size);

}  // namespace calvin
