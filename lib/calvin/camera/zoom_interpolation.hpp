// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The calibration of a zoom lens between the settings that were calibrated.
#pragma once

#include <string>

#include "calvin/camera/zoom_table.hpp"

namespace calvin {

struct InterpolatedCalibration {
  // Camera, model, image size, crop and device as in the table; `zoom` and `focus` are those of the
  // position, or of the end of the table. The parameters have the sigmas and the covariance that
  // follow from those of the settings, which were calibrated each by itself: what noise has done,
  // and not what the curve between the settings lacks (ZoomSetting::left_out tells of that).
  Calibration calibration;
  std::string remark;  // where the position lies beyond the table: sentences that say so; or empty
};

// Interpolates along the focus within each zoom, and then along the zoom, by
// monotone_cubic_weights() guided by the focal length; beyond the table it ends. Focal lengths are
// interpolated by zoom_law(), and each coefficient of the lens as what it does to the pixels:
// divided by the power of the focal length that LensTraits::orders tells. All parameters have the
// same weights, so that errors which make up for each other in the settings do so between them.
// kInvalidArgument where the zoom is not known, nor the focus that the table depends on.
[[nodiscard]] Result<InterpolatedCalibration> interpolate(const ZoomTable& table,
                                                          const LensPosition& position);

}  // namespace calvin
