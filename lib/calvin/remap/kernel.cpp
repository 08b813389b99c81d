// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#include "calvin/remap/kernel.hpp"

#include <bit>

namespace calvin {

namespace {

constexpr int kBits = RemapMap::kFractionBits;
constexpr int kOne = RemapMap::kOne;

// A sample in memory as a number; Sum holds kOne^2 times the largest.
struct Byte {
  using Sum = std::int32_t;
  explicit Byte(const PlaneLayout& /*layout*/) {}

  [[nodiscard]] static Sum load(const std::uint8_t* at) noexcept { return *at; }
  static void store(std::uint8_t* at, Sum value) noexcept {
    *at = static_cast<std::uint8_t>(value);
  }
};

template <std::endian kOrder>
struct Word {
  using Sum = std::int64_t;
  explicit Word(const PlaneLayout& layout) : shift(layout.shift) {}

  [[nodiscard]] Sum load(const std::uint8_t* at) const noexcept {
    return static_cast<std::uint16_t>(at[kHigh] << 8 | at[1 - kHigh]) >> shift;
  }
  void store(std::uint8_t* at, Sum value) const noexcept {
    const auto word = static_cast<std::uint16_t>(value << shift);
    at[kHigh] = static_cast<std::uint8_t>(word >> 8);
    at[1 - kHigh] = static_cast<std::uint8_t>(word);
  }

  static constexpr int kHigh = kOrder == std::endian::little ? 1 : 0;
  int shift;
};

template <typename Sample, int kComponents>
void remap_components(const RemapMap& map, const PlaneLayout& layout,
                      PlaneMemory<const std::uint8_t> source,
                      PlaneMemory<std::uint8_t> output) noexcept {
  using Sum = typename Sample::Sum;
  const Sample sample(layout);
  const std::ptrdiff_t pixel_step = layout.pixel_step;
  const std::ptrdiff_t component_step = layout.component_step;
  for (int y = 0; y < map.size().height; ++y) {
    std::uint8_t* out = output.data + y * output.stride;
    for (const MapEntry& entry : map.row(y)) {
      if (!entry.valid()) {
        for (int c = 0; c < kComponents; ++c) {
          sample.store(out + c * component_step, layout.fill[c]);
        }
        out += pixel_step;
        continue;
      }
      const int fx = entry.x & (kOne - 1);
      const int fy = entry.y & (kOne - 1);
      const std::uint8_t* top =
          source.data + (entry.y >> kBits) * source.stride + (entry.x >> kBits) * pixel_step;
      // The last row and column have no neighbour, and with a weight of zero need none.
      const std::ptrdiff_t right = fx != 0 ? pixel_step : 0;
      const std::uint8_t* bottom = top + (fy != 0 ? source.stride : 0);
      for (int c = 0; c < kComponents; ++c) {
        const std::ptrdiff_t at = c * component_step;
        const Sum upper = sample.load(top + at) * (kOne - fx) + sample.load(top + at + right) * fx;
        const Sum lower =
            sample.load(bottom + at) * (kOne - fx) + sample.load(bottom + at + right) * fx;
        const Sum sum = upper * (kOne - fy) + lower * fy;
        sample.store(out + at, (sum + (Sum{1} << (2 * kBits - 1))) >> (2 * kBits));
      }
      out += pixel_step;
    }
  }
}

using Remap = decltype(&remap_components<Byte, 1>);

template <typename Sample>
constexpr Remap kRemaps[] = {remap_components<Sample, 1>, remap_components<Sample, 2>,
                             remap_components<Sample, 3>, remap_components<Sample, 4>};

}  // namespace

void remap_plane(const RemapMap& map, const PlaneLayout& layout,
                 PlaneMemory<const std::uint8_t> source,
                 PlaneMemory<std::uint8_t> output) noexcept {
  static_assert(255LL * kOne * kOne + (1LL << (2 * kBits - 1)) <= INT32_MAX);
  if (layout.components < 1 || layout.components > 4) return;
  const auto components = static_cast<std::size_t>(layout.components - 1);
  switch (layout.sample) {
    case SampleType::kU8:
      return kRemaps<Byte>[components](map, layout, source, output);
    case SampleType::kU16Little:
      return kRemaps<Word<std::endian::little>>[components](map, layout, source, output);
    case SampleType::kU16Big:
      return kRemaps<Word<std::endian::big>>[components](map, layout, source, output);
  }
}

}  // namespace calvin
