// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The cameras of a stereo pair for frames of one size.

#include "calvin/remap/rectification.hpp"

#include <cmath>
#include <utility>

#include "calvin/camera/frame_fit.hpp"
#include "calvin/rig/stereo.hpp"

namespace calvin {

namespace {

int scaled(int length, int frame, int calibrated) {
  return static_cast<int>(std::lround(static_cast<double>(length) * frame / calibrated));
}

}  // namespace

Result<std::size_t> camera_of_side(const Rig& rig, StereoSide side) {
  const auto pair = stereo_pair(rig);
  if (!pair) return tl::unexpected(pair.error());
  return side == StereoSide::kLeft ? pair->left : pair->right;
}

Result<std::vector<Sight>> rectified_sights(const Rig& rig, StereoSide side, ImageSize size) {
  const auto pair = stereo_pair(rig);
  if (!pair) return tl::unexpected(pair.error());
  const std::size_t own = side == StereoSide::kLeft ? pair->left : pair->right;
  const ImageSize calibrated = rig.cameras[own].calibration.image_size;
  std::vector<Sight> sights;
  for (const bool is_left : {true, false}) {
    const Calibration& known = rig.cameras[is_left ? pair->left : pair->right].calibration;
    const ImageSize frames = {scaled(known.image_size.width, size.width, calibrated.width),
                              scaled(known.image_size.height, size.height, calibrated.height)};
    auto fitted = fit_to_frame(known, frames);
    if (!fitted) return tl::unexpected(fitted.error());
    sights.push_back({std::move(fitted->camera),
                      is_left ? pair->left_from_rectified : pair->right_from_rectified});
  }
  return sights;
}

}  // namespace calvin
