// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The radius of the window in which a corner is fitted.
#pragma once

#include <algorithm>

namespace calvin::detect {

inline constexpr float kLeastRadius = 2.8F;  // px, of a fit's window
inline constexpr float kLastRadius = 14;     // px
inline constexpr float kShare = 0.45F;       // of the spacing, of a window's radius

// The radius of the largest window that has nothing else in it, px: no next edge, no finger, no end
// of the paper.
// `spacing` is the distance to the next edge, `width` that of the edges' blur, px.
[[nodiscard]] inline float last_radius(float spacing, float width) {
  constexpr float kLargestShare = 0.6F;  // of the spacing, where the image is sharp
  constexpr float kClear = 2.6F;         // edge widths between a window and the next edge
  // Of the spacing, for large squares: twice the radius along the edges halves the variance, and
  // takes twice as long.
  constexpr float kFarShare = 0.36F;
  const float clear =
      std::clamp(spacing - kClear * width, kShare * spacing, kLargestShare * spacing);
  return std::clamp(clear, kLeastRadius, std::max(kLastRadius, kFarShare * spacing));
}

}  // namespace calvin::detect
