// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The layouts in memory that the vector kernels know.
#pragma once

#include <cstdint>

namespace calvin::remap {

// 8-bit samples of 1 to 4 components without gaps; 8-bit samples of 1 or 2 components in every
// second byte (the luma and the chroma of YUY2); 16-bit samples of 1 or 2 components.
enum class PixelLayout : std::uint8_t {
  kOne,
  kTwo,
  kThree,
  kFour,
  kOneStrided,
  kTwoStrided,
  kOneWord,
  kTwoWords,
  kNone
};

// The pixels whose results fill a lane, which is 128 bits of a vector: eight results of 16 bits
// each. Three components take the place of four.
[[nodiscard]] constexpr int pixels_per_lane(PixelLayout layout) noexcept {
  switch (layout) {
    case PixelLayout::kTwo:
    case PixelLayout::kTwoStrided:
      return 4;
    case PixelLayout::kThree:
    case PixelLayout::kFour:
      return 2;
    default:  // 16-bit samples too: their runs of eight are cut into parts, never shortened
      return 8;
  }
}

// Bytes behind a group of runs that a kernel may overwrite, because it stores whole vectors.
[[nodiscard]] constexpr int run_slack(PixelLayout layout) noexcept {
  switch (layout) {
    case PixelLayout::kThree:
      return 4;
    case PixelLayout::kOneStrided:
    case PixelLayout::kTwoStrided:
      return 1;
    default:
      return 0;
  }
}

// How 16-bit samples hold their values.
struct WordFormat {
  bool swapped = false;  // big-endian on a little-endian machine, or the other way round
  int shift = 0;         // bits below the value
};

}  // namespace calvin::remap
