// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Views of planes through a lens that zooms from view to view -> a calibration for each of them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "calvin/core/calibration.hpp"
#include "calvin/core/image.hpp"
#include "calvin/core/result.hpp"
#include "calvin/solve/view.hpp"

namespace calvin {

struct ZoomingOptions {
  bool centered = false;  // the principal point is at the centre of the image
  bool square = false;    // fx = fy
  // False: what sturm_maybank() finds by itself, without distortion.
  bool refine = true;
  std::string camera;  // name for the results; empty: that of the first view
};

// A calibration for each view, in their order: model brown4 with one principal point, one aspect,
// and a focal length and a k1 for each. It starts at sturm_maybank(), or at the centre of the image
// where that is nearer to the views. Then the least squares: solve() of each view by itself, with
// the shared numbers held, and over those the sum of squares of all views is made least. Sigmas
// hold both.
// kInvalidArgument for broken views; kDegenerate as of sturm_maybank(), and where a view does not
// tell its focal length to a tenth: the message says which one, and what to do.
[[nodiscard]] Result<std::vector<Calibration>> solve_zooming(std::span<const View> views,
                                                             ImageSize size,
                                                             const ZoomingOptions& options = {});

}  // namespace calvin
