// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which camera an undistorted picture shows.
#pragma once

#include <optional>

#include "calvin/camera/camera.hpp"

namespace calvin {

struct ViewOptions {
  // 0: the largest view without an invalid pixel (output pixel centres lie within the centres of
  // the source's border pixels). 1: every source pixel inside the model's valid region is shown.
  // Between: the borders of the view move linearly. Values outside 0..1 are taken as the nearest.
  double alpha = 0;
  ImageSize output;  // px; 0x0: as the source
};

// A pinhole camera without skew that looks along the source's optical axis, with fx:fy as in the
// source. Directions more than 75 degrees off the axis do not count as valid, and no view is wider
// or higher than 150 degrees: a plane cannot show what a fisheye lens sees beyond. kDegenerate
// where the model has no valid region in the image.
[[nodiscard]] Result<Camera> output_camera(const Camera& source, const ViewOptions& options);

// px of one camera -> px of another one at the same place and with the same axes (undistort with
// the source first, distort with the output first). Absent where the ray of the pixel is not seen
// by the other model; the result may lie outside its image.
[[nodiscard]] std::optional<Pixel> transfer(const Camera& from, const Camera& to,
                                            Pixel pixel) noexcept;

// The camera of a picture that `camera` took and that then was moved, as the change from the
// pinhole `from` to the pinhole `to` moves it.
[[nodiscard]] Result<Camera> moved(const Camera& camera, const Camera& from, const Camera& to);

// A pinhole for frames whose calibration is not known: what any picture may be scaled with.
[[nodiscard]] Result<Camera> plain_camera(ImageSize size);

}  // namespace calvin
