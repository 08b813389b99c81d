// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a user may have meant who points at a pixel: a corner or a disc.
#pragma once

#include <optional>

#include "calvin/core/image.hpp"
#include "calvin/detect/nearest/found_point.hpp"

namespace calvin {

// nearest_corner() or nearest_disc(), whichever is nearer; discs of radii of 1 to about 100 px. The
// image may have any step. Looks at a part of it of 2 reach + 100 px alone, and where nothing is in
// that at one of 2 reach + 300 px, which takes about a millisecond; a reach of more than 500 px is
// taken as that. Absent where there is neither.
[[nodiscard]] std::optional<FoundPoint> nearest_point(const ImageView& image, Pixel near,
                                                      double reach) noexcept;

}  // namespace calvin
