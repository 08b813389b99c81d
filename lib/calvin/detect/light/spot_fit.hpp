// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The place of a small light to a fraction of a pixel: the least squares fit of a Gaussian, which
// stands for the light and the point spread of the optics, to the pixels around it.
//
//   grey(p) = background(p) + offset + height exp(-(p - centre)^T shape (p - centre) / 2)
//
// as the mean over each pixel. Estimated: the centre, the height, the offset and the three numbers
// of the shape, and where that is not enough how flat its middle is (spot_model.hpp). A light is
// mostly so bright that its middle is cut off: pixels at the upper limit say only that the light
// reaches it there, and count where the Gaussian does not. Internal.
#pragma once

#include <optional>

#include "calvin/core/image.hpp"
#include "calvin/detect/light/light_background.hpp"
#include "calvin/detect/light/light_blobs.hpp"

namespace calvin::detect {

struct SpotFit {
  Pixel centre;
  double height = 0;    // grey levels, as if nothing were cut off
  double longer = 0;    // px, 1 sigma of the Gaussian along its longer axis
  double shorter = 0;   // px, across
  double residual = 0;  // grey levels, RMS
  double noise = 0;     // grey levels, 1 sigma, of the background there
  double seen = 0;      // grey levels, of the height that is not cut off
  // px, 1 sigma of the centre along the axes, from the residuals.
  double sigma_along = 0;
  double sigma_across = 0;
};

// The image has step 1, and the background is one of such images. Absent where the pixels are no
// Gaussian: the fit runs away or leaves the blob, or too few pixels are left beside what is cut
// off.
[[nodiscard]] std::optional<SpotFit> fit_spot(const ImageView& image,
                                              const LightBackground& background,
                                              const LightBlob& blob);

}  // namespace calvin::detect
