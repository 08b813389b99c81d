// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Tsai's method: a camera and its pose from one view of known points. Internal.
#pragma once

#include <string>
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

// The camera of ours nearest to one of Tsai's, and the largest distance between the two over the
// image, px: ours distorts ideal points, his makes seen points ideal. Of model brown5 where that
// follows, else rational8.
struct NearestCamera {
  std::string model;
  std::vector<double> parameters;
  double residual = 0;
};
[[nodiscard]] NearestCamera nearest_camera(const TsaiCamera& camera, ImageSize size);

// tsai() about the centre of the image, as one of the methods: of exactly one view.
[[nodiscard]] Result<MethodResult> tsai_method(const MethodInput& input);

}  // namespace calvin
