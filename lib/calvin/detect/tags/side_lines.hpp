// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The pixels along a side of a tag as flat arrays: taken line by line of the image, and counted by
// segments of the side.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace calvin::detect {

inline constexpr int kSideSegments = 8;

// The pixels along a side, one number of each after the other. Behind the last one there is room
// for a vector, where no pixel has a weight.
struct SidePixels {
  int count = 0;
  int rows = 0;  // of bits that reach them, see SideBits
  bool has_beyond = false;
  std::vector<float> t;
  std::vector<float> n;  // px
  std::vector<float> grey;
  std::vector<float> first;           // the bits of the first row, blurred along the side
  std::vector<float> second;          // and of the second one, where they reach
  std::vector<float> beyond;          // and behind the gap, likewise
  std::vector<float> weight;          // 1, or 0 for a pixel that shows something else
  std::vector<float> error;           // of the fit, grey levels
  std::vector<std::int32_t> segment;  // of the side, from t = -1 on

  [[nodiscard]] std::size_t segment_of(std::size_t pixel) const {
    return static_cast<std::size_t>(segment[pixel]);
  }
  // Room for so many; each has a weight of 1.
  void resize(int pixels);
};

// Some pixels of a row of the image.
struct SideLine {
  const std::uint8_t* grey = nullptr;  // the first one
  int count = 0;
  int room = 0;  // px, from the first one to the end of the row
  float t = 0;   // of the first one
  float n = 0;
};
struct SideLines {
  std::vector<SideLine> all;
  int step = 1;    // px, from one pixel of a line to the next
  float by_t = 0;  // in a step
  float by_n = 0;
};

// What is behind the gap beside a side, as far as blur takes it to the pixels: nothing, another tag
// all along it, or bits.
enum class BehindGap { kNothing, kTag, kBits };

// Rows of bits as blur along the side leaves them, at places from t = -1 to 1.
struct SideBits {
  static constexpr int kSamples = 12 * kSideSegments + 1;
  using Row = std::array<float, kSamples + 1>;  // the last sample twice

  int rows = 0;  // that reach the pixels: blur leaves nothing of the edges of those further in
  Row first{};
  Row second{};
  BehindGap behind_gap = BehindGap::kNothing;
  Row beyond{};  // where bits are
};

// Takes the pixels of lines, with their segments and what the rows of bits are there.
void take_lines(const SideLines& lines, const SideBits& bits, SidePixels& pixels);

// How many pixels there are in each segment, and the sums of the squares of their errors.
struct SegmentSums {
  std::array<float, kSideSegments> count{};
  std::array<float, kSideSegments> square{};
};
[[nodiscard]] SegmentSums sums_of_segments(const SidePixels& pixels) noexcept;

}  // namespace calvin::detect
