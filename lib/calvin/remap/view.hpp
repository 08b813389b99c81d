// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Views: which part of what a camera sees an undistorted picture shows, and in which projection.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "calvin/remap/virtual_camera.hpp"

namespace calvin {

// What `alpha` means. kOpenCv: as cv::getOptimalNewCameraMatrix() does, which is what
// cameraundistort shows: fx and fy each fill the picture, looked at in 9 x 9 points. It is that of
// the OpenCV which the library was built with; without one, that of 4.8 and newer.
enum class AlphaMode : std::uint8_t { kCalvin, kOpenCv };

struct ViewOptions {
  // 0: the largest view without an invalid pixel (output pixel centres lie within the centres of
  // the source's border pixels) whose middle is about the optical axis and that of the picture. 1:
  // every source pixel inside the model's valid region is shown. Between: the borders of the view
  // move linearly. Values outside 0..1 are taken as the nearest.
  double alpha = 0;
  ImageSize output;  // px; 0x0: as the source
  AlphaMode alpha_mode = AlphaMode::kCalvin;
  Projection projection = Projection::kRectilinear;
  // The view that alpha gives is enlarged around its middle, and then looks elsewhere: to the right
  // by `pan`, up by `tilt`, and is turned clockwise by `roll` (radians).
  double zoom = 1;
  double pan = 0;
  double tilt = 0;
  double roll = 0;

  friend bool operator==(const ViewOptions&, const ViewOptions&) = default;
};

struct OutputView {
  VirtualCamera camera;
  // The view was asked to be wider than the projection can show, by a zoom below 1 or by alpha = 1,
  // which asks for all that the source sees.
  bool limited = false;
};

// A view of what the source sees, with fx:fy as in the source (kCalvin). Directions that the
// projection does not show (to_plane()) do not count as valid, and no view is wider or higher than
// twice widest(). kDegenerate where the model has no valid region in the image.
[[nodiscard]] Result<OutputView> output_view(const Camera& source, const ViewOptions& options);

// The rotation of the view by pan, tilt and roll, in that order about the axes as they then are.
[[nodiscard]] Eigen::Matrix3d camera_from_view(const ViewOptions& options);

// The plane of output_view(): for a rectilinear view that looks along the optical axis the camera.
[[nodiscard]] Result<Camera> output_camera(const Camera& source, const ViewOptions& options);

// px of one camera -> px of another camera at the same position and with the same axes (undistort
// with the source first, distort with the output first). Absent where the other model does not see
// the ray of the pixel; the result may lie outside of its image.
[[nodiscard]] std::optional<Pixel> transfer(const Camera& from, const Camera& to,
                                            Pixel pixel) noexcept;

// The camera of pictures that `camera` took and that were then scaled and shifted, as the change
// from the pinhole `from` to the pinhole `to` does it.
[[nodiscard]] Result<Camera> reframed(const Camera& camera, const Camera& from, const Camera& to);

// A pinhole for frames whose calibration is not known: enough to scale any picture.
[[nodiscard]] Result<Camera> plain_camera(ImageSize size);

}  // namespace calvin
