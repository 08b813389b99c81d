// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The nearer one of a corner and a disc.

#include "calvin/detect/nearest/nearest_point.hpp"

#include <algorithm>
#include <cmath>
#include <exception>

#include "calvin/detect/nearest/image_part.hpp"
#include "calvin/detect/nearest/nearest_corner.hpp"
#include "calvin/detect/nearest/nearest_disc.hpp"

namespace calvin {

namespace {

constexpr double kFarthestReach = 500;  // px
// px beyond the reach: as the detector's fits look, and for discs that are larger than that.
constexpr int kAround = 50;
constexpr int kAroundLarge = 150;

}  // namespace

std::optional<FoundPoint> nearest_point(const ImageView& image, Pixel near, double reach) noexcept {
  try {
    reach = std::min(reach, kFarthestReach);
    const ImagePart part = part_within_reach(image, near, reach, kAround);
    const auto corner = nearest_corner(part, near, reach);
    const auto disc = nearest_disc(part, near, reach);
    if (!corner && !disc) {
      return nearest_disc(part_within_reach(image, near, reach, kAroundLarge), near, reach);
    }
    if (!corner || !disc) return corner ? corner : disc;
    const auto distance = [near](const FoundPoint& found) {
      return std::hypot(found.at.u - near.u, found.at.v - near.v);
    };
    return distance(*disc) < distance(*corner) ? disc : corner;
  } catch (const std::exception&) {  // no memory
    return std::nullopt;
  }
}

}  // namespace calvin
