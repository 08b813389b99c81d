// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The range of views of one camera: what alpha, zoom, pan, tilt and roll are applied to.
#pragma once

#include "calvin/remap/view.hpp"

namespace calvin {

// The views at the two ends of `alpha`. Finding these two takes milliseconds, a view between them
// takes microseconds: alpha, zoom, pan, tilt and roll may change with every frame. Immutable.
class ViewRange {
 public:
  // Only the size, the projection and the mode of alpha of the options count. kDegenerate as
  // output_view().
  static Result<ViewRange> find(const Camera& source, const ViewOptions& options);

  // Whether find() would find the same range for these options.
  [[nodiscard]] bool serves(const ViewOptions& options) const noexcept {
    return options.output == asked_.output && options.projection == asked_.projection &&
           options.alpha_mode == asked_.alpha_mode;
  }
  // As output_view(), for options that the range serves.
  [[nodiscard]] Result<OutputView> view(const ViewOptions& options) const;

 private:
  // Where the centres of the output's border pixels lie on the plane of the projection.
  struct Box {
    Pixel low;
    Pixel high;
  };

  ViewRange(const ViewOptions& asked, ImageSize size) : asked_(asked), size_(size) {}
  Status find_frames(const Camera& source);
  [[nodiscard]] Result<Camera> plane(double alpha) const;

  ViewOptions asked_;
  ImageSize size_;    // px of the output
  Box inner_;         // alpha = 0
  Box outer_;         // alpha = 1
  bool cut_ = false;  // the projection shows less than the source sees
};

}  // namespace calvin
