// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Bicubic and Lanczos resampling, eight samples at a time, for every instruction set: each result
// gathers its 4x4 or 6x6 neighbours, all components of one neighbour at a time, and is summed up in
// single precision. For every memory layout whose components lie within 32 bits.

#include "calvin/remap/kernels/bicubic/bicubic_kernel.hpp"
#include "calvin/core/vector_targets.hpp"

#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <type_traits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "calvin/remap/kernels/bicubic/bicubic_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

#include "calvin/remap/kernels/bicubic/run_coords-inl.hpp"
#include "calvin/remap/kernels/common/gather_ops-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace calvin::remap::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR
// Without vectors every run is slow.

void blend_bicubic(const BicubicFormat& /*format*/, const SourceBounds& /*bounds*/, RunRow& row,
                   const std::uint8_t* /*source*/, std::uint8_t* /*output*/) {
  for (int j = 0; j < row.count; ++j) row.marks[j] = bit(RunMark::kSlow);
}

#else

using Floats = CoordFloats;
using Ints = CoordInts;
using Words = hn::RebindToUnsigned<Floats>;
using Values = hn::Vec<Floats>;

// The weights of Catmull-Rom's spline (Keys 1981, a = -1/2) at `t` between the middle two of four.
HWY_INLINE std::array<Values, 4> weights_at(std::integral_constant<int, 4> /*taps*/, Values t) {
  const Floats d;
  const auto c = [&](float value) HWY_ATTR { return hn::Set(d, value); };
  const auto half = t * c(0.5F);
  return {half * hn::NegMulAdd(t, t - c(2), c(-1)),
          hn::MulAdd(t * t, hn::MulAdd(t, c(1.5F), c(-2.5F)), c(1)),
          half * hn::MulAdd(t, hn::NegMulAdd(t, c(3), c(4)), c(1)), half * t * (t - c(1))};
}

// Lanczos' kernel with three lobes: sinc(x) sinc(x / 3) at x = t - k. sin(pi x) is the same for all
// k but for its sign, and cancels out when the weights are divided by their sum; sin(pi x / 3)
// follows from the sine and cosine of pi t / 3, which are Taylor series here.
HWY_INLINE std::array<Values, 6> weights_at(std::integral_constant<int, 6> /*taps*/, Values t) {
  const Floats d;
  const auto c = [&](double value) HWY_ATTR { return hn::Set(d, static_cast<float>(value)); };
  // At 0 and at 1 one weight is 1 and the formula divides by 0; 1e-5 beside them one weight is
  // still 1 to single precision.
  t = hn::Min(hn::Max(t, c(1e-5)), c(1 - 1e-5));
  const auto a = t * c(std::numbers::pi / 3);
  const auto s = a * a;
  const auto sine =
      a *
      hn::MulAdd(
          s,
          hn::MulAdd(s, hn::MulAdd(s, hn::MulAdd(s, c(1 / 362880.0), c(-1 / 5040.0)), c(1 / 120.0)),
                     c(-1 / 6.0)),
          c(1));
  const auto cosine = hn::MulAdd(
      s,
      hn::MulAdd(s, hn::MulAdd(s, hn::MulAdd(s, c(1 / 40320.0), c(-1 / 720.0)), c(1 / 24.0)),
                 c(-0.5)),
      c(1));
  std::array<Values, 6> weights;
  Values sum = hn::Zero(d);
  for (int i = 0; i < 6; ++i) {
    const int k = i - 2;
    const double sign = k % 2 == 0 ? 1 : -1;
    const auto x = t - c(k);
    const auto numerator = hn::NegMulAdd(cosine, c(sign * std::sin(k * std::numbers::pi / 3)),
                                         sine * c(sign * std::cos(k * std::numbers::pi / 3)));
    weights[static_cast<std::size_t>(i)] = numerator / (x * x);
    sum = sum + weights[static_cast<std::size_t>(i)];
  }
  for (Values& weight : weights) weight = weight / sum;
  return weights;
}

// Resamples all components of a vector of samples: eight, or a part of the run.
template <int kTaps, int kComponents, bool kWords>
HWY_INLINE void blend_part(const BicubicFormat& format, const RunCoords& x, const RunCoords& y,
                           std::int32_t stride, const std::uint8_t* source, std::uint32_t* out) {
  const Floats d;
  const Ints ints;
  const Words words;
  const std::integral_constant<int, kTaps> taps;
  const auto across = weights_at(taps, x.rest);
  const auto down = weights_at(taps, y.rest);
  constexpr int kBefore = kTaps / 2 - 1;
  auto offsets = (y.whole - hn::Set(ints, kBefore)) * hn::Set(ints, stride) +
                 (x.whole - hn::Set(ints, kBefore)) * hn::Set(ints, format.pixel_step);
  alignas(64) std::int32_t at[hn::MaxLanes(d)];
  std::array<Values, kComponents> sums;
  sums.fill(hn::Zero(d));
  for (std::size_t r = 0; r < kTaps; ++r) {
    hn::Store(offsets, ints, at);
    std::array<Values, kComponents> row;
    row.fill(hn::Zero(d));
    for (std::size_t k = 0; k < kTaps; ++k) {
      const auto step = static_cast<std::ptrdiff_t>(k) * format.pixel_step;
      const auto pixels = load_each(words, source + step, at);
      for (std::size_t c = 0; c < kComponents; ++c) {
        const int bit = static_cast<int>(c) * format.component_bits;
        row[c] = hn::MulAdd(value_at<kWords>(pixels, format.word, bit), across[k], row[c]);
      }
    }
    for (std::size_t c = 0; c < kComponents; ++c) sums[c] = hn::MulAdd(row[c], down[r], sums[c]);
    offsets = offsets + hn::Set(ints, stride);
  }
  const auto largest = hn::Set(d, format.largest);
  for (std::size_t c = 0; c < kComponents; ++c) {
    const auto value = hn::NearestInt(hn::Min(hn::Max(sums[c], hn::Zero(d)), largest));
    hn::StoreU(hn::BitCast(words, value), words, out + c * kPixels);
  }
}

// Writes the eight pixels of a run; `values` are ordered by component.
void put(const BicubicFormat& format, const std::uint32_t* values, int components,
         std::uint8_t* output) {
  for (int i = 0; i < kPixels; ++i) {
    std::uint8_t* at = output + i * format.pixel_step;
    for (int c = 0; c < components; ++c) {
      const std::uint32_t value = values[c * kPixels + i];
      if (format.words) {
        auto word = static_cast<std::uint16_t>(value << format.word.shift);
        if (format.word.swapped) word = static_cast<std::uint16_t>(word << 8 | word >> 8);
        std::memcpy(at + c * (format.component_bits / 8), &word, 2);
      } else {
        at[c * (format.component_bits / 8)] = static_cast<std::uint8_t>(value);
      }
    }
  }
}

template <int kTaps, int kComponents, bool kWords>
void blend_runs(const BicubicFormat& format, const SourceBounds& bounds, RunRow& row,
                const std::uint8_t* source, std::uint8_t* output) {
  const Floats d;
  constexpr int kStep = static_cast<int>(hn::MaxLanes(d));
  alignas(64) std::uint32_t values[kComponents * kPixels];
  for (int j = 0; j < row.count; ++j) {
    if (has(row.marks[j], RunMark::kSlow)) continue;
    const RunCurve px(row.x + j);
    const RunCurve py(row.y + j);
    bool inside = true;
    for (int i = 0; i < kPixels && inside; i += kStep) {
      const RunCoords x = coords_at(px, i, false);
      const RunCoords y = coords_at(py, i, false);
      constexpr int kBefore = kTaps / 2 - 1;
      inside = are_within(x, kBefore, kTaps / 2, bounds.last_column - format.spare) &&
               are_within(y, kBefore, kTaps / 2, bounds.last_row);
      if (inside) {
        blend_part<kTaps, kComponents, kWords>(format, x, y, bounds.stride, source, values + i);
      }
    }
    if (inside) {
      put(format, values, kComponents, output + j * kPixels * format.pixel_step);
    } else {
      row.marks[j] = bit(RunMark::kSlow);
    }
  }
}

template <int kTaps>
void blend_taps(const BicubicFormat& format, const SourceBounds& bounds, RunRow& row,
                const std::uint8_t* source, std::uint8_t* output) {
  switch (format.words ? -format.components : format.components) {
    case 1:
      return blend_runs<kTaps, 1, false>(format, bounds, row, source, output);
    case 2:
      return blend_runs<kTaps, 2, false>(format, bounds, row, source, output);
    case 3:
      return blend_runs<kTaps, 3, false>(format, bounds, row, source, output);
    case 4:
      return blend_runs<kTaps, 4, false>(format, bounds, row, source, output);
    case -1:
      return blend_runs<kTaps, 1, true>(format, bounds, row, source, output);
    case -2:
      return blend_runs<kTaps, 2, true>(format, bounds, row, source, output);
    default:
      for (int j = 0; j < row.count; ++j) row.marks[j] = bit(RunMark::kSlow);
  }
}

void blend_bicubic(const BicubicFormat& format, const SourceBounds& bounds, RunRow& row,
                   const std::uint8_t* source, std::uint8_t* output) {
  format.taps == 4 ? blend_taps<4>(format, bounds, row, source, output)
                   : blend_taps<6>(format, bounds, row, source, output);
}

#endif

}  // namespace calvin::remap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace calvin::remap {

HWY_EXPORT(blend_bicubic);

void blend_bicubic_runs(const BicubicFormat& format, const SourceBounds& bounds, RunRow& row,
                        const std::uint8_t* source, std::uint8_t* output) noexcept {
  HWY_DYNAMIC_DISPATCH(blend_bicubic)(format, bounds, row, source, output);
}

}  // namespace calvin::remap
#endif
