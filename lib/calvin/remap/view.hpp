// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which camera an undistorted picture shows, and how a calibration fits a frame.
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

struct FittedCamera {
  Camera camera;        // of frames of the size asked for
  bool scaled = false;  // the frames have another size than the calibration
};

// The camera of frames of `frame` px whose calibration is known. A frame of another size but the
// same aspect (to 1 px) is a scaled one; `sensor_crop` says which part of the calibrated image the
// frames show; a calibration of size 0x0 is for any. Another aspect is kInvalidArgument.
[[nodiscard]] Result<FittedCamera> fit_to_frame(const Calibration& calibration, ImageSize frame);

}  // namespace calvin
