// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Bright pixels that touch each other. Internal.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/detect/light/light_background.hpp"

namespace calvin::detect {

struct LightBlob {
  PixelBox box;
  int pixels = 0;
  int peak = 0;     // grey levels above the background, of the brightest pixel
  double flux = 0;  // grey levels times px^2, above the background

  [[nodiscard]] int longer_side() const noexcept { return std::max(box.width(), box.height()); }
};

// Joins runs, in the order of the image, that touch along a side or at a corner: connected
// components by union and find. Keeps its memory from image to image.
class BlobJoiner {
 public:
  [[nodiscard]] const std::vector<LightBlob>& join(const ImageView& image,
                                                   const LightBackground& background,
                                                   const std::vector<BrightRun>& runs);

 private:
  [[nodiscard]] std::size_t root_of(std::size_t run);
  void link_rows(const std::vector<BrightRun>& runs);

  std::vector<std::size_t> parent_;  // of each run, another run of its blob or itself
  std::vector<std::size_t> blob_;    // of each run that is its own parent
  std::vector<LightBlob> blobs_;
};

}  // namespace calvin::detect
