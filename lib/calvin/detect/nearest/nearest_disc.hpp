// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The disc next to a pixel that somebody has pointed at. Internal.
#pragma once

#include <optional>

#include "calvin/core/image.hpp"
#include "calvin/detect/nearest/found_point.hpp"
#include "calvin/detect/nearest/image_part.hpp"

namespace calvin {

// The disc, dark on light or light on dark, whose centre is nearest to a pixel of the image, by the
// fit that grids of circles have, where it is within `reach` px of it and its surroundings are in
// the part. A circle's centre is not that of the ellipse that it is seen as (J. Heikkila, Geometric
// camera calibration using circular control points, 2000, section 2.2): by how much is not known
// here, and what it may be for a lens of a usual angle is in the sigma. Absent where there is no
// such disc.
[[nodiscard]] std::optional<FoundPoint> nearest_disc(const ImagePart& part, Pixel near,
                                                     double reach);

}  // namespace calvin
