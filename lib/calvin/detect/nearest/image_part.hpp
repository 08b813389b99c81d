// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A part of an image by itself. Internal.
#pragma once

#include "calvin/core/image.hpp"

namespace calvin {

struct ImagePart {
  GrayImage image;
  int x = 0;  // of its first pixel
  int y = 0;
  int whole_width = 0;  // px, of the image that it is of
};

// Around a pixel that somebody has pointed at: `reach` px, and `around` px more that a fit of what
// lies there may look at, of an image of any step. Without pixels where there is no image, or the
// pixel is farther outside than `reach`.
[[nodiscard]] ImagePart part_within_reach(const ImageView& image, Pixel near, double reach,
                                          int around);

}  // namespace calvin
