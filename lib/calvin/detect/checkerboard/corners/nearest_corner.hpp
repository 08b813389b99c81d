// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The corner next to a pixel that somebody has pointed at.
#pragma once

#include <optional>

#include "calvin/core/image.hpp"

namespace calvin {

struct FoundCorner {
  Pixel at;
  double sigma = 0;  // px, 1 sigma per coordinate
};

// The corner that is nearest to a pixel, by the detector's own fit, where four squares meet within
// `reach` px of it; no board has to be known. The image may have any step. Looks at a part of it
// of about 2 reach + 100 px alone, which takes less than a millisecond. Absent where there is no
// such corner: one of two edges alone, as of a cube before a wall, has no four squares.
[[nodiscard]] std::optional<FoundCorner> nearest_corner(const ImageView& image, Pixel near,
                                                        double reach) noexcept;

}  // namespace calvin
