// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Chooses the kernels for a plane by its memory layout and by the interpolation, and finds what
// they may read of the source.

#include "calvin/remap/kernels/choice.hpp"

#include <algorithm>
#include <bit>
#include <limits>

#include "calvin/remap/kernels/scalar/scalar_kernel.hpp"

namespace calvin::remap {

namespace {

constexpr bool kLittleEndian = std::endian::native == std::endian::little;

PixelLayout pixel_layout_of(const PlaneLayout& layout) {
  if (layout.sample != SampleType::kU8) {
    if (!kLittleEndian) return PixelLayout::kNone;
    if (layout.components == 1 && layout.pixel_step == 2) return PixelLayout::kOneWord;
    const bool pairs =
        layout.components == 2 && layout.pixel_step == 4 && layout.component_step == 2;
    return pairs ? PixelLayout::kTwoWords : PixelLayout::kNone;
  }
  const auto is = [&](int components, int pixel_step, int component_step) {
    return layout.components == components && layout.pixel_step == pixel_step &&
           (components == 1 || layout.component_step == component_step);
  };
  if (is(1, 1, 1)) return PixelLayout::kOne;
  if (is(2, 2, 1)) return PixelLayout::kTwo;
  if (is(3, 3, 1)) return PixelLayout::kThree;
  if (is(4, 4, 1)) return PixelLayout::kFour;
  if (is(1, 2, 2)) return PixelLayout::kOneStrided;
  if (is(2, 4, 2)) return PixelLayout::kTwoStrided;
  return PixelLayout::kNone;
}

bool is_strided(PixelLayout layout) {
  return layout == PixelLayout::kOneStrided || layout == PixelLayout::kTwoStrided;
}

// What the bilinear and the bicubic kernels may read of a source plane.
SourceBounds bounds_of(const PlaneMap& map, const PlaneLayout& layout, PixelLayout pixel_layout,
                       std::span<const PlaneMemory<const std::uint8_t>> sources) {
  const std::ptrdiff_t stride = sources.front().stride;
  const bool alike = sources.back().stride == stride;
  const ImageSize size = map.source_size();
  SourceBounds b;
  b.stride = static_cast<std::int32_t>(stride);
  // Where the first sample lies before the frame, so may coordinates between it and the next one.
  b.first_column = map.source_x().offset() < 0 ? 1 : 0;
  b.first_row = map.source_y().offset() < 0 ? 1 : 0;
  // The distance to an uneven last sample is not that of the others: coordinates end before it.
  b.last_column = size.width - (map.source_x().is_even() ? 1 : 2);
  b.last_row = size.height - (map.source_y().is_even() ? 1 : 2);
  // A lane reads 16 bytes, and one with samples in every second byte 32; a run of several lanes may
  // be read as one window. Pixels with addresses of their own are read by 16 bytes, too.
  const int step = is_words(pixel_layout) ? 2 * layout.components : layout.components;
  const int in_lane = is_words(pixel_layout) ? 8 / step : pixels_per_lane(pixel_layout);
  const int span = map.run_pixels() / std::min(in_lane, map.run_pixels());
  const int lane = is_strided(pixel_layout) ? 32 : 16;
  const int parts = step > 2 ? 5 : span == 1 ? 1 : span + 1;
  const int segment = lane * parts;
  const int columns = (15 - (step - 1)) / step;
  b.max_columns = span == 1 ? columns : 15;
  // 0x6800 / 2^14 = 1.625 samples: the last pixel of a lane and its neighbour must lie in the
  // segment.
  if (span > 1) b.max_slope = 0x6800;
  const auto bytes = static_cast<std::int32_t>(layout.pixel_step) * size.width;
  b.columns = size.width;
  b.rows = size.height;
  b.guarded_rows = bytes >= segment ? 1 : size.height;
  b.last_segment = bytes - segment - 1;
  b.strongly_bent = map.strongly_bent();
  // The two planes share their offsets, which must fit into 31 bits.
  if (!alike || stride < bytes ||
      stride > std::numeric_limits<std::int32_t>::max() / (size.height + 64)) {
    b.last_row = -1;
  }
  return b;
}

// `last` is the centre of the frame's last pixel, px.
AxisEnds ends_of(const SampleAxis& axis, double last) {
  const auto coord = [&](double pixel) {
    return static_cast<float>((pixel - axis.offset()) / axis.scale());
  };
  const int samples = axis.count() - (axis.is_even() ? 1 : 2);
  return {axis.count(), coord(-kBorderSlack), coord(last + kBorderSlack), std::max(coord(0), 0.0F),
          samples,      !axis.is_even()};
}

// How the bicubic kernel takes a plane, if it does.
std::optional<BicubicFormat> bicubic_format(const PlaneMap& map, const PlaneLayout& layout,
                                            Interpolation interpolation) {
  const bool filtered =
      interpolation == Interpolation::kBicubic || interpolation == Interpolation::kLanczos;
  const bool words = layout.sample != SampleType::kU8;
  const auto bits = static_cast<int>(8 * layout.component_step);
  const bool fits = (layout.components - 1) * bits + (words ? 16 : 8) <= 32;
  if (!filtered || !fits || !kLittleEndian || map.run_pixels() != 8) return std::nullopt;
  BicubicFormat format;
  format.taps = interpolation == Interpolation::kBicubic ? 4 : 6;
  format.components = layout.components;
  format.component_bits = bits;
  format.pixel_step = static_cast<int>(layout.pixel_step);
  format.words = words;
  format.word = word_format(layout);
  const int depth = !words ? 8 : layout.bits > 0 ? layout.bits : 16 - layout.shift;
  format.largest = static_cast<float>((1 << depth) - 1);
  format.spare = (3 + format.pixel_step - 1) / format.pixel_step;
  return format;
}

// How the bilinear and the gather kernels take a plane, if they do.
PixelLayout usable_layout(const PlaneMap& map, const PlaneLayout& layout,
                          const Sampling& sampling) {
  const PixelLayout pixel_layout = pixel_layout_of(layout);
  const bool simple = sampling.interpolation == Interpolation::kNearest ||
                      sampling.interpolation == Interpolation::kBilinear;
  const bool fits = map.run_pixels() == 8 || map.run_pixels() == pixels_per_lane(pixel_layout);
  return simple && fits ? pixel_layout : PixelLayout::kNone;
}

}  // namespace

WordFormat word_format(const PlaneLayout& layout) noexcept {
  return {layout.sample == SampleType::kU16Big, layout.shift};
}

KernelChoice choose_kernel(const PlaneMap& map, const PlaneLayout& layout, const Sampling& sampling,
                           std::span<const PlaneMemory<const std::uint8_t>> sources) noexcept {
  KernelChoice choice;
  choice.pixel_layout = usable_layout(map, layout, sampling);
  choice.bicubic = bicubic_format(map, layout, sampling.interpolation);
  choice.bounds = bounds_of(map, layout, choice.pixel_layout, sources);
  choice.bounds.fills = sampling.outside == Outside::kFill;
  if (choice.pixel_layout == PixelLayout::kNone && !choice.bicubic) choice.bounds.last_row = -1;
  choice.x_ends = ends_of(map.source_x(), map.source_last().u);
  choice.y_ends = ends_of(map.source_y(), map.source_last().v);
  return choice;
}

}  // namespace calvin::remap

namespace calvin {

int pixels_per_lane_of(const PlaneLayout& layout) noexcept {
  return remap::pixels_per_lane(remap::pixel_layout_of(layout));
}

}  // namespace calvin
