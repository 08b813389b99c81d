// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Binomial smoothing of rows and columns, a vector at a time, and the median that tells the noise.

#include "calvin/core/vector_targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "calvin/detect/smoothing.cpp"
#include <hwy/foreach_target.h>
// The order matters: Highway includes this file again for each target from the line above.
#include <hwy/highway.h>

#include "calvin/detect/smoothing.hpp"

HWY_BEFORE_NAMESPACE();
namespace calvin::detect::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// a + 4 b + 6 c + 4 d + e
template <class V>
HWY_INLINE V binomial(V a, V b, V c, V d, V e) {
  const V inner = hn::Add(hn::Add(b, d), c);
  return hn::Add(hn::Add(hn::Add(a, e), hn::ShiftLeft<2>(inner)), hn::ShiftLeft<1>(c));
}

// Sums over five rows.
void sum_rows(const std::uint8_t* const* rows, std::uint16_t* out, std::size_t count) {
  const hn::ScalableTag<std::uint16_t> d;
  const hn::Rebind<std::uint8_t, decltype(d)> bytes;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    const auto at = [&](int row) { return hn::PromoteTo(d, hn::LoadU(bytes, rows[row] + i)); };
    hn::StoreU(binomial(at(0), at(1), at(2), at(3), at(4)), d, out + i);
  }
  for (; i < count; ++i) {
    const auto at = [&](int row) { return unsigned{rows[row][i]}; };
    out[i] = static_cast<std::uint16_t>(at(0) + 4 * (at(1) + at(3)) + 6 * at(2) + at(4));
  }
}

// Means of five sums in a row, of which the first is two before the pixel.
void average_columns(const std::uint16_t* sums, std::uint8_t* out, std::size_t count) {
  const hn::ScalableTag<std::uint16_t> d;
  const hn::RebindToSigned<decltype(d)> integers;
  const hn::Rebind<std::uint8_t, decltype(d)> bytes;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    const auto at = [&](std::size_t k) { return hn::LoadU(d, sums + i + k); };
    const auto sum = hn::Add(binomial(at(0), at(1), at(2), at(3), at(4)), hn::Set(d, 128));
    hn::StoreU(hn::DemoteTo(bytes, hn::BitCast(integers, hn::ShiftRight<8>(sum))), bytes, out + i);
  }
  for (; i < count; ++i) {
    const auto at = [&](std::size_t k) { return unsigned{sums[i + k]}; };
    const unsigned sum = at(0) + 4 * (at(1) + at(3)) + 6 * at(2) + at(4);
    out[i] = static_cast<std::uint8_t>((sum + 128) >> 8);
  }
}

}  // namespace calvin::detect::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace calvin::detect {

namespace {

HWY_EXPORT(sum_rows);
HWY_EXPORT(average_columns);

}  // namespace

float noise_of(const ImageView& image) noexcept {
  constexpr int kAway = 2;  // px
  constexpr double kSamples = 1000;
  // Of the differences along a row and along a column the smaller one counts, which an edge reaches
  // only at corners. The median of that is .376 of their sigma.
  constexpr float kOfMedian = 1 / (0.376F * 2.4495F);
  constexpr std::size_t kMost = 64;  // grey levels; larger differences count as this
  std::array<int, kMost + 1> counts{};
  const int step = std::max(
      1, static_cast<int>(std::sqrt(static_cast<double>(image.width) * image.height / kSamples)));
  int samples = 0;
  for (int y = kAway; y < image.height - kAway; y += step) {
    const std::uint8_t* row = image.data + y * image.stride;
    for (int x = kAway; x < image.width - kAway; x += step, ++samples) {
      const std::uint8_t* at = row + x;
      const int along = std::abs(at[-kAway] - 2 * at[0] + at[kAway]);
      const int down = std::abs(at[-kAway * image.stride] - 2 * at[0] + at[kAway * image.stride]);
      ++counts[std::min(static_cast<std::size_t>(std::min(along, down)), kMost)];
    }
  }
  std::size_t median = 0;
  for (int below = counts[0]; median < kMost && 2 * below < samples; below += counts[median]) {
    ++median;
  }
  return kOfMedian * static_cast<float>(median);
}

ImageView smoothed(const ImageView& image, std::vector<std::uint8_t>& pixels,
                   std::vector<std::uint16_t>& sums) {
  constexpr std::size_t kReach = 2;  // px
  const auto width = static_cast<std::size_t>(image.width);
  const std::size_t size = width * static_cast<std::size_t>(image.height);
  if (pixels.size() < size) pixels.resize(size);
  if (sums.size() < width + 2 * kReach) sums.resize(width + 2 * kReach);
  for (int y = 0; y < image.height; ++y) {
    const std::uint8_t* rows[5];
    for (int k = 0; k < 5; ++k) {
      rows[k] = image.data + std::clamp(y + k - 2, 0, image.height - 1) * image.stride;
    }
    HWY_DYNAMIC_DISPATCH(sum_rows)(rows, sums.data() + kReach, width);
    std::fill_n(sums.data(), kReach, sums[kReach]);
    std::fill_n(sums.data() + kReach + width, kReach, sums[kReach + width - 1]);
    HWY_DYNAMIC_DISPATCH(average_columns)
    (sums.data(), pixels.data() + static_cast<std::size_t>(y) * width, width);
  }
  return {pixels.data(), image.width, image.height, image.width, 1};
}

}  // namespace calvin::detect

#endif  // HWY_ONCE
