// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Takes the pixels of tiles apart, puts them together as a plane has them, and blends the runs of a
// stamp, which are bytes whatever the format, a vector at a time.

#include "calvin/core/vector_targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "calvin/draw/raster/stamp_kernels.cpp"
#include <hwy/foreach_target.h>
// The order matters: Highway includes this file again for each target from the line above.
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>

#include "calvin/draw/raster/stamp_kernels.hpp"

HWY_BEFORE_NAMESPACE();
namespace calvin::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// keep frame / 255, rounded: 257 (keep frame + 128) / 65536 is exact.
template <class D, class V>
HWY_INLINE V kept(D d, V keep, V frame) {
  const V t = hn::Add(hn::Mul(keep, frame), hn::Set(d, 128));
  return hn::MulHigh(t, hn::Set(d, 257));
}

// add + keep frame / 255 of as many bytes as a vector has. Every other byte is the upper half of a
// lane of 16 bits.
template <class D>
HWY_INLINE void blend_vector(D bytes, const std::uint8_t* add, const std::uint8_t* keep,
                             std::uint8_t* frame) {
  const hn::RepartitionToWide<D> wide;
  const auto low = hn::Set(wide, 0xFF);
  const auto by = hn::BitCast(wide, hn::LoadU(bytes, keep));
  const auto of = hn::BitCast(wide, hn::LoadU(bytes, frame));
  const auto lower = kept(wide, hn::And(by, low), hn::And(of, low));
  const auto upper = kept(wide, hn::ShiftRight<8>(by), hn::ShiftRight<8>(of));
  const auto both = hn::BitCast(bytes, hn::Or(lower, hn::ShiftLeft<8>(upper)));
  hn::StoreU(hn::SaturatedAdd(hn::LoadU(bytes, add), both), bytes, frame);
}

// Runs have a multiple of 16 pixels, but for those at the end of a row.
void blend_bytes(const std::uint8_t* add, const std::uint8_t* keep, int count,
                 std::uint8_t* frame) {
  int i = 0;
#if HWY_TARGET != HWY_SCALAR
  const hn::CappedTag<std::uint8_t, 32> most;
  const hn::CappedTag<std::uint8_t, 16> half;
  for (; i + static_cast<int>(hn::Lanes(most)) <= count; i += static_cast<int>(hn::Lanes(most))) {
    blend_vector(most, add + i, keep + i, frame + i);
  }
  for (; i + static_cast<int>(hn::Lanes(half)) <= count; i += static_cast<int>(hn::Lanes(half))) {
    blend_vector(half, add + i, keep + i, frame + i);
  }
#endif
  for (; i < count; ++i) {
    const int t = keep[i] * frame[i] + 128;
    frame[i] = static_cast<std::uint8_t>(std::min(255, add[i] + ((t + (t >> 8)) >> 8)));
  }
}

void blend_stamp(const TileStamp& stamp, const FramePlanes& frame) {
  for (const TileStamp::Run& run : stamp.runs) {
    const auto plane = static_cast<std::size_t>(run.plane);
    std::uint8_t* row = frame.data[plane] + run.row * frame.stride[plane];
    blend_bytes(stamp.add.data() + run.first, stamp.keep.data() + run.first, run.count,
                row + run.byte);
  }
}

// The matrix in 256ths, of premultiplied colours: what it adds is multiplied by alpha too. No sum
// that is kept is below 0 or has more than 16 bits.
template <int kCount, class D, class V>
HWY_INLINE void to_yuv(D d, V r, V g, V b, V alpha, V* yuv) {
  const auto times = [d](V v, int factor) {
    return hn::Mul(v, hn::Set(d, static_cast<std::uint16_t>(factor)));
  };
  // alpha 256 / 255, exact at both ends.
  const V whole = hn::Add(alpha, hn::ShiftRight<7>(alpha));
  const V half = hn::ShiftLeft<7>(whole);
  const V light = hn::Add(times(r, 47), hn::Add(times(g, 157), times(b, 16)));
  yuv[0] = hn::ShiftRight<8>(hn::Add(light, hn::ShiftLeft<4>(whole)));
  if constexpr (kCount == 1) return;
  yuv[1] =
      hn::ShiftRight<8>(hn::Sub(hn::Add(half, times(b, 112)), hn::Add(times(r, 26), times(g, 87))));
  yuv[2] = hn::ShiftRight<8>(
      hn::Sub(hn::Add(half, times(r, 112)), hn::Add(times(g, 102), times(b, 10))));
}

template <Split kSplit>
void split_row(const std::uint8_t* argb, int count, const ComponentRows& to) {
  const hn::CappedTag<std::uint16_t, kSpareComponents> wide;
  const hn::Rebind<std::int16_t, decltype(wide)> narrowing;
  const hn::Rebind<std::uint8_t, decltype(wide)> bytes;
  const auto lanes = static_cast<int>(hn::Lanes(wide));
  for (int i = 0; i < count; i += lanes) {
    const std::uint8_t* from = argb + static_cast<std::ptrdiff_t>(4) * i;
    std::uint8_t last[4 * kSpareComponents] = {};
    if (count - i < lanes) {
      std::memcpy(last, from, 4 * static_cast<std::size_t>(count - i));
      from = last;
    }
    hn::VFromD<decltype(bytes)> c[4];
    hn::LoadInterleaved4(bytes, from, c[0], c[1], c[2], c[3]);
    if constexpr (std::endian::native == std::endian::big) {
      std::swap(c[0], c[3]);
      std::swap(c[1], c[2]);
    }
    hn::StoreU(hn::Sub(hn::Set(bytes, 255), c[3]), bytes, to.keep + i);
    if constexpr (kSplit == Split::kRgb) {
      for (int k = 0; k < 3; ++k) hn::StoreU(c[2 - k], bytes, to.add[k] + i);
    } else {
      hn::VFromD<decltype(wide)> yuv[3];
      constexpr int kCount = kSplit == Split::kLuma ? 1 : 3;
      to_yuv<kCount>(wide, hn::PromoteTo(wide, c[2]), hn::PromoteTo(wide, c[1]),
                     hn::PromoteTo(wide, c[0]), hn::PromoteTo(wide, c[3]), yuv);
      for (int k = 0; k < kCount; ++k) {
        hn::StoreU(hn::DemoteTo(bytes, hn::BitCast(narrowing, yuv[k])), bytes, to.add[k] + i);
      }
    }
  }
}

void split_pixels(const std::uint8_t* argb, int count, Split split, const ComponentRows& to) {
  switch (split) {
    case Split::kRgb:
      return split_row<Split::kRgb>(argb, count, to);
    case Split::kLuma:
      return split_row<Split::kLuma>(argb, count, to);
    case Split::kYuv:
      return split_row<Split::kYuv>(argb, count, to);
  }
}

// What is premultiplied is 0 where alpha is.
int blank_pixels(const std::uint8_t* argb, int count) {
  constexpr int kBlock = 16;
  const hn::CappedTag<std::uint8_t, 32> bytes;
  const auto lanes = static_cast<int>(hn::Lanes(bytes));
  int i = 0;
  for (; i + kBlock <= count; i += kBlock) {
    const std::uint8_t* at = argb + static_cast<std::ptrdiff_t>(4) * i;
    auto all = hn::LoadU(bytes, at);
    for (int k = lanes; k < 4 * kBlock; k += lanes) all = hn::Or(all, hn::LoadU(bytes, at + k));
    if (!hn::AllTrue(bytes, hn::Eq(all, hn::Zero(bytes)))) return i;
  }
  const bool rest = std::all_of(argb + static_cast<std::ptrdiff_t>(4) * i,
                                argb + static_cast<std::ptrdiff_t>(4) * count,
                                [](std::uint8_t byte) { return byte == 0; });
  return rest ? count : i;
}

// Half of a vector where every other element is left out: both read 16 pixels.
template <int kRows, int kShift>
void interleave_rows(const InterleavedRows& rows, int samples, std::uint8_t* to) {
  const hn::CappedTag<std::uint8_t, (16 >> kShift)> bytes;
  using Vec = hn::VFromD<decltype(bytes)>;
  const auto lanes = static_cast<int>(hn::Lanes(bytes));
  int i = 0;
  for (; i + lanes <= samples; i += lanes) {
    const auto load = [&](std::size_t row) {
      if constexpr (kShift == 0) {
        return hn::LoadU(bytes, rows.from[row] + i);
      } else {
        Vec even;
        Vec odd;
        hn::LoadInterleaved2(bytes, rows.from[row] + static_cast<std::ptrdiff_t>(2) * i, even, odd);
        return even;
      }
    };
    std::uint8_t* at = to + static_cast<std::ptrdiff_t>(kRows) * i;
    if constexpr (kRows == 1) hn::StoreU(load(0), bytes, at);
    if constexpr (kRows == 2) hn::StoreInterleaved2(load(0), load(1), bytes, at);
    if constexpr (kRows == 3) hn::StoreInterleaved3(load(0), load(1), load(2), bytes, at);
    if constexpr (kRows == 4) hn::StoreInterleaved4(load(0), load(1), load(2), load(3), bytes, at);
  }
  for (; i < samples; ++i) {
    for (std::size_t row = 0; row < kRows; ++row) {
      to[static_cast<std::size_t>(kRows * i) + row] =
          rows.from[row][static_cast<std::ptrdiff_t>(i) << kShift];
    }
  }
}

template <int kShift>
void interleave_each(const InterleavedRows& rows, int samples, std::uint8_t* to) {
  switch (rows.count) {
    case 1:
      return interleave_rows<1, kShift>(rows, samples, to);
    case 2:
      return interleave_rows<2, kShift>(rows, samples, to);
    case 3:
      return interleave_rows<3, kShift>(rows, samples, to);
    default:
      return interleave_rows<4, kShift>(rows, samples, to);
  }
}

void interleave(const InterleavedRows& rows, int samples, std::uint8_t* to) {
  if (rows.shift == 0) return interleave_each<0>(rows, samples, to);
  interleave_each<1>(rows, samples, to);
}

}  // namespace calvin::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace calvin {

namespace {

HWY_EXPORT(blend_stamp);
HWY_EXPORT(blank_pixels);
HWY_EXPORT(interleave);
HWY_EXPORT(split_pixels);

}  // namespace

void blend_stamp(const TileStamp& stamp, const FramePlanes& frame) noexcept {
  HWY_DYNAMIC_DISPATCH(blend_stamp)(stamp, frame);
}

int blank_pixels(const std::uint8_t* argb, int count) noexcept {
  return HWY_DYNAMIC_DISPATCH(blank_pixels)(argb, count);
}

void interleave(const InterleavedRows& rows, int samples, std::uint8_t* to) noexcept {
  HWY_DYNAMIC_DISPATCH(interleave)(rows, samples, to);
}

void split_pixels(const std::uint8_t* argb, int count, Split split,
                  const ComponentRows& to) noexcept {
  HWY_DYNAMIC_DISPATCH(split_pixels)(argb, count, split, to);
}

}  // namespace calvin

#endif  // HWY_ONCE
