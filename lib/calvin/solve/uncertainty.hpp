// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The error of projection that follows from a calibration's covariance.
#pragma once

#include <optional>

#include "calvin/core/calibration.hpp"

namespace calvin {

// The expected error of projection, px, 1 sigma: the largest over a grid of pixels, for points at
// infinity. At each pixel the derivative of its projection by the parameters, less what the best
// rotation common to all pixels explains (a camera that is merely turned a little is as good),
// times the covariance; the standard deviation along the worse direction. Pixels that no ray leads
// to are left out. After mrcal's projection uncertainty.
// Absent without a usable covariance.

// Over the region that corners covered (Calibration::covered), or the picture where that is empty.
[[nodiscard]] std::optional<double> expected_error(const Calibration& calibration);

// Over the whole picture, extrapolation included: the grid reaches its border.
[[nodiscard]] std::optional<double> expected_error_anywhere(const Calibration& calibration);

}  // namespace calvin
