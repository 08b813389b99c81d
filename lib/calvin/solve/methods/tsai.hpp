// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Tsai's method: a camera and its pose from one view of known points. Internal.
#pragma once

#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/core/result.hpp"
#include "calvin/solve/methods/method_result.hpp"
#include "calvin/solve/methods/radial_alignment.hpp"
#include "calvin/solve/residuals/points.hpp"

namespace calvin {

// radial_alignment(), and then the least squares over focal length, tz and kappa on distances in
// the ideal image (the paper's equation 8b; "three-parameter optimization" of R. Willson's code).
[[nodiscard]] Result<TsaiCamera> tsai(const PointSet& view, Pixel center);

// The camera of model brown5 nearest to one of Tsai's, and the largest distance between the two
// over the image, px: ours distorts ideal points, his makes seen points ideal.
struct NearestBrown {
  std::vector<double> parameters;  // fx fy cx cy k1 k2 p1 p2 k3
  double residual = 0;
};
[[nodiscard]] NearestBrown nearest_brown(const TsaiCamera& camera, ImageSize size);

// tsai() about the centre of the image, as one of the methods: of exactly one view.
[[nodiscard]] Result<MethodResult> tsai_method(const MethodInput& input);

}  // namespace calvin
