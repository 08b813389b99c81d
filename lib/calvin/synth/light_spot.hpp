// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a small light looks like in an image: a Gaussian, integrated over the pixels. Internal.
#pragma once

#include <functional>
#include <optional>

#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/core/image.hpp"
#include "calvin/synth/filter.hpp"

namespace calvin::synth {

// A Gaussian around `centre`, which is exactly where the camera projects the middle of the light.
struct LightSpot {
  Pixel centre;
  double uu = 0;  // px^2, covariance
  double uv = 0;
  double vv = 0;
  double peak = 0;  // grey levels in the middle, before anything is cut off
};

// A ball of light of `diameter` m at `in_camera` m whose radiance falls off from its middle like a
// Gaussian of a quarter of the diameter, 1 sigma, through optics that blur by `blur` px, 1 sigma.
// `glow`: grey levels of its middle without blur, at any distance. Absent where the camera does not
// see it.
[[nodiscard]] std::optional<LightSpot> light_spot(const Camera& camera,
                                                  const Eigen::Vector3d& in_camera, double diameter,
                                                  double glow, double blur);

// Adds to each row the part of the light that is seen while it is taken; `spot_of_row` is asked for
// each row of the image.
using SpotOfRow = std::function<std::optional<LightSpot>(double v)>;
void add_light(FloatImage& image, const SpotOfRow& spot_of_row);

}  // namespace calvin::synth
