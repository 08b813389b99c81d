// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The rays through a regular grid of image points, quickly.
#pragma once

#include <vector>

#include "calvin/camera/camera.hpp"

namespace calvin::synth {

// Rays (x y z, of about unit length) for the corners of all pixels: the one at column i of row j
// belongs to px (i - 0.5, j - 0.5); (width + 1) * (height + 1) of them, zero where the camera
// has none. What lies linearly between those of a pixel's corners is right in the mean over the
// pixel, which rays exactly through its corners would not be. Interpolated between exact rays; the
// error is kept below 1e-4 px.
[[nodiscard]] std::vector<float> pixel_corner_rays(const Camera& camera);

}  // namespace calvin::synth
