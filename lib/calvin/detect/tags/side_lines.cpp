// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Copies lines of pixels into flat arrays, a vector at a time.

#include "calvin/core/vector_targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "calvin/detect/tags/side_lines.cpp"
#include <hwy/foreach_target.h>
// The order matters: Highway includes this file again for each target from the line above.
#include <hwy/highway.h>
// Included once for each target, too.
#include "calvin/detect/lane_sums-inl.hpp"

#include <algorithm>

#include "calvin/detect/tags/side_lines.hpp"

HWY_BEFORE_NAMESPACE();
namespace calvin::detect::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Numbers behind the last pixel of a line are overwritten by the next line.
void copy_lines(const SideLines& lines, SidePixels& pixels) {
  const hn::ScalableTag<float> d;
  const hn::RebindToSigned<decltype(d)> di;
  const hn::Rebind<std::uint8_t, decltype(d)> bytes;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  const auto by_t = hn::Set(d, lines.by_t);
  const auto by_n = hn::Set(d, lines.by_n);
  float* t = pixels.t.data();
  float* n = pixels.n.data();
  float* grey = pixels.grey.data();
  for (const SideLine& line : lines.all) {
    for (int k = 0; k < line.count; k += lanes) {
      const auto steps = hn::Iota(d, static_cast<float>(k));
      hn::StoreU(hn::MulAdd(steps, by_t, hn::Set(d, line.t)), d, t + k);
      hn::StoreU(hn::MulAdd(steps, by_n, hn::Set(d, line.n)), d, n + k);
      if (lines.step == 1 && k + lanes <= line.room) {
        const auto levels = hn::PromoteTo(di, hn::LoadU(bytes, line.grey + k));
        hn::StoreU(hn::ConvertTo(d, levels), d, grey + k);
        continue;
      }
      for (int i = k; i < std::min(k + lanes, line.count); ++i) {
        grey[i] = line.grey[i * lines.step];
      }
    }
    t += line.count;
    n += line.count;
    grey += line.count;
  }
}

// Two samples on both sides of each place, and a line between them.
template <class D, class I, class V>
HWY_INLINE V row_at(D d, const SideBits::Row& row, I sample, V share) {
  const V before = hn::GatherIndex(d, row.data(), sample);
  const V after = hn::GatherIndex(d, row.data() + 1, sample);
  return hn::MulAdd(share, hn::Sub(after, before), before);
}

void add_bits(const SideBits& bits, SidePixels& pixels) {
  const hn::ScalableTag<float> d;
  const hn::RebindToSigned<decltype(d)> di;
  constexpr float kPerUnit = (SideBits::kSamples - 1) / 2.0F;  // samples, of t
  const auto per_segment = hn::Set(d, kSideSegments / (SideBits::kSamples - 1.0F));
  const auto one = hn::Set(d, 1);
  for (int i = 0; i < pixels.count; i += static_cast<int>(hn::Lanes(d))) {
    // Behind the last pixel t may be anything: the place is still one of the row.
    const auto t = hn::Min(hn::Max(hn::LoadU(d, pixels.t.data() + i), hn::Neg(one)), one);
    const auto place = hn::Mul(hn::Add(t, one), hn::Set(d, kPerUnit));
    const auto sample = hn::ConvertTo(di, place);
    const auto share = hn::Sub(place, hn::ConvertTo(d, sample));
    if (bits.rows > 0) {
      hn::StoreU(row_at(d, bits.first, sample, share), d, pixels.first.data() + i);
    }
    if (bits.rows > 1) {
      hn::StoreU(row_at(d, bits.second, sample, share), d, pixels.second.data() + i);
    }
    if (bits.behind_gap == BehindGap::kBits) {
      hn::StoreU(row_at(d, bits.beyond, sample, share), d, pixels.beyond.data() + i);
    } else if (bits.behind_gap == BehindGap::kTag) {
      hn::StoreU(one, d, pixels.beyond.data() + i);
    }
    const auto segment = hn::ConvertTo(di, hn::Mul(place, per_segment));
    hn::StoreU(hn::Min(segment, hn::Set(di, kSideSegments - 1)), di, pixels.segment.data() + i);
  }
}

void take_lines(const SideLines& lines, const SideBits& bits, SidePixels& pixels) {
  copy_lines(lines, pixels);
  add_bits(bits, pixels);
}

void sum_segments(const SidePixels& pixels, SegmentSums& sums) {
  const hn::ScalableTag<float> d;
  const hn::RebindToSigned<decltype(d)> di;
  using V = hn::Vec<decltype(d)>;
  V squares[kSideSegments];
  V counts[kSideSegments];
  for (int k = 0; k < kSideSegments; ++k) squares[k] = counts[k] = hn::Zero(d);
  for (int i = 0; i < pixels.count; i += static_cast<int>(hn::Lanes(d))) {
    const auto inside = hn::FirstN(d, static_cast<std::size_t>(pixels.count - i));
    const V error = hn::LoadU(d, pixels.error.data() + i);
    const V square = hn::IfThenElseZero(inside, hn::Mul(error, error));
    const V one = hn::IfThenElseZero(inside, hn::Set(d, 1));
    const auto segment = hn::LoadU(di, pixels.segment.data() + i);
    for (int k = 0; k < kSideSegments; ++k) {
      const auto is_in = hn::RebindMask(d, hn::Eq(segment, hn::Set(di, k)));
      squares[k] = hn::Add(squares[k], hn::IfThenElseZero(is_in, square));
      counts[k] = hn::Add(counts[k], hn::IfThenElseZero(is_in, one));
    }
  }
  sums_of_lanes(d, squares, kSideSegments, sums.square.data());
  sums_of_lanes(d, counts, kSideSegments, sums.count.data());
}

}  // namespace calvin::detect::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace calvin::detect {

namespace {

HWY_EXPORT(take_lines);
HWY_EXPORT(sum_segments);

constexpr std::size_t kBeyond = 2 * 64;  // two of the longest vectors

}  // namespace

void SidePixels::resize(int pixels) {
  count = pixels;
  const auto used = static_cast<std::ptrdiff_t>(pixels);
  const std::size_t needed = static_cast<std::size_t>(pixels) + kBeyond;
  if (t.size() < needed) {
    for (auto* numbers : {&t, &n, &grey, &first, &second, &beyond, &weight, &error}) {
      numbers->resize(2 * needed, 0);
    }
    segment.resize(2 * needed, 0);
  }
  std::fill(weight.begin(), weight.begin() + used, 1.0F);
  std::fill_n(weight.begin() + used, kBeyond, 0.0F);
}

void take_lines(const SideLines& lines, const SideBits& bits, SidePixels& pixels) {
  int count = 0;
  for (const SideLine& line : lines.all) count += line.count;
  pixels.resize(count);
  pixels.rows = bits.rows;
  pixels.has_beyond = bits.behind_gap != BehindGap::kNothing;
  HWY_DYNAMIC_DISPATCH(take_lines)(lines, bits, pixels);
}

SegmentSums sums_of_segments(const SidePixels& pixels) noexcept {
  SegmentSums sums;
  HWY_DYNAMIC_DISPATCH(sum_segments)(pixels, sums);
  return sums;
}

}  // namespace calvin::detect

#endif  // HWY_ONCE
