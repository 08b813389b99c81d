// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The corner response of all pixels and its peaks, a vector at a time.

#include "calvin/core/vector_targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "calvin/detect/checkerboard/corners/saddle_points.cpp"
#include <hwy/foreach_target.h>
// The order matters: Highway includes this file again for each target from the line above.
#include <hwy/highway.h>

#include <bit>
#include <cstring>

#include "calvin/detect/checkerboard/corners/saddle_points.hpp"

#ifndef CALVIN_DETECT_SADDLE_POINTS_RING
#define CALVIN_DETECT_SADDLE_POINTS_RING
namespace calvin::detect {
// The samples of both rings, about a sixteenth of a turn apart. Opposite ones are 8 apart.
inline constexpr int kRingX[2][16] = {{3, 3, 2, 1, 0, -1, -2, -3, -3, -3, -2, -1, 0, 1, 2, 3},
                                      {5, 5, 4, 2, 0, -2, -4, -5, -5, -5, -4, -2, 0, 2, 4, 5}};
inline constexpr int kRingY[2][16] = {{0, 1, 2, 3, 3, 3, 2, 1, 0, -1, -2, -3, -3, -3, -2, -1},
                                      {0, 2, 4, 5, 5, 5, 4, 2, 0, -2, -4, -5, -5, -5, -4, -2}};
}  // namespace calvin::detect
#endif

HWY_BEFORE_NAMESPACE();
namespace calvin::detect::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <class V>
HWY_INLINE V difference(V a, V b) {
  return hn::Sub(hn::Max(a, b), hn::Min(a, b));
}

// The response at lanes `at`, at + 1, ... All sums are kept as means, in bytes. `kRing` as in
// kRingX.
template <int kRing, class D>
HWY_INLINE hn::Vec<D> response_at(D d, const std::uint8_t* at, std::ptrdiff_t stride) {
  const auto load = [&](int k) {
    return hn::LoadU(d, at + kRingY[kRing][k] * stride + kRingX[kRing][k]);
  };
  const auto mean = [](auto a, auto b) { return hn::AverageRound(a, b); };
  hn::Vec<D> sums[2], differences[2], rings[2];
  for (int half = 0; half < 2; ++half) {
    hn::Vec<D> s[2], f[2], r[2];
    for (int i = 0; i < 2; ++i) {
      const int k = 2 * half + i;
      const auto a = load(k);
      const auto b = load(k + 4);
      const auto c = load(k + 8);
      const auto e = load(k + 12);
      const auto ac = mean(a, c);
      const auto be = mean(b, e);
      s[i] = difference(ac, be);
      f[i] = mean(difference(a, c), difference(b, e));
      r[i] = mean(ac, be);
    }
    sums[half] = mean(s[0], s[1]);
    differences[half] = mean(f[0], f[1]);
    rings[half] = mean(r[0], r[1]);
  }
  const auto sum = mean(sums[0], sums[1]);
  const auto difference_mean = mean(differences[0], differences[1]);
  const auto ring = mean(rings[0], rings[1]);
  const auto cross = mean(mean(hn::LoadU(d, at - 1), hn::LoadU(d, at + 1)),
                          mean(hn::LoadU(d, at - stride), hn::LoadU(d, at + stride)));
  const auto off = difference(ring, mean(cross, hn::LoadU(d, at)));
  return hn::SaturatedSub(hn::SaturatedSub(sum, difference_mean), off);
}

template <int kRing>
void response_row_of(const std::uint8_t* at, std::ptrdiff_t stride, std::uint8_t* out,
                     std::size_t count) {
  const hn::ScalableTag<std::uint8_t> d;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes)
    hn::StoreU(response_at<kRing>(d, at + i, stride), d, out + i);
  if (i == count) return;
  if (count >= lanes) {
    i = count - lanes;
    hn::StoreU(response_at<kRing>(d, at + i, stride), d, out + i);
    return;
  }
  const hn::CappedTag<std::uint8_t, 1> one;
  for (; i < count; ++i) hn::StoreU(response_at<kRing>(one, at + i, stride), one, out + i);
}

void response_row(const std::uint8_t* at, std::ptrdiff_t stride, RingSize ring, std::uint8_t* out,
                  std::size_t count) {
  (ring == RingSize::kSmall ? response_row_of<0> : response_row_of<1>)(at, stride, out, count);
}

// The responses of a patch whose pixels from (x, y) on are far enough from the border of the image.
template <int kRing>
void response_patch_of(const ImageView& image, int x, int y, int width, int height,
                       std::uint8_t* out) {
  const hn::CappedTag<std::uint8_t, kPatchWidth> d;
  const hn::CappedTag<std::uint8_t, 1> one;
  for (int row = 0; row < height; ++row, out += kPatchWidth) {
    const std::uint8_t* at = image.data + (y + row) * image.stride + x;
    if (width == static_cast<int>(hn::Lanes(d))) {
      hn::StoreU(response_at<kRing>(d, at, image.stride), d, out);
      continue;
    }
    for (int i = 0; i < width; ++i) {
      hn::StoreU(response_at<kRing>(one, at + i, image.stride), one, out + i);
    }
  }
}

void response_patch(const ImageView& image, int x, int y, int width, int height, RingSize ring,
                    std::uint8_t* out) {
  (ring == RingSize::kSmall ? response_patch_of<0> : response_patch_of<1>)(image, x, y, width,
                                                                           height, out);
}

// Sets a bit for each pixel of the middle row that is at least `threshold` and no less than its
// neighbours; of equal ones the first. `count` is a multiple of the lanes.
bool mark_peaks(const std::uint8_t* above, const std::uint8_t* row, const std::uint8_t* below,
                std::uint8_t threshold, std::uint8_t* bits, std::size_t count) {
  const hn::ScalableTag<std::uint8_t> d;
  const std::size_t lanes = hn::Lanes(d);
  const auto least = hn::Set(d, threshold);
  bool any = false;
  for (std::size_t i = 0; i < count; i += lanes) {
    const auto v = hn::LoadU(d, row + i);
    auto mask = hn::Eq(hn::Max(v, least), v);
    if (!hn::AllFalse(d, mask)) {
      const auto at = [&](const std::uint8_t* r, int dx) {
        return hn::LoadU(d, r + static_cast<std::ptrdiff_t>(i) + dx);
      };
      const auto earlier =
          hn::Max(hn::Max(at(above, -1), at(above, 0)), hn::Max(at(above, 1), at(row, -1)));
      const auto later =
          hn::Max(hn::Max(at(below, -1), at(below, 0)), hn::Max(at(below, 1), at(row, 1)));
      mask = hn::And(mask, hn::Eq(hn::Max(v, later), v));
      mask = hn::And(mask, hn::Not(hn::Eq(hn::Max(v, earlier), earlier)));
      any = any || !hn::AllFalse(d, mask);
    }
#if HWY_TARGET == HWY_SCALAR
    const unsigned bit = 1U << (i % 8);
    bits[i / 8] =
        static_cast<std::uint8_t>((bits[i / 8] & ~bit) | (hn::AllFalse(d, mask) ? 0U : bit));
#else
    hn::StoreMaskBits(d, mask, bits + i / 8);
#endif
  }
  return any;
}

// Whether the pixel `x` of the middle one of `count` rows is greater than those within 3 px before
// it and no less than those behind it, in its own row and in the others.
HWY_INLINE bool is_peak(const std::uint8_t* const* rows, int count, std::ptrdiff_t x) {
  constexpr std::ptrdiff_t kReach = 3;
  const int middle = count / 2;
  const std::uint8_t v = rows[middle][x];
#if HWY_TARGET == HWY_SCALAR
  for (int row = 0; row < count; ++row) {
    for (std::ptrdiff_t dx = -kReach; dx <= kReach; ++dx) {
      const bool earlier = row < middle || (row == middle && dx < 0);
      const std::uint8_t other = rows[row][x + dx];
      if (other > v || (other == v && earlier)) return false;
    }
  }
  return true;
#else
  const hn::CappedTag<std::uint8_t, 16> d;
  const auto load = [&](int row) { return hn::LoadU(d, rows[row] + x - kReach); };
  const auto before = hn::FirstN(d, kReach);
  auto earlier = hn::IfThenElseZero(before, load(middle));
  auto later = hn::IfThenZeroElse(before, load(middle));
  for (int row = 0; row < middle; ++row) {
    earlier = hn::Max(earlier, load(row));
    later = hn::Max(later, load(count - 1 - row));
  }
  const auto value = hn::Set(d, v);
  const auto good =
      hn::AndNot(hn::Eq(hn::Max(earlier, value), earlier), hn::Eq(hn::Max(later, value), value));
  return hn::AllTrue(d, hn::Or(good, hn::Not(hn::FirstN(d, 2 * kReach + 1))));
#endif
}

// Clears the bits of pixels that are no peaks among `count` rows.
void keep_peaks(const std::uint8_t* const* rows, int count, std::uint8_t* bits, std::size_t width) {
  for (std::size_t first = 0; first < width; first += 64) {
    std::uint64_t marked = 0;
    std::memcpy(&marked, bits + first / 8, sizeof marked);
    if (marked == 0) continue;
    // The bytes were stored lowest pixel first.
    std::uint64_t kept = 0;
    for (std::uint64_t rest = marked; rest != 0; rest &= rest - 1) {
      const int bit = std::countr_zero(rest);
      if (is_peak(rows, count, static_cast<std::ptrdiff_t>(first) + bit)) {
        kept |= std::uint64_t{1} << bit;
      }
    }
    std::memcpy(bits + first / 8, &kept, sizeof kept);
  }
}

}  // namespace calvin::detect::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include <algorithm>

namespace calvin::detect {

namespace {

HWY_EXPORT(response_row);
HWY_EXPORT(response_patch);
HWY_EXPORT(mark_peaks);
HWY_EXPORT(keep_peaks);

// Every other row is looked at: the response of a corner is some five px wide, so that none is
// missed; climb() corrects the place.
constexpr int kRowStep = 2;
constexpr int kPeakRows = 1;           // rows looked at on either side of a peak
constexpr std::size_t kPadding = 128;  // bytes on either side of a row, at least a vector
constexpr std::size_t kMaxPoints = 2;  // times those wanted, before the threshold goes up
constexpr int kRingRows = 4;           // at least 2 * kPeakRows + 1, a power of two

// Moves a point to the greatest response next to it.
void climb(const ImageView& image, RingSize ring, SaddlePoint& p) {
  ResponsePatch patch;
  saddle_responses(image, p.x - 1, p.y - 1, 3, ring, patch);
  const SaddlePoint from = p;
  for (int dy = 0; dy < 3; ++dy) {
    for (int dx = 0; dx < 3; ++dx) {
      const std::uint8_t r = patch.at[dy][dx];
      if (r > p.response) p = {from.x - 1 + dx, from.y - 1 + dy, r};
    }
  }
}

}  // namespace

void saddle_responses(const ImageView& image, int x, int y, int height, RingSize ring,
                      ResponsePatch& patch) noexcept {
  // A patch may reach over the border of the image, but vectors must not.
  const int left = std::max(x, kResponseRadius);
  const int right = std::min(x + kPatchWidth, image.width - kResponseRadius);
  const int top = std::max(y, kResponseRadius);
  const int bottom = std::min(y + height, image.height - kResponseRadius);
  const int width = right - left;
  if (width < kPatchWidth || bottom - top < height) std::memset(patch.at, 0, sizeof patch.at);
  if (width <= 0 || bottom <= top) return;
  HWY_DYNAMIC_DISPATCH(response_patch)
  (image, left, top, width, bottom - top, ring, patch.at[top - y] + left - x);
}

// Keeps the strongest half of the points: weaker ones cannot be among those wanted.
void SaddleSearch::raise_threshold() {
  std::size_t counts[256] = {};
  for (const SaddlePoint& p : points_) ++counts[p.response];
  std::size_t kept = points_.size();
  int level = threshold_;
  while (level < 255 && kept - counts[level] >= most_ / kMaxPoints) kept -= counts[level++];
  threshold_ = static_cast<std::uint8_t>(level);
  std::erase_if(points_, [&](const SaddlePoint& p) { return p.response < threshold_; });
  // Where too many are equal, one is as good as the other.
  if (points_.size() > most_ - most_ / 4) points_.resize(most_ - most_ / 4);
}

void SaddleSearch::take_peaks(const std::uint8_t* row, int y, int width) {
  for (int first = 0; first < width; first += 64) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, peaks_.data() + first / 8, sizeof bits);
    for (; bits != 0; bits &= bits - 1) {
      const int x = first + std::countr_zero(bits);
      if (points_.size() >= most_) raise_threshold();
      if (row[x] >= threshold_) points_.push_back({x, y, row[x]});
    }
  }
}

std::span<const SaddlePoint> SaddleSearch::find(const ImageView& image, RingSize ring,
                                                std::uint8_t threshold, std::size_t most) {
  points_.clear();
  most_ = kMaxPoints * most;
  points_.reserve(most_);
  threshold_ = std::max<std::uint8_t>(threshold, 1);
  const int inner = image.width - 2 * kResponseRadius;  // of a row, px that have a response
  if (inner <= 0 || image.height <= 2 * kResponseRadius) return {};

  const std::size_t bits = (static_cast<std::size_t>(image.width) + 127) / 128 * 128;
  const std::size_t pitch = bits + 2 * kPadding;
  responses_.assign(kRingRows * pitch, 0);
  peaks_.assign(bits / 8, 0);
  const auto ring_row = [&](int k) {
    return responses_.data() + static_cast<std::size_t>(k & (kRingRows - 1)) * pitch + kPadding;
  };
  const auto row_at = [](int k) { return kResponseRadius + k * kRowStep; };
  const int end = (image.height - 2 * kResponseRadius + kRowStep - 1) / kRowStep;
  for (int k = 0; k < end + kPeakRows; ++k) {
    std::uint8_t* const newest = ring_row(k);
    if (k < end) {
      HWY_DYNAMIC_DISPATCH(response_row)
      (image.data + row_at(k) * image.stride + kResponseRadius, image.stride, ring,
       newest + kResponseRadius, static_cast<std::size_t>(inner));
    } else {
      std::memset(newest, 0, bits);
    }
    const int middle = k - kPeakRows;
    if (middle < 0) continue;
    const std::uint8_t* rows[2 * kPeakRows + 1];
    for (int i = 0; i <= 2 * kPeakRows; ++i) rows[i] = ring_row(middle - kPeakRows + i);
    if (HWY_DYNAMIC_DISPATCH(mark_peaks)(rows[kPeakRows - 1], rows[kPeakRows], rows[kPeakRows + 1],
                                         threshold_, peaks_.data(), bits)) {
      HWY_DYNAMIC_DISPATCH(keep_peaks)(rows, 2 * kPeakRows + 1, peaks_.data(), bits);
      take_peaks(rows[kPeakRows], row_at(middle), image.width);
    }
  }
  if (points_.size() > most) {
    std::nth_element(
        points_.begin(), points_.begin() + static_cast<std::ptrdiff_t>(most), points_.end(),
        [](const SaddlePoint& a, const SaddlePoint& b) { return a.response > b.response; });
    points_.resize(most);
  }
  for (SaddlePoint& p : points_) climb(image, ring, p);
  return points_;
}

}  // namespace calvin::detect

#endif  // HWY_ONCE
