// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The error of projection that follows from a calibration's covariance. Internal.
#pragma once

#include <optional>

#include "calvin/core/calibration.hpp"

namespace calvin {

// Calibration::expected_error before any misfit enlarges it, px: see expected_error().
[[nodiscard]] std::optional<double> projection_error(const Calibration& calibration);

}  // namespace calvin
