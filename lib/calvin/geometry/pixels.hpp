// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What is between pixels. Internal.
#pragma once

#include <cmath>
#include <vector>

#include "calvin/core/image.hpp"

namespace calvin {

[[nodiscard]] inline double distance(Pixel a, Pixel b) { return std::hypot(a.u - b.u, a.v - b.v); }

[[nodiscard]] inline Pixel mean_of(const std::vector<Pixel>& points) {
  Pixel mean;
  for (const Pixel& p : points) {
    mean.u += p.u / static_cast<double>(points.size());
    mean.v += p.v / static_cast<double>(points.size());
  }
  return mean;
}

}  // namespace calvin
