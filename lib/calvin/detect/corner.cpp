// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#include "calvin/detect/corner.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace calvin::detect {

namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kLeastContrast = 8;   // grey levels
constexpr float kLargestKink = 0.6F;  // rad, between the two halves of an edge
constexpr float kLeastAngle = 0.3F;   // rad, between the edges

constexpr int kMaxSamples = 28;

// The pixels of a ring in the order of their angles. Point-symmetric: the second half is the first
// one negated.
struct Ring {
  int count = 0;
  std::array<int, kMaxSamples> x{};
  std::array<int, kMaxSamples> y{};
  std::array<float, kMaxSamples + 1> angle{};  // the last is the first, a turn further on
};

Ring make_ring(float radius, int count) {
  Ring ring;
  ring.count = count;
  for (int k = 0; k < count; ++k) {
    const int half = k % (count / 2);
    const int sign = k < count / 2 ? 1 : -1;
    const float angle = 2 * kPi * static_cast<float>(half) / static_cast<float>(count);
    const auto at = static_cast<std::size_t>(k);
    ring.x[at] = sign * static_cast<int>(std::lround(radius * std::cos(angle)));
    ring.y[at] = sign * static_cast<int>(std::lround(radius * std::sin(angle)));
    float seen = std::atan2(static_cast<float>(ring.y[at]), static_cast<float>(ring.x[at]));
    if (seen < 0) seen += 2 * kPi;
    ring.angle[at] = seen;
  }
  ring.angle[static_cast<std::size_t>(count)] = ring.angle[0] + 2 * kPi;
  return ring;
}

struct Samples {
  std::array<float, kMaxSamples> grey{};  // less the middle between the extremes
  float contrast = 0;
};

Samples sample(const ImageView& image, int x, int y, const Ring& ring) {
  std::array<int, kMaxSamples + 2> raw{};
  const std::uint8_t* at = image.data + y * image.stride + x;
  const auto count = static_cast<std::size_t>(ring.count);
  for (std::size_t k = 0; k < count; ++k) raw[k + 1] = at[ring.y[k] * image.stride + ring.x[k]];
  raw[0] = raw[count];
  raw[count + 1] = raw[1];
  int least = 4 * 255;
  int most = 0;
  std::array<int, kMaxSamples> smooth{};
  for (std::size_t k = 0; k < count; ++k) {
    smooth[k] = raw[k] + 2 * raw[k + 1] + raw[k + 2];
    least = std::min(least, smooth[k]);
    most = std::max(most, smooth[k]);
  }
  Samples samples;
  const float middle = 0.5F * static_cast<float>(least + most);
  for (std::size_t k = 0; k < count; ++k) {
    samples.grey[k] = 0.25F * (static_cast<float>(smooth[k]) - middle);
  }
  samples.contrast = 0.25F * static_cast<float>(most - least);
  return samples;
}

bool is_symmetric(const Samples& samples, const Ring& ring, float asymmetry) {
  const auto half = static_cast<std::size_t>(ring.count / 2);
  float differences = 0;
  float deviations = 0;
  for (std::size_t k = 0; k < half; ++k) {
    differences += std::abs(samples.grey[k] - samples.grey[k + half]);
    deviations += std::abs(samples.grey[k]) + std::abs(samples.grey[k + half]);
  }
  return differences <= asymmetry * deviations;
}

Direction direction(float angle) { return {std::cos(angle), std::sin(angle)}; }

}  // namespace

bool check_ring(const ImageView& image, int x, int y, RingSize size, float asymmetry,
                Corner& corner) noexcept {
  static const Ring kSmall = make_ring(3.3F, 20);
  static const Ring kLarge = make_ring(4.5F, 28);
  const Ring& ring = size == RingSize::kSmall ? kSmall : kLarge;
  const Samples samples = sample(image, x, y, ring);
  if (samples.contrast < kLeastContrast || !is_symmetric(samples, ring, asymmetry)) return false;

  std::array<float, 4> change{};  // rad, where the colour changes
  std::size_t changes = 0;
  bool first_rises = false;
  const auto count = static_cast<std::size_t>(ring.count);
  for (std::size_t k = 0; k < count; ++k) {
    const float a = samples.grey[k];
    const float b = samples.grey[k + 1 == count ? 0 : k + 1];
    if ((a < 0) == (b < 0)) continue;
    if (changes == 4) return false;
    if (changes == 0) first_rises = b >= 0;
    change[changes++] = ring.angle[k] + a / (a - b) * (ring.angle[k + 1] - ring.angle[k]);
  }
  if (changes != 4) return false;
  if (std::abs(change[2] - change[0] - kPi) > kLargestKink ||
      std::abs(change[3] - change[1] - kPi) > kLargestKink) {
    return false;
  }
  const float first = 0.5F * (change[0] + change[2] - kPi);
  const float second = 0.5F * (change[1] + change[3] - kPi);
  if (second - first < kLeastAngle || second - first > kPi - kLeastAngle) return false;
  corner.rising = direction(first_rises ? first : second);
  corner.falling = direction(first_rises ? second : first + kPi);
  corner.contrast = samples.contrast;
  return true;
}

}  // namespace calvin::detect
