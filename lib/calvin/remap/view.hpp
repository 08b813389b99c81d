// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which camera an undistorted picture shows.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "calvin/remap/eye.hpp"

namespace calvin {

// What `alpha` means. kOpenCv: as cv::getOptimalNewCameraMatrix() does, which is what
// cameraundistort shows: fx and fy each fill the picture, looked at in 9 x 9 points. It is that of
// the OpenCV which the library was built with; without one, that of 4.8 and newer.
enum class AlphaMode : std::uint8_t { kCalvin, kOpenCv };

struct ViewOptions {
  // 0: the largest view without an invalid pixel (output pixel centres lie within the centres of
  // the source's border pixels). 1: every source pixel inside the model's valid region is shown.
  // Between: the borders of the view move linearly. Values outside 0..1 are taken as the nearest.
  double alpha = 0;
  ImageSize output;  // px; 0x0: as the source
  AlphaMode alpha_mode = AlphaMode::kCalvin;
  Projection projection = Projection::kRectilinear;
  // The view so found is enlarged around its middle, and then looks elsewhere: to the right by
  // `pan`, up by `tilt`, and is turned clockwise by `roll` (radians).
  double zoom = 1;
  double pan = 0;
  double tilt = 0;
  double roll = 0;

  friend bool operator==(const ViewOptions&, const ViewOptions&) = default;
};

struct OutputView {
  Eye eye;
  // It would have been wider than the projection can show, be it by a zoom below 1 or where alpha
  // = 1 asks for all that the source sees.
  bool limited = false;
};

// A view of what the source sees, with fx:fy as in the source (kCalvin). Directions that the
// projection does not show (to_plane()) do not count as valid, and no view is wider or higher than
// twice widest(). kDegenerate where the model has no valid region in the image.
[[nodiscard]] Result<OutputView> output_view(const Camera& source, const ViewOptions& options);

// How pan, tilt and roll turn the view: pan first, seen from outside.
[[nodiscard]] Eigen::Matrix3d camera_from_view(const ViewOptions& options);

// The plane of output_view(): for a rectilinear view that looks along the optical axis the camera.
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
