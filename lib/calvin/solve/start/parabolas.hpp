// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The distortion of a grid by parabolas along its rows and columns: the steps of discorpy. N. T.
// Vo, R. C. Atwood, M. Drakopoulos, "Radial lens distortion correction with sub-pixel accuracy for
// X-ray micro-tomography", Optics Express 23(25), 2015, sections 2.2 and 2.3. Internal.
#pragma once

#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/core/result.hpp"
#include "calvin/solve/residuals/points.hpp"

namespace calvin {

// A point that would be r px from the centre is seen at r (f0 + f1 r + f2 r^2 + ...) px, its
// "backward model" of five factors.
struct PowersOfRadius {
  Pixel center;  // px
  std::vector<double> factors;

  [[nodiscard]] double seen(double r) const;
};

// The centre lies between the two rows, and the two columns, from one to the other of which the
// curvature changes its sign: it is known to half of a pitch. Lines are taken to be as far apart
// everywhere as they are about it, which they are only where the plane is parallel to the sensor.
// Rows are points with the same y on the board. kDegenerate where there are fewer than 8 rows or
// columns, or none of them is straight.
[[nodiscard]] Result<PowersOfRadius> distortion_by_parabolas(const PointSet& view, ImageSize size);

}  // namespace calvin
