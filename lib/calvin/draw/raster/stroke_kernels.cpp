// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Paints shapes by the distance of each pixel from them, a vector of pixels at a time: a frame has
// hundreds of short lines and small circles, and a path of its own costs each of them more than
// its pixels do.

#include "calvin/core/vector_targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "calvin/draw/raster/stroke_kernels.cpp"
#include <hwy/foreach_target.h>
// The order matters: Highway includes this file again for each target from the line above.
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>

#include "calvin/draw/raster/stroke_kernels.hpp"

HWY_BEFORE_NAMESPACE();
namespace calvin::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr int kBlock = TilePlanes::kBlock;
constexpr float kHalfUp =
    1 + 0x1p-22F;  // so that what lies between two levels becomes the upper one
constexpr float kWhole = 255 * kHalfUp;
constexpr float kHalfDark = kWhole / 2;  // what is around shapes

using Floats = hn::CappedTag<float, kBlock>;
using Wide = hn::CappedTag<std::uint16_t, kBlock>;
using FloatVec = hn::Vec<Floats>;
using WideVec = hn::Vec<Wide>;
// Or there are as many floats in a vector.
constexpr bool kFloatsAreHalf = hn::MaxLanes(Floats()) < hn::MaxLanes(Wide());

// t / 255, rounded, for t up to 255 * 255.
HWY_INLINE WideVec divided(WideVec t) {
  const Wide wide;
  return hn::MulHigh(hn::Add(t, hn::Set(wide, 128)), hn::Set(wide, 257));
}

// A whole number of 0..255 of each pixel.
template <class D>
HWY_INLINE auto whole_numbers(D to, FloatVec level) {
  const Floats d;
  const hn::Rebind<std::int32_t, Floats> integers;
  // As the last bits of a float of 24: a conversion that minds other numbers costs four times this.
  const auto bits = hn::BitCast(integers, hn::Add(level, hn::Set(d, 8388608.0F)));
  return hn::DemoteTo(to, hn::And(bits, hn::Set(integers, 0xFF)));
}

// The shares of pixels of which `level` tells for a vector of floats from the i-th on.
template <class Level>
HWY_INLINE WideVec shares_of(Level level) {
  const Wide wide;
#if HWY_TARGET == HWY_SCALAR
  return whole_numbers(wide, level(0));
#else
  if constexpr (kFloatsAreHalf) {
    const hn::Half<Wide> half;
    const auto upper = whole_numbers(half, level(static_cast<int>(hn::Lanes(half))));
    return hn::Combine(wide, upper, whole_numbers(half, level(0)));
  } else {
    return whole_numbers(wide, level(0));
  }
#endif
}

// The share of a pixel whose centre is `inside` px within the edge, in units of `whole`.
HWY_INLINE FloatVec level_of(FloatVec inside, FloatVec whole) {
  const Floats d;
  return hn::Mul(hn::Min(hn::Max(inside, hn::Zero(d)), hn::Set(d, 1)), whole);
}

using Block = std::array<std::uint8_t*, TilePlanes::kPlanes>;

// An ink in vectors. Of the alpha plane it is opaque: how much of it there is, the share says.
struct Levels {
  explicit Levels(const Ink& ink)
      : level{hn::Set(Wide(), ink.bgra[0]), hn::Set(Wide(), ink.bgra[1]),
              hn::Set(Wide(), ink.bgra[2]), hn::Set(Wide(), 255)} {}
  WideVec level[4];
};

// The ink over what is there, by the shares of the pixels from the i-th of a block on.
HWY_INLINE void blend_ink(WideVec share, const Levels& ink, const Block& block, int i) {
  const Wide wide;
  const hn::Rebind<std::int16_t, Wide> narrowing;
  const hn::Rebind<std::uint8_t, Wide> bytes;
  if (hn::AllTrue(wide, hn::Eq(share, hn::Zero(wide)))) return;
  const auto keep = hn::Sub(hn::Set(wide, 255), share);
  for (std::size_t c = 0; c < 4; ++c) {
    std::uint8_t* at = block[c] + i;
    const auto before = hn::PromoteTo(wide, hn::LoadU(bytes, at));
    const auto sum = divided(hn::Add(hn::Mul(share, ink.level[c]), hn::Mul(keep, before)));
    hn::StoreU(hn::DemoteTo(bytes, hn::BitCast(narrowing, sum)), bytes, at);
  }
}

HWY_INLINE void darken(WideVec share, std::uint8_t* at) {
  const hn::Rebind<std::int16_t, Wide> narrowing;
  const hn::Rebind<std::uint8_t, Wide> bytes;
  const auto dark = hn::DemoteTo(bytes, hn::BitCast(narrowing, share));
  hn::StoreU(hn::Max(hn::LoadU(bytes, at), dark), bytes, at);
}

// A stroke in vectors: bytes are written between its uses, which might be its own for all that the
// compiler knows.
template <bool kIsLine>
struct StrokeLanes {
  explicit StrokeLanes(const Stroke& s)
      : x(s.x),
        y(s.y),
        slope(s.along_y),
        along_x(hn::Set(Floats(), s.along_x)),
        along_y(hn::Set(Floats(), s.along_y)),
        length(hn::Set(Floats(), s.length)),
        radius(hn::Set(Floats(), s.radius)) {}

  // How far the centres of pixels from px on are from the segment or the circle.
  [[nodiscard]] HWY_INLINE FloatVec distances(float px, float py) const {
    const Floats d;
    const auto dx = hn::Add(hn::Iota(d, 0), hn::Set(d, px - x));
    const auto dy = hn::Set(d, py - y);
    if constexpr (kIsLine) {
      const auto part = hn::MulAdd(dx, along_x, hn::Set(d, (py - y) * slope));
      const auto along = hn::Min(hn::Max(part, hn::Zero(d)), length);
      const auto u = hn::NegMulAdd(along, along_x, dx);
      const auto v = hn::NegMulAdd(along, along_y, dy);
      return hn::Sqrt(hn::MulAdd(u, u, hn::Mul(v, v)));
    } else {
      return hn::Abs(hn::Sub(hn::Sqrt(hn::MulAdd(dx, dx, hn::Mul(dy, dy))), radius));
    }
  }

  float x;
  float y;
  float slope;
  FloatVec along_x;
  FloatVec along_y;
  FloatVec length;
  FloatVec radius;
};

// Columns of the row that the stroke can touch, `reach` px from its segment or its centre.
HWY_INLINE std::pair<float, float> columns_of(const Stroke& s, float reach, float y) {
  const float dy = y - s.y;
  if (!(s.length > 0)) {
    const float half = std::sqrt(std::max(0.0F, reach * reach - dy * dy));
    return {s.x - half, s.x + half};
  }
  const float end = s.x + s.along_x * s.length;
  float first = std::min(s.x, end) - reach;
  float last = std::max(s.x, end) + reach;
  const float slope = std::abs(s.along_y);
  if (slope > 0.01F) {
    const float middle = s.x + dy * s.along_x / s.along_y;
    first = std::max(first, middle - reach / slope);
    last = std::min(last, middle + reach / slope);
  }
  return {first, last};
}

// The first pixel whose centre is at `x` or behind, wherever that is: a shape may lie far outside.
HWY_INLINE int first_pixel(float x) {
  constexpr float kBeyondAnyFrame = 1e6F;
  return static_cast<int>(std::ceil(std::min(std::max(0.0F, x), kBeyondAnyFrame)));
}

HWY_INLINE int first_block(float x) { return first_pixel(x) / kBlock; }

template <bool kIsLine>
void paint_rows(const Stroke& s, const Ink& ink, TilePlanes& planes) {
  const Floats d;
  const auto lanes = static_cast<int>(hn::Lanes(Wide()));
  const StrokeLanes<kIsLine> stroke(s);
  const Levels levels(ink);
  const float reach = s.radius + s.half + s.halo + 0.5F;
  const float to_y = s.y + s.along_y * s.length;
  const int top = first_pixel(std::min(s.y, to_y) - reach);
  const auto bottom =
      std::min(static_cast<float>(planes.height() - 1), std::max(s.y, to_y) + reach);
  const auto whole = hn::Set(d, kWhole / 255 * ink.bgra[3]);
  const auto half_dark = hn::Set(d, kHalfDark);
  const auto ink_edge = hn::Set(d, s.half + 0.5F);
  const auto dark_edge = hn::Set(d, s.half + s.halo + 0.5F);
  const bool has_halo = s.halo > 0;
  for (int y = top; static_cast<float>(y) <= bottom; ++y) {
    const auto row = static_cast<float>(y);
    const auto [first, last] = columns_of(s, reach, row);
    const float end = std::min(last, static_cast<float>(planes.width() - 1));
    for (int n = first_block(first); static_cast<float>(n * kBlock) <= end; ++n) {
      const Block block = planes.block(n, y);
      planes.is_painted(n, y) = 1;
      for (int i = 0; i < kBlock; i += lanes) {
        const auto x = static_cast<float>(n * kBlock + i);
        // None of these pixels is touched.
        if (x > last || x + static_cast<float>(lanes) <= first) continue;
        FloatVec away[] = {stroke.distances(x, row), hn::Zero(d)};
        if constexpr (kFloatsAreHalf) {
          away[1] = stroke.distances(x + static_cast<float>(hn::Lanes(d)), row);
        }
        const auto within = [&away](FloatVec edge, FloatVec units) {
          return shares_of(
              [&](int k) { return level_of(hn::Sub(edge, away[k == 0 ? 0 : 1]), units); });
        };
        if (has_halo) darken(within(dark_edge, half_dark), block[TilePlanes::kDark] + i);
        blend_ink(within(ink_edge, whole), levels, block, i);
      }
    }
  }
}

void paint_stroke(const Stroke& s, const Ink& ink, TilePlanes& planes) {
  if (s.length > 0) return paint_rows<true>(s, ink, planes);
  paint_rows<false>(s, ink, planes);
}

void paint_box(const InkedBox& box, const Ink& ink, TilePlanes& planes) {
  const Floats d;
  const auto lanes = static_cast<int>(hn::Lanes(Wide()));
  const Levels levels(ink);
  const auto covered = [](float centre, float from, float to) {
    return std::clamp(std::min(centre + 0.5F, to) - std::max(centre - 0.5F, from), 0.0F, 1.0F);
  };
  const int top = first_pixel(box.top - 0.5F);
  const float bottom = std::min(static_cast<float>(planes.height() - 1), box.bottom + 0.5F);
  const float end = std::min(static_cast<float>(planes.width() - 1), box.right + 0.5F);
  for (int y = top; static_cast<float>(y) <= bottom; ++y) {
    const auto whole = hn::Set(
        d, kWhole / 255 * ink.bgra[3] * covered(static_cast<float>(y), box.top, box.bottom));
    for (int n = first_block(box.left - 0.5F); static_cast<float>(n * kBlock) <= end; ++n) {
      planes.is_painted(n, y) = 1;
      const Block block = planes.block(n, y);
      for (int i = 0; i < kBlock; i += lanes) {
        const auto level = [&](int k) {
          const auto centre = hn::Iota(d, static_cast<float>(n * kBlock + i + k));
          const auto half = hn::Set(d, 0.5F);
          const auto to = hn::Min(hn::Add(centre, half), hn::Set(d, box.right));
          const auto from = hn::Max(hn::Sub(centre, half), hn::Set(d, box.left));
          return level_of(hn::Sub(to, from), whole);
        };
        blend_ink(shares_of(level), levels, block, i);
      }
    }
  }
}

HWY_INLINE void merge_block(const Block& block, std::uint8_t* argb) {
  const auto take = [](std::uint8_t* at) {
    const hn::Rebind<std::uint8_t, Wide> bytes;
    const auto value = hn::LoadU(bytes, at);
    hn::StoreU(hn::Zero(bytes), bytes, at);
    return value;
  };
  const Wide wide;
  const hn::Rebind<std::int16_t, Wide> narrowing;
  const hn::Rebind<std::uint8_t, Wide> bytes;
  const auto lanes = static_cast<int>(hn::Lanes(wide));
  for (int i = 0; i < kBlock; i += lanes) {
    const auto plane = [&](std::size_t p) { return take(block[p] + i); };
    const auto alpha = hn::PromoteTo(wide, plane(3));
    const auto dark = hn::PromoteTo(wide, plane(TilePlanes::kDark));
    const auto all = hn::Add(alpha, divided(hn::Mul(dark, hn::Sub(hn::Set(wide, 255), alpha))));
    hn::Vec<decltype(bytes)> c[4] = {plane(0), plane(1), plane(2),
                                     hn::DemoteTo(bytes, hn::BitCast(narrowing, all))};
    if constexpr (std::endian::native == std::endian::big) {
      std::swap(c[0], c[3]);
      std::swap(c[1], c[2]);
    }
    hn::StoreInterleaved4(c[0], c[1], c[2], c[3], bytes, argb + static_cast<std::ptrdiff_t>(4) * i);
  }
}

// Whoever reads a block empties it.
void merge_planes(TilePlanes& planes, std::span<const TileSpan> spans, std::uint8_t* argb) {
  for (const TileSpan& span : spans) {
    std::uint8_t* to = argb + 4 * span.at;
    for (int done = 0; done < span.count; done += kBlock, to += 4 * kBlock) {
      const Block block = planes.block((span.first + done) / kBlock, span.row);
      const int count = std::min(kBlock, span.count - done);
      std::uint8_t last[4 * kBlock];
      merge_block(block, count < kBlock ? last : to);
      if (count < kBlock) std::memcpy(to, last, 4 * static_cast<std::size_t>(count));
    }
  }
}

}  // namespace calvin::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace calvin {

namespace {

HWY_EXPORT(paint_stroke);
HWY_EXPORT(paint_box);
HWY_EXPORT(merge_planes);

}  // namespace

void TilePlanes::begin(int width, int height) {
  width_ = width;
  height_ = height;
  blocks_ = (width + kBlock - 1) / kBlock;
  const auto count = static_cast<std::size_t>(blocks_) * static_cast<std::size_t>(height);
  if (painted_.size() >= count) return;
  painted_.resize(count);
  bytes_.resize(count * kPlanes * kBlock);
}

void TilePlanes::take_painted(std::vector<TileSpan>& spans) {
  spans.clear();
  std::size_t held = 0;
  std::uint8_t* painted = painted_.data();
  for (int y = 0; y < height_; ++y, painted += blocks_) {
    int n = 0;
    while (n < blocks_) {
      n = static_cast<int>(std::find(painted + n, painted + blocks_, 1) - painted);
      const int first = n;
      while (n < blocks_ && std::exchange(painted[n], 0) != 0) ++n;
      if (first < n) {
        const int count = std::min(n * kBlock, width_) - first * kBlock;
        spans.push_back({y, first * kBlock, count, held});
        held += static_cast<std::size_t>(count);
      }
    }
  }
}

void paint_stroke(const Stroke& stroke, const Ink& ink, TilePlanes& planes) noexcept {
  HWY_DYNAMIC_DISPATCH(paint_stroke)(stroke, ink, planes);
}

void paint_box(const InkedBox& box, const Ink& ink, TilePlanes& planes) noexcept {
  HWY_DYNAMIC_DISPATCH(paint_box)(box, ink, planes);
}

void merge_planes(TilePlanes& planes, std::span<const TileSpan> spans,
                  std::uint8_t* argb) noexcept {
  HWY_DYNAMIC_DISPATCH(merge_planes)(planes, spans, argb);
}

}  // namespace calvin

#endif  // HWY_ONCE
