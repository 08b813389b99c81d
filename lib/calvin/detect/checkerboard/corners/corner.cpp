// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Samples the ring around a pixel and reads the directions of two edges from its changes.

#include "calvin/detect/checkerboard/corners/corner.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <numbers>

namespace calvin::detect {

namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr int kLeastContrast = 8;     // grey levels between the extremes of the ring
constexpr float kLargestKink = 0.6F;  // rad, between the two halves of an edge
constexpr float kLeastAngle = 0.3F;   // rad, between the edges

// The pixels of a ring in the order of their angles. Point-symmetric: the second half is the first
// one negated.
template <int kCount>
struct Ring {
  static constexpr int kSize = kCount;
  std::array<int, kCount> x{};
  std::array<int, kCount> y{};
  std::array<float, kCount + 1> angle{};  // the last is the first, a turn further on

  explicit Ring(float radius) {
    for (int k = 0; k < kCount; ++k) {
      const int half = k % (kCount / 2);
      const int sign = k < kCount / 2 ? 1 : -1;
      const float at_angle = 2 * kPi * static_cast<float>(half) / static_cast<float>(kCount);
      const auto at = static_cast<std::size_t>(k);
      x[at] = sign * static_cast<int>(std::lround(radius * std::cos(at_angle)));
      y[at] = sign * static_cast<int>(std::lround(radius * std::sin(at_angle)));
      float seen = std::atan2(static_cast<float>(y[at]), static_cast<float>(x[at]));
      if (seen < 0) seen += 2 * kPi;
      angle[at] = seen;
    }
    angle[kCount] = angle[0] + 2 * kPi;
  }
};

constexpr int kScale = 8;  // units of Samples::grey in a grey level

// The grey levels of a ring, smoothed along it. Whole numbers, and loops of a known length, which
// the compiler turns into vectors: every peak of the response is sampled.
template <int kCount>
struct Samples {
  std::array<int, kCount> grey{};  // kScale x grey levels, less the middle between the extremes
  int contrast = 0;                // likewise

  Samples(const ImageView& image, int x, int y, const Ring<kCount>& ring) {
    std::array<int, kCount + 2> raw{};
    const std::uint8_t* at = image.data + y * image.stride + x;
    for (std::size_t k = 0; k < kCount; ++k) raw[k + 1] = at[ring.y[k] * image.stride + ring.x[k]];
    raw[0] = raw[kCount];
    raw[kCount + 1] = raw[1];
    int least = 4 * 255;
    int most = 0;
    for (std::size_t k = 0; k < kCount; ++k) {
      grey[k] = raw[k] + 2 * raw[k + 1] + raw[k + 2];
      least = std::min(least, grey[k]);
      most = std::max(most, grey[k]);
    }
    contrast = 2 * (most - least);
    for (std::size_t k = 0; k < kCount; ++k) grey[k] = 2 * grey[k] - (least + most);
  }

  [[nodiscard]] bool is_symmetric(float asymmetry) const {
    constexpr std::size_t kHalf = kCount / 2;
    int differences = 0;
    int deviations = 0;
    for (std::size_t k = 0; k < kHalf; ++k) {
      differences += std::abs(grey[k] - grey[k + kHalf]);
      deviations += std::abs(grey[k]) + std::abs(grey[k + kHalf]);
    }
    return static_cast<float>(differences) <= asymmetry * static_cast<float>(deviations);
  }

  // A bit for each sample that differs in colour from the next one.
  [[nodiscard]] std::uint32_t changes() const {
    std::uint32_t dark = 0;
    for (std::size_t k = 0; k < kCount; ++k) dark |= (grey[k] < 0 ? 1U : 0U) << k;
    return dark ^ (dark >> 1 | (dark & 1U) << (kCount - 1));
  }
};

Direction direction(float angle) { return {std::cos(angle), std::sin(angle)}; }

template <int kCount>
bool check(const ImageView& image, int x, int y, const Ring<kCount>& ring, float asymmetry,
           Corner& corner) {
  const Samples<kCount> samples(image, x, y, ring);
  if (samples.contrast < kScale * kLeastContrast || !samples.is_symmetric(asymmetry)) return false;
  std::uint32_t changes = samples.changes();
  if (std::popcount(changes) != 4) return false;

  std::array<float, 4> change{};  // rad, where the colour changes
  const auto next = [&] {
    return std::min<std::size_t>(static_cast<std::size_t>(std::countr_zero(changes)), kCount - 1);
  };
  const bool first_rises = samples.grey[next()] < 0;
  for (float& angle : change) {
    const std::size_t k = next();
    const auto a = static_cast<float>(samples.grey[k]);
    const auto b = static_cast<float>(samples.grey[k + 1 == kCount ? 0 : k + 1]);
    angle = ring.angle[k] + a / (a - b) * (ring.angle[k + 1] - ring.angle[k]);
    changes &= changes - 1;
  }
  if (std::abs(change[2] - change[0] - kPi) > kLargestKink ||
      std::abs(change[3] - change[1] - kPi) > kLargestKink) {
    return false;
  }
  const float first = 0.5F * (change[0] + change[2] - kPi);
  const float second = 0.5F * (change[1] + change[3] - kPi);
  if (second - first < kLeastAngle || second - first > kPi - kLeastAngle) return false;
  corner.rising = direction(first_rises ? first : second);
  corner.falling = direction(first_rises ? second : first + kPi);
  corner.contrast = static_cast<float>(samples.contrast) / kScale;
  return true;
}

}  // namespace

bool check_ring(const ImageView& image, int x, int y, RingSize size, float asymmetry,
                Corner& corner) noexcept {
  static const Ring<20> kSmall(3.3F);
  static const Ring<28> kLarge(4.5F);
  return size == RingSize::kSmall ? check(image, x, y, kSmall, asymmetry, corner)
                                  : check(image, x, y, kLarge, asymmetry, corner);
}

}  // namespace calvin::detect
