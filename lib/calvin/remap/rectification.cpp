// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The cameras of a stereo pair for frames of one size.

#include "calvin/remap/rectification.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "calvin/camera/frame_fit.hpp"
#include "calvin/remap/view_range.hpp"
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
    // A file that does not say the size of its pictures has none of either camera.
    const bool is_sized = calibrated != ImageSize{} && known.image_size != ImageSize{};
    const ImageSize frames =
        is_sized ? ImageSize{scaled(known.image_size.width, size.width, calibrated.width),
                             scaled(known.image_size.height, size.height, calibrated.height)}
                 : size;
    auto fitted = fit_to_frame(known, frames);
    if (!fitted) return tl::unexpected(fitted.error());
    sights.push_back({std::move(fitted->camera),
                      is_left ? pair->left_from_rectified : pair->right_from_rectified});
  }
  return sights;
}

Result<RectifiedPair> rectified_pair(const Rig& rig, double alpha) {
  const auto pair = stereo_pair(rig);
  if (!pair) return tl::unexpected(pair.error());
  const ImageSize size = rig.cameras[pair->left].calibration.image_size;
  if (size == ImageSize{}) {
    return make_error(ErrorCode::kInvalidArgument,
                      "The rig does not say the size of its cameras' pictures, of which the "
                      "rectified ones are: calibrate it again, or add image_width and "
                      "image_height to its file.");
  }
  const auto sights = rectified_sights(rig, StereoSide::kLeft, size);
  if (!sights) return tl::unexpected(sights.error());
  ViewOptions options;
  options.alpha = alpha;
  const auto range = ViewRange::find(std::span(*sights), options);
  if (!range) return tl::unexpected(range.error());
  const auto view = range->view(options);
  if (!view) return tl::unexpected(view.error());
  const Camera& plane = view->camera.plane();
  RectifiedPair result;
  result.left = pair->left;
  result.right = pair->right;
  result.is_vertical = pair->is_vertical;
  result.baseline = pair->baseline;
  // The transpose of a matrix in the order of its columns.
  std::copy_n(pair->left_from_rectified.data(), 9, result.rectified_from_left.begin());
  std::copy_n(pair->right_from_rectified.data(), 9, result.rectified_from_right.begin());
  result.image_size = size;
  result.fx = plane.fx();
  result.fy = plane.fy();
  result.cx = plane.cx();
  result.cy = plane.cy();
  return result;
}

}  // namespace calvin
