// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Regions of one tone that have four straight sides: where tags may be.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/detect/tags/local_threshold.hpp"
#include "calvin/detect/tags/point.hpp"

namespace calvin::detect {

// The middle of a side of a pixel, in half px.
struct EdgePoint {
  int x = 0;
  int y = 0;
};

// Keeps its memory.
class QuadSearch {
 public:
  // From here on another image, of step 1. `contrast` in grey levels.
  void begin(const ImageView& image, int contrast) { tones_.take(image, contrast); }

  // The dark quads of the image, or the light ones, in px of the image and to a px or so. Once for
  // each tone.
  [[nodiscard]] const std::vector<Quad>& find(bool light);

 private:
  // Follows the edge of the region whose pixel (x, y) has another tone at its left. False where the
  // region is no candidate by its size.
  [[nodiscard]] bool follow(int x, int y, Tone tone);

  ToneImage tones_;
  std::vector<EdgePoint> points_;
  std::span<const EdgePoint> edge_;   // of each side of a pixel that it has
  std::vector<std::uint8_t> begins_;  // 1 where an edge may begin, of a row
  std::vector<Quad> quads_;
};

}  // namespace calvin::detect
