// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The corner next to a pixel that somebody has pointed at.
#pragma once

#include <optional>

#include "calvin/core/image.hpp"
#include "calvin/detect/nearest/found_point.hpp"
#include "calvin/detect/nearest/image_part.hpp"

namespace calvin {

// The corner that is nearest to a pixel of the image, by the detector's own fit, where four squares
// meet within `reach` px of it; no board has to be known. Absent where there is no such corner in
// the part of the image: one of two edges alone, as of a cube before a wall, has no four squares.
[[nodiscard]] std::optional<FoundPoint> nearest_corner(const ImagePart& part, Pixel near,
                                                       double reach);

}  // namespace calvin
