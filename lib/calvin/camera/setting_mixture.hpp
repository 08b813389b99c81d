// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The sum of settings of a zoom table, as a calibration. Internal.
#pragma once

#include <vector>

#include "calvin/camera/setting_weights.hpp"
#include "calvin/camera/zoom_table.hpp"

namespace calvin {

// Parameters, sigmas and covariance alone: focal lengths by the law, each coefficient as what it
// does to the pixels (LensTraits::orders), all with one set of weights.
[[nodiscard]] Calibration mix_settings(const ZoomTable& table, ZoomLaw law,
                                       const std::vector<double>& weights);

}  // namespace calvin
