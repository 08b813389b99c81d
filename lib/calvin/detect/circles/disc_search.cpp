// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The ellipse around each place of a level that differs from the ring around it.

#include "calvin/detect/circles/disc_search.hpp"

#include <cstdint>

namespace calvin::detect {

void DiscSearch::add(Pyramid& pyramid, int level, bool light, std::vector<Ellipse>& discs) {
  constexpr std::uint8_t kThreshold = 6;  // grey levels
  const ImageView& image = pyramid.calm_level(level);
  const double scale = 1 << level;
  const auto up = [level](double v) {
    return static_cast<double>(Pyramid::to_image(static_cast<float>(v), level));
  };
  known_.begin(discs);
  shapes_.begin(image, light);
  for (const BlobPoint& p : blob_search_.find(image, light, kThreshold, most_)) {
    const auto found = shapes_.measure(p.x, p.y, kThreshold);
    if (!found) continue;
    Ellipse e = *found;
    e.x = up(e.x);
    e.y = up(e.y);
    for (double* square : {&e.xx, &e.xy, &e.yy}) *square *= scale * scale;
    if (known_.add(e)) discs.push_back(e);
  }
}

}  // namespace calvin::detect
