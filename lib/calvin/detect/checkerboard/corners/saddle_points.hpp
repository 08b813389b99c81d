// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where four squares may meet: the peaks of a response to checkerboard corners.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/detect/checkerboard/corners/corner.hpp"

namespace calvin::detect {

// The response reaches this far, px; there is none closer to the border of an image.
inline constexpr int kResponseRadius = 5;

struct SaddlePoint {
  std::int32_t x = 0;
  std::int32_t y = 0;
  std::uint8_t response = 0;
};

// The responses in a small part of an image (of step 1), column 0 of each row at (x, y + row); 0
// too close to the border and beyond it. It is that of ChESS (Bennett and Lasenby, Computer Vision
// and Image Understanding 118, 2014: sum response - difference response - 16 x mean response, over
// 8) with half its mean response, in the mean of its sixteen samples, so that it is a grey level:
// 0.75 of the contrast at an ideal corner, 0 where negative. The larger ring has a radius of 5 px,
// the smaller one of 3.
inline constexpr int kPatchWidth = 16;
inline constexpr int kMaxPatchHeight = 16;
struct ResponsePatch {
  std::uint8_t at[kMaxPatchHeight][kPatchWidth];
};
void saddle_responses(const ImageView& image, int x, int y, int height, RingSize ring,
                      ResponsePatch& patch) noexcept;

// Finds the greatest responses within 3 px around them. Keeps its memory.
class SaddleSearch {
 public:
  // The `most` strongest of at least `threshold`; the image has step 1. Valid until the next call.
  [[nodiscard]] std::span<const SaddlePoint> find(const ImageView& image, RingSize ring,
                                                  std::uint8_t threshold, std::size_t most);

 private:
  void take_peaks(const std::uint8_t* row, int y, int width);
  void raise_threshold();

  std::uint8_t threshold_ = 1;
  std::size_t most_ = 0;  // points kept at a time
  std::vector<SaddlePoint> points_;
  std::vector<std::uint8_t> responses_;  // the rows around the current one, in a ring
  std::vector<std::uint8_t> peaks_;      // one bit a pixel
};

}  // namespace calvin::detect
