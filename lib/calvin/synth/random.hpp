// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Random numbers that are the same on every machine, addressed by (seed, index).
#pragma once

#include <cstdint>
#include <vector>

namespace calvin::synth {

// 64 well mixed bits (the finaliser of SplitMix64: Steele, Lea, Flood, Fast Splittable Pseudorandom
// Number Generators, OOPSLA 2014).
[[nodiscard]] constexpr std::uint64_t mix(std::uint64_t x) noexcept {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}
[[nodiscard]] constexpr std::uint64_t mix(std::uint64_t seed, std::uint64_t index) noexcept {
  return mix(mix(seed) + index);
}

// Uniform in [low, high), one after the other.
class Uniform {
 public:
  Uniform(std::uint64_t seed, std::uint64_t stream) noexcept : state_(mix(seed, stream)) {}
  double operator()(double low, double high) noexcept {
    const double unit = static_cast<double>(mix(state_++) >> 11) * 0x1p-53;
    return low + (high - low) * unit;
  }

 private:
  std::uint64_t state_;
};

// The quantiles of the standard normal distribution in the middle of 65536 equal steps: 16 random
// bits pick one. Mean 0, variance 1, cut off at 4.3 sigma.
[[nodiscard]] const std::vector<float>& normal_quantiles();

}  // namespace calvin::synth
