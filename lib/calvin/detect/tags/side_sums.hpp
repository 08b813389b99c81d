// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The sums over the pixels along a side of a tag from which its fit takes a step.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace calvin::detect {

enum SideUnknown {
  kSideOffset,
  kSideSlope,
  kSideWidth,  // its logarithm
  kSideIn,
  kSideInSlope,
  kSideOut,
  kSideOutSlope,
  kSideBend,
  kSideUnknowns
};
inline constexpr int kSideProducts = kSideUnknowns * (kSideUnknowns + 1) / 2;

inline constexpr int kSideSegments = 8;

// The pixels along a side, one number of each after the other. Behind the last one there is room
// for a vector.
struct SidePixels {
  int count = 0;
  std::vector<float> t;
  std::vector<float> n;  // px
  std::vector<float> grey;
  std::vector<float> first;           // the bits of the first row, blurred along the side
  std::vector<float> second;          // and of the second one
  std::vector<float> beyond;          // and behind the gap
  std::vector<float> weight;          // 1, or 0 for a pixel that shows something else
  std::vector<float> error;           // of the fit, grey levels
  std::vector<std::int32_t> segment;  // of the side, from t = -1 on

  [[nodiscard]] std::size_t segment_of(std::size_t pixel) const {
    return static_cast<std::size_t>(segment[pixel]);
  }
  void clear() { count = 0; }
  // Makes room for so many more; returns the place of the first of them.
  [[nodiscard]] std::size_t append(int more);
  // After the last one: makes the room behind it, without weight.
  void finish();
};

// Rows of bits as blur along the side leaves them, at places from t = -1 to 1.
struct SideBits {
  static constexpr int kSamples = 12 * kSideSegments + 1;
  using Row = std::array<float, kSamples + 1>;  // the last sample twice

  Row first{};
  Row second{};
  Row beyond{};
};

// Gives pixels their segments and what the rows of bits are there: the last row where it is wanted.
void add_bits(SidePixels& pixels, const SideBits& bits, bool beyond) noexcept;

// The numbers of side_fit.hpp; an edge beside the side is at + slope t.
struct SideModel {
  float offset = 0;
  float slope = 0;
  float bend = 0;
  float width = 0.8F;
  float in = 0;
  float in_slope = 0;
  float out = 0;
  float out_slope = 0;
  float border[2] = {0, 0};
  float second[2] = {0, 0};
  float gap[2] = {0, 0};
  bool has_beyond = false;  // somewhere
};

// J^T J (upper triangle, row by row), J^T e and e^T e, over the pixels with a weight.
struct SideNormal {
  float products[kSideProducts];
  float gradient[kSideUnknowns];
  float square;
};

// Which sums are taken.
enum class SideSums { kAll, kGradient };

// Writes the errors of all pixels, too. `products` are left as they are where the gradient alone is
// wanted.
void accumulate_side(SidePixels& pixels, const SideModel& model, SideSums sums,
                     SideNormal& normal) noexcept;

}  // namespace calvin::detect
