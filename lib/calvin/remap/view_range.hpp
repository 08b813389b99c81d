// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The range of views of one camera, or of several that share a plane: what alpha, zoom, pan, tilt
// and roll are applied to.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "calvin/remap/view.hpp"
#include "calvin/remap/view_frames.hpp"

namespace calvin {

// The views at the two ends of `alpha`. Finding these two takes milliseconds, a view between them
// takes microseconds: alpha, zoom, pan, tilt and roll may change with every frame. Immutable.
class ViewRange {
 public:
  // Only the size, the projection and the mode of alpha of the options count. kDegenerate as
  // output_view().
  static Result<ViewRange> find(const Camera& source, const ViewOptions& options);
  // Of cameras that share the plane of their views: rectified ones. What alpha leaves out or shows
  // is that of all of them. `alpha_mode` counts for nothing. Errors as of find_view_frames();
  // kInvalidArgument for several cameras in another projection than the rectilinear one.
  static Result<ViewRange> find(std::span<const Sight> sights, const ViewOptions& options);

  // Whether find() would find the same range for these options.
  [[nodiscard]] bool serves(const ViewOptions& options) const noexcept {
    return options.output == asked_.output && options.projection == asked_.projection &&
           options.alpha_mode == asked_.alpha_mode;
  }
  // As output_view(), for options that the range serves, and for the camera of that number.
  [[nodiscard]] Result<OutputView> view(const ViewOptions& options, std::size_t sight = 0) const;

 private:
  ViewRange(const ViewOptions& asked, ImageSize size) : asked_(asked), size_(size) {}
  [[nodiscard]] Result<Camera> plane(double alpha) const;

  ViewOptions asked_;
  ImageSize size_;  // px of the output
  ViewFrames frames_;
  bool as_opencv_ = false;
  std::vector<Eigen::Matrix3d> camera_from_axes_;  // of each camera, before pan, tilt and roll
};

}  // namespace calvin
