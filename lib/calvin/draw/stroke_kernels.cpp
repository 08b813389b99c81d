// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Paints shapes by the distance of each pixel from them, a vector of pixels at a time: a frame has
// hundreds of short lines and small circles, and a path of its own costs each of them more than
// its pixels do.

#include "calvin/core/vector_targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "calvin/draw/stroke_kernels.cpp"
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

#include "calvin/draw/stroke_kernels.hpp"

HWY_BEFORE_NAMESPACE();
namespace calvin::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr int kBlock = TilePlanes::kBlock;
constexpr float kWhole = 255;
constexpr float kHalfDark = 127.5F;  // of 255: what is around shapes

using Floats = hn::CappedTag<float, kBlock>;
using Wide = hn::CappedTag<std::uint16_t, kBlock>;
using FloatVec = hn::Vec<Floats>;
using WideVec = hn::Vec<Wide>;

// t / 255, rounded, for t up to 255 * 255.
HWY_INLINE WideVec divided(WideVec t) {
  const Wide wide;
  return hn::MulHigh(hn::Add(t, hn::Set(wide, 128)), hn::Set(wide, 257));
}

// The share of a pixel whose centre is `inside` px within the edge, in units of `whole`.
HWY_INLINE void store_share(FloatVec inside, float whole, std::uint8_t* to) {
  const Floats d;
  const hn::Rebind<std::int32_t, Floats> integers;
  const hn::Rebind<std::uint8_t, Floats> bytes;
  const auto share = hn::Min(hn::Max(inside, hn::Zero(d)), hn::Set(d, 1));
  const auto level = hn::MulAdd(share, hn::Set(d, whole), hn::Set(d, 0.5F));
  hn::StoreU(hn::DemoteTo(bytes, hn::ConvertTo(integers, level)), bytes, to);
}

using Block = std::array<std::uint8_t*, TilePlanes::kPlanes>;

// The ink over what is there, by the shares of a block's pixels.
HWY_INLINE void blend_ink(const std::uint8_t* shares, const Ink& ink, const Block& block) {
  const Wide wide;
  const hn::Rebind<std::int16_t, Wide> narrowing;
  const hn::Rebind<std::uint8_t, Wide> bytes;
  const auto lanes = static_cast<int>(hn::Lanes(wide));
  for (int i = 0; i < kBlock; i += lanes) {
    const auto share = hn::LoadU(bytes, shares + i);
    if (hn::AllTrue(bytes, hn::Eq(share, hn::Zero(bytes)))) continue;
    const auto take = hn::PromoteTo(wide, share);
    const auto keep = hn::Sub(hn::Set(wide, 255), take);
    for (std::size_t c = 0; c < 4; ++c) {
      // Of the alpha plane the ink is opaque: how much of it there is, the share says.
      const auto level = hn::Set(wide, c == 3 ? 255 : ink.bgra[c]);
      std::uint8_t* at = block[c] + i;
      const auto before = hn::PromoteTo(wide, hn::LoadU(bytes, at));
      const auto sum = divided(hn::Add(hn::Mul(take, level), hn::Mul(keep, before)));
      hn::StoreU(hn::DemoteTo(bytes, hn::BitCast(narrowing, sum)), bytes, at);
    }
  }
}

HWY_INLINE void darken(const std::uint8_t* shares, std::uint8_t* row) {
  const hn::CappedTag<std::uint8_t, kBlock> bytes;
  const auto lanes = static_cast<int>(hn::Lanes(bytes));
  for (int i = 0; i < kBlock; i += lanes) {
    hn::StoreU(hn::Max(hn::LoadU(bytes, row + i), hn::LoadU(bytes, shares + i)), bytes, row + i);
  }
}

// How far the centres of pixels from x on are from the segment or the circle.
HWY_INLINE FloatVec distances(const Stroke& s, float x, float y) {
  const Floats d;
  const auto set = [d](float value) { return hn::Set(d, value); };
  const auto dx = hn::Add(hn::Iota(d, 0), set(x - s.x));
  const auto dy = set(y - s.y);
  const auto along = hn::Min(
      hn::Max(hn::MulAdd(dx, set(s.along_x), set((y - s.y) * s.along_y)), set(0)), set(s.length));
  const auto u = hn::NegMulAdd(along, set(s.along_x), dx);
  const auto v = hn::NegMulAdd(along, set(s.along_y), dy);
  return hn::Abs(hn::Sub(hn::Sqrt(hn::MulAdd(u, u, hn::Mul(v, v))), set(s.radius)));
}

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

void paint_stroke(const Stroke& s, const Ink& ink, TilePlanes& planes) {
  const Floats d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  const float reach = s.radius + s.half + s.halo + 0.5F;
  const float to_y = s.y + s.along_y * s.length;
  const int top = first_pixel(std::min(s.y, to_y) - reach);
  const auto bottom =
      std::min(static_cast<float>(planes.height() - 1), std::max(s.y, to_y) + reach);
  const float whole = kWhole / 255 * ink.bgra[3];
  for (int y = top; static_cast<float>(y) <= bottom; ++y) {
    const auto row = static_cast<float>(y);
    const auto [first, last] = columns_of(s, reach, row);
    const float end = std::min(last, static_cast<float>(planes.width() - 1));
    for (int n = first_block(first); static_cast<float>(n * kBlock) <= end; ++n) {
      std::uint8_t ink_shares[kBlock];
      std::uint8_t dark_shares[kBlock];
      for (int i = 0; i < kBlock; i += lanes) {
        const auto away = distances(s, static_cast<float>(n * kBlock + i), row);
        store_share(hn::Sub(hn::Set(d, s.half + 0.5F), away), whole, ink_shares + i);
        store_share(hn::Sub(hn::Set(d, s.half + s.halo + 0.5F), away), kHalfDark, dark_shares + i);
      }
      const Block block = planes.block(n, y);
      planes.is_painted(n, y) = 1;
      if (s.halo > 0) darken(dark_shares, block[TilePlanes::kDark]);
      blend_ink(ink_shares, ink, block);
    }
  }
}

void paint_box(const InkedBox& box, const Ink& ink, TilePlanes& planes) {
  const Floats d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  const auto covered = [](float centre, float from, float to) {
    return std::clamp(std::min(centre + 0.5F, to) - std::max(centre - 0.5F, from), 0.0F, 1.0F);
  };
  const int top = first_pixel(box.top - 0.5F);
  const float bottom = std::min(static_cast<float>(planes.height() - 1), box.bottom + 0.5F);
  const float end = std::min(static_cast<float>(planes.width() - 1), box.right + 0.5F);
  for (int y = top; static_cast<float>(y) <= bottom; ++y) {
    const float whole =
        kWhole / 255 * ink.bgra[3] * covered(static_cast<float>(y), box.top, box.bottom);
    for (int n = first_block(box.left - 0.5F); static_cast<float>(n * kBlock) <= end; ++n) {
      std::uint8_t shares[kBlock];
      for (int i = 0; i < kBlock; i += lanes) {
        const auto centre = hn::Iota(d, static_cast<float>(n * kBlock + i));
        const auto half = hn::Set(d, 0.5F);
        const auto to = hn::Min(hn::Add(centre, half), hn::Set(d, box.right));
        const auto from = hn::Max(hn::Sub(centre, half), hn::Set(d, box.left));
        store_share(hn::Sub(to, from), whole, shares + i);
      }
      planes.is_painted(n, y) = 1;
      blend_ink(shares, ink, planes.block(n, y));
    }
  }
}

void merge_block(const Block& block, std::uint8_t* argb) {
  const Wide wide;
  const hn::Rebind<std::int16_t, Wide> narrowing;
  const hn::Rebind<std::uint8_t, Wide> bytes;
  const auto lanes = static_cast<int>(hn::Lanes(wide));
  for (int i = 0; i < kBlock; i += lanes) {
    const auto plane = [&](std::size_t p) { return hn::LoadU(bytes, block[p] + i); };
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

void merge_planes(TilePlanes& planes, std::uint8_t* argb) {
  for (int y = 0; y < planes.height(); ++y) {
    for (int n = 0; n < planes.blocks(); ++n) {
      if (std::exchange(planes.is_painted(n, y), 0) == 0) continue;
      const Block block = planes.block(n, y);
      const int count = std::min(kBlock, planes.width() - n * kBlock);
      std::uint8_t* to = argb + 4 * (static_cast<std::ptrdiff_t>(y) * planes.width() + n * kBlock);
      std::uint8_t last[4 * kBlock];
      merge_block(block, count < kBlock ? last : to);
      if (count < kBlock) std::memcpy(to, last, 4 * static_cast<std::size_t>(count));
      std::memset(block[0], 0, TilePlanes::kPlanes * kBlock);
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

void paint_stroke(const Stroke& stroke, const Ink& ink, TilePlanes& planes) noexcept {
  HWY_DYNAMIC_DISPATCH(paint_stroke)(stroke, ink, planes);
}

void paint_box(const InkedBox& box, const Ink& ink, TilePlanes& planes) noexcept {
  HWY_DYNAMIC_DISPATCH(paint_box)(box, ink, planes);
}

void merge_planes(TilePlanes& planes, std::uint8_t* argb) noexcept {
  HWY_DYNAMIC_DISPATCH(merge_planes)(planes, argb);
}

}  // namespace calvin

#endif  // HWY_ONCE
