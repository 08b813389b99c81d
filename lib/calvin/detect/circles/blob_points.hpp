// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Pixels that are darker, or lighter, than all of a ring around them: where discs may be.
#pragma once

#include <cstdint>
#include <vector>

#include "calvin/core/image.hpp"

namespace calvin::detect {

// The discs that answer have radii of about 1 to 4.5 px.
inline constexpr int kBlobReach = 5;  // px, of the larger ring

struct BlobPoint {
  int x = 0;
  int y = 0;
  std::uint8_t response = 0;  // grey levels, to the least different pixel of the ring
};

// Keeps its memory.
class BlobSearch {
 public:
  // The peaks of the response of an image (of step 1), at least `threshold`; the strongest `most`.
  const std::vector<BlobPoint>& find(const ImageView& image, bool light, std::uint8_t threshold,
                                     std::size_t most);

 private:
  std::vector<std::uint8_t> response_;
  std::vector<std::uint8_t> is_peak_;  // of a row
  std::vector<BlobPoint> points_;
};

}  // namespace calvin::detect
