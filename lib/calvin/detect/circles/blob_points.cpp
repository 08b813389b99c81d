// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The blob response of all pixels, a vector at a time, and its peaks.

#include "calvin/core/vector_targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "calvin/detect/circles/blob_points.cpp"
#include <hwy/foreach_target.h>
// The order matters: Highway includes this file again for each target from the line above.
#include <hwy/highway.h>

#include <cstddef>

#include "calvin/detect/circles/blob_points.hpp"

#ifndef CALVIN_DETECT_BLOB_POINTS_RING
#define CALVIN_DETECT_BLOB_POINTS_RING
namespace calvin::detect {
inline constexpr int kBlobSamples = 8;
inline constexpr int kBlobX[2][kBlobSamples] = {{3, 2, 0, -2, -3, -2, 0, 2},
                                                {5, 4, 0, -4, -5, -4, 0, 4}};
inline constexpr int kBlobY[2][kBlobSamples] = {{0, 2, 3, 2, 0, -2, -3, -2},
                                                {0, 4, 5, 4, 0, -4, -5, -4}};
}  // namespace calvin::detect
#endif

HWY_BEFORE_NAMESPACE();
namespace calvin::detect::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <bool kLight, class D>
HWY_INLINE hn::Vec<D> blob_at(D d, const std::uint8_t* at, std::ptrdiff_t stride) {
  const auto inside = hn::LoadU(d, at);
  auto best = hn::Zero(d);
  for (int ring = 0; ring < 2; ++ring) {
    auto nearest = hn::LoadU(d, at + kBlobY[ring][0] * stride + kBlobX[ring][0]);
    for (int k = 1; k < kBlobSamples; ++k) {
      const auto v = hn::LoadU(d, at + kBlobY[ring][k] * stride + kBlobX[ring][k]);
      nearest = kLight ? hn::Max(nearest, v) : hn::Min(nearest, v);
    }
    best = hn::Max(best,
                   kLight ? hn::SaturatedSub(inside, nearest) : hn::SaturatedSub(nearest, inside));
  }
  return best;
}

template <bool kLight>
void blob_row_of(const std::uint8_t* at, std::ptrdiff_t stride, std::uint8_t* out,
                 std::size_t count) {
  const hn::ScalableTag<std::uint8_t> d;
  const hn::CappedTag<std::uint8_t, 1> one;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) hn::StoreU(blob_at<kLight>(d, at + i, stride), d, out + i);
  for (; i < count; ++i) hn::StoreU(blob_at<kLight>(one, at + i, stride), one, out + i);
}

void blob_row(const std::uint8_t* at, std::ptrdiff_t stride, bool light, std::uint8_t* out,
              std::size_t count) {
  (light ? blob_row_of<true> : blob_row_of<false>)(at, stride, out, count);
}

// Which responses are at least `threshold` and no less than what is around them; of equal ones the
// first.
template <class D>
HWY_INLINE hn::Mask<D> peaks_at(D d, const std::uint8_t* at, std::ptrdiff_t width,
                                hn::Vec<D> least) {
  const auto own = hn::LoadU(d, at);
  const auto is_strong = hn::Eq(hn::Max(own, least), own);
  if (hn::AllFalse(d, is_strong)) return is_strong;
  auto before = hn::Zero(d);
  auto after = hn::Zero(d);
  for (std::ptrdiff_t dx = -2; dx <= 2; ++dx) {
    for (std::ptrdiff_t dy = 1; dy <= 2; ++dy) {
      before = hn::Max(before, hn::LoadU(d, at - dy * width + dx));
      after = hn::Max(after, hn::LoadU(d, at + dy * width + dx));
    }
    if (dx < 0) before = hn::Max(before, hn::LoadU(d, at + dx));
    if (dx > 0) after = hn::Max(after, hn::LoadU(d, at + dx));
  }
  // More than all before it.
  const auto is_first = hn::Not(hn::Eq(hn::Max(before, own), before));
  return hn::And(is_strong, hn::And(is_first, hn::Eq(hn::Max(after, own), own)));
}

// Sets all bits at the peaks of a row, which has two rows above and below it, and none at the
// others. 0 where there is no peak.
std::size_t peaks_of_row(const std::uint8_t* row, std::ptrdiff_t width, std::uint8_t threshold,
                         std::uint8_t* is_peak, std::size_t count) {
  const hn::ScalableTag<std::uint8_t> d;
  const hn::CappedTag<std::uint8_t, 1> one;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t peaks = 0;
  std::size_t i = 0;
  const auto mark = [&](auto tag) {
    const auto found = peaks_at(tag, row + i, width, hn::Set(tag, threshold));
    hn::StoreU(hn::VecFromMask(tag, found), tag, is_peak + i);
    peaks += hn::AllFalse(tag, found) ? 0 : 1;
  };
  for (; i + lanes <= count; i += lanes) mark(d);
  for (; i < count; ++i) mark(one);
  return peaks;
}

}  // namespace calvin::detect::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include <algorithm>

namespace calvin::detect {

namespace {

HWY_EXPORT(blob_row);
HWY_EXPORT(peaks_of_row);

}  // namespace

const std::vector<BlobPoint>& BlobSearch::find(const ImageView& image, bool light,
                                               std::uint8_t threshold, std::size_t most) {
  points_.clear();
  if (image.width <= 2 * kBlobReach || image.height <= 2 * kBlobReach) return points_;
  const auto width = static_cast<std::size_t>(image.width);
  response_.assign(width * static_cast<std::size_t>(image.height), 0);
  const auto count = width - 2 * kBlobReach;
  for (int y = kBlobReach; y < image.height - kBlobReach; ++y) {
    HWY_DYNAMIC_DISPATCH(blob_row)
    (image.data + y * image.stride + kBlobReach, image.stride, light,
     response_.data() + static_cast<std::size_t>(y) * width + kBlobReach, count);
  }
  is_peak_.resize(count);
  for (int y = kBlobReach; y < image.height - kBlobReach; ++y) {
    const std::uint8_t* row = response_.data() + static_cast<std::size_t>(y) * width + kBlobReach;
    if (HWY_DYNAMIC_DISPATCH(peaks_of_row)(row, image.width, threshold, is_peak_.data(), count) ==
        0) {
      continue;
    }
    const auto end = is_peak_.end();
    for (auto at = std::find(is_peak_.begin(), end, 0xff); at != end;
         at = std::find(at + 1, end, 0xff)) {
      const auto x = at - is_peak_.begin();
      points_.push_back({static_cast<int>(x) + kBlobReach, y, row[x]});
    }
  }
  if (points_.size() > most) {
    std::ranges::nth_element(points_, points_.begin() + static_cast<std::ptrdiff_t>(most),
                             std::ranges::greater{}, &BlobPoint::response);
    points_.resize(most);
  }
  return points_;
}

}  // namespace calvin::detect

#endif  // HWY_ONCE
