// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where two lines cross, to a fraction of a pixel: the centres of each line on both sides of the
// other one, a parabola through them, and where both parabolas meet.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "calvin/core/image.hpp"

namespace calvin::detect {

struct CrossingFit {
  Pixel at;          // px
  double sigma = 0;  // px, 1 sigma per coordinate
};

// The crossing about a place, known to a part of the line's width; `along` and `down` are the steps
// to the next crossings on both lines, px. Absent where there are no two lines, or where one of
// their four arms is beyond the image or covered. The image has step 1.
[[nodiscard]] std::optional<CrossingFit> fit_crossing(const ImageView& image, const Pixel& start,
                                                      const Eigen::Vector2d& along,
                                                      const Eigen::Vector2d& down, bool light);

}  // namespace calvin::detect
