// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How straight a camera makes the rows and columns of a board: what tells a good distortion where
// nobody knows more of the camera.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "calvin/camera/camera.hpp"
#include "calvin/solve/solution.hpp"
#include "calvin/solve/view.hpp"

namespace calvin {

struct Straightness {
  int lines = 0;    // rows and columns of at least five points
  double seen = 0;  // px, RMS of the distances of their points from straight lines in the picture
  double mended =
      0;  // px, without distortion, in the picture of a pinhole with the same fx fy cx cy
};

// Of the views of boards on a grid, without the corners of `left_out`. The straight line of each
// row and column is the one from which its points have the least squares of distances. Absent where
// there are no rows and columns.
[[nodiscard]] std::optional<Straightness> straightness(std::span<const View> views,
                                                       std::span<const RejectedCorner> left_out,
                                                       const Camera& camera);

}  // namespace calvin
