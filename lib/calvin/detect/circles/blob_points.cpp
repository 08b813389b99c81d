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

// The first number from `from` on that is at least `threshold`; `count` where there is none.
std::size_t next_above(const std::uint8_t* row, std::size_t from, std::size_t count,
                       std::uint8_t threshold) {
  const hn::ScalableTag<std::uint8_t> d;
  const std::size_t lanes = hn::Lanes(d);
  const auto least = hn::Set(d, threshold);
  std::size_t i = from;
  for (; i + lanes <= count; i += lanes) {
    const auto v = hn::LoadU(d, row + i);
    const std::ptrdiff_t at = hn::FindFirstTrue(d, hn::Eq(hn::Max(v, least), v));
    if (at >= 0) return i + static_cast<std::size_t>(at);
  }
  while (i < count && row[i] < threshold) ++i;
  return i;
}

}  // namespace calvin::detect::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include <algorithm>

namespace calvin::detect {

namespace {

HWY_EXPORT(blob_row);
HWY_EXPORT(next_above);

// Whether the response at a place is no less than what is around it; of equal ones the first.
bool is_peak(const std::uint8_t* at, std::ptrdiff_t width) {
  for (std::ptrdiff_t dy = -2; dy <= 2; ++dy) {
    for (std::ptrdiff_t dx = -2; dx <= 2; ++dx) {
      const std::uint8_t other = at[dy * width + dx];
      const bool earlier = dy < 0 || (dy == 0 && dx < 0);
      if (other > *at || (other == *at && earlier)) return false;
    }
  }
  return true;
}

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
  for (int y = kBlobReach; y < image.height - kBlobReach; ++y) {
    const std::uint8_t* row = response_.data() + static_cast<std::size_t>(y) * width;
    for (std::size_t x = kBlobReach;; ++x) {
      x = HWY_DYNAMIC_DISPATCH(next_above)(row, x, width - kBlobReach, threshold);
      if (x >= width - kBlobReach) break;
      if (is_peak(row + x, image.width)) points_.push_back({static_cast<int>(x), y, row[x]});
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
