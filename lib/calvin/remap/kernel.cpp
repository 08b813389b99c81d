// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#include "calvin/remap/kernel.hpp"

namespace calvin {

namespace {

constexpr int kBits = RemapMap::kFractionBits;
constexpr int kOne = RemapMap::kOne;
static_assert(255LL * kOne * kOne + (1LL << (2 * kBits - 1)) <= INT32_MAX);

template <int kComponents>
void remap_components(const RemapMap& map, const PlaneLayout& layout,
                      PlaneMemory<const std::uint8_t> source,
                      PlaneMemory<std::uint8_t> output) noexcept {
  const std::ptrdiff_t pixel_step = layout.pixel_step;
  const std::ptrdiff_t component_step = layout.component_step;
  for (int y = 0; y < map.size().height; ++y) {
    std::uint8_t* out = output.data + y * output.stride;
    for (const MapEntry& entry : map.row(y)) {
      if (!entry.valid()) {
        for (int c = 0; c < kComponents; ++c) out[c * component_step] = layout.fill[c];
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
        const int upper = top[at] * (kOne - fx) + top[at + right] * fx;
        const int lower = bottom[at] * (kOne - fx) + bottom[at + right] * fx;
        const int sum = upper * (kOne - fy) + lower * fy;
        out[at] = static_cast<std::uint8_t>((sum + (1 << (2 * kBits - 1))) >> (2 * kBits));
      }
      out += pixel_step;
    }
  }
}

}  // namespace

void remap_plane(const RemapMap& map, const PlaneLayout& layout,
                 PlaneMemory<const std::uint8_t> source,
                 PlaneMemory<std::uint8_t> output) noexcept {
  constexpr decltype(&remap_components<1>) kKernels[] = {remap_components<1>, remap_components<2>,
                                                         remap_components<3>, remap_components<4>};
  if (layout.components < 1 || layout.components > 4) return;
  kKernels[layout.components - 1](map, layout, source, output);
}

}  // namespace calvin
