// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Calibrates a simulated zoom lens.

#include "zoom_settings.hpp"

#include "simulated_zoom.hpp"

namespace calvin::scenes {

ZoomTable twelve_settings(const ZoomLens& lens, std::uint64_t seed) {
  Random random(seed);
  return calibrated_table(lens, 12, 40, 0.05, random);
}

}  // namespace calvin::scenes
