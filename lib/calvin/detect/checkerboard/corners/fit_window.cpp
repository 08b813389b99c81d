// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Copies the pixels near the edges of a corner into flat arrays, a vector at a time.

#include "calvin/core/vector_targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "calvin/detect/checkerboard/corners/fit_window.cpp"
#include <hwy/foreach_target.h>
// The order matters: Highway includes this file again for each target from the line above.
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <hwy/cache_control.h>

#include "calvin/detect/checkerboard/corners/fit_window.hpp"

#ifndef CALVIN_DETECT_FIT_WINDOW_RANGE
#define CALVIN_DETECT_FIT_WINDOW_RANGE
namespace calvin::detect {

// An interval of whole numbers; empty where first > last.
struct Range {
  int first = 0;
  int last = -1;
};

// The columns of a window within so many px of a line through its middle, row by row.
class NearLine {
 public:
  NearLine(Direction along, float limit) : rise_(along.x), limit_(limit) {
    constexpr float kFlat = 1e-3F;
    is_flat_ = std::abs(along.y) < kFlat;
    if (is_flat_) return;
    step_ = along.x / along.y;
    half_ = limit / std::abs(along.y);
  }
  // Those of the row `y` px below the middle, which lie within `bounds`; an empty range begins
  // there, too. The row as far above gives the range turned by 180 degrees.
  [[nodiscard]] Range columns(float y, Range bounds) const {
    if (is_flat_) return std::abs(rise_ * y) <= limit_ ? bounds : Range{};
    const float middle = step_ * y;
    const auto first = static_cast<int>(std::ceil(std::clamp(middle - half_, -1e4F, 1e4F)));
    const auto last = static_cast<int>(std::floor(std::clamp(middle + half_, -1e4F, 1e4F)));
    return {std::clamp(first, bounds.first, bounds.last + 1), std::min(bounds.last, last)};
  }

 private:
  float rise_;
  float limit_;
  bool is_flat_ = false;
  float step_ = 0;  // columns, from a row to the next
  float half_ = 0;  // columns
};

}  // namespace calvin::detect
#endif

HWY_BEFORE_NAMESPACE();
namespace calvin::detect::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Puts a vector of pixels of a row, from column `dx` on, into a window from its pixel `at` on.
HWY_INLINE void put_vector(const std::uint8_t* row, int dx, float y, int at, Window& window) {
  const hn::ScalableTag<float> d;
  const hn::RebindToSigned<decltype(d)> integers;
  const hn::Rebind<std::uint8_t, decltype(d)> bytes;
  const auto grey = hn::ConvertTo(d, hn::PromoteTo(integers, hn::LoadU(bytes, row + dx)));
  hn::StoreU(hn::Iota(d, static_cast<float>(dx)), d, window.x + at);
  hn::StoreU(hn::Set(d, y), d, window.y + at);
  hn::StoreU(grey, d, window.grey + at);
}

inline int lanes_of_window() { return static_cast<int>(hn::Lanes(hn::ScalableTag<float>())); }

// append() where a vector may be read at the beginning of the range, even of an empty one, and
// beyond its end. Nearly all ranges are of one vector, which costs no branch that may be foreseen
// wrongly.
HWY_INLINE void append_inside(const std::uint8_t* row, Range range, float y, Window& window) {
  int dx = range.first;
  do {
    put_vector(row, dx, y, window.count + dx - range.first, window);
    dx += lanes_of_window();
  } while (dx <= range.last);
  window.count += std::max(range.last - range.first + 1, 0);
}

// Appends some pixels of a row to a window. `row` points to the window's middle column, the image
// ends before column `end`.
void append(const std::uint8_t* row, Range range, int end, float y, Window& window) {
  const int lanes = lanes_of_window();
  int dx = range.first;
  // Lanes of the last vector beyond the range are overwritten by the next row.
  for (; dx <= range.last && dx + lanes <= end; dx += lanes) {
    put_vector(row, dx, y, window.count + dx - range.first, window);
  }
  for (; dx <= range.last; ++dx) {
    const int at = window.count + dx - range.first;
    window.x[at] = static_cast<float>(dx);
    window.y[at] = y;
    window.grey[at] = row[dx];
  }
  window.count += std::max(range.last - range.first + 1, 0);
}

void append_row(const std::uint8_t* row, int first, int last, int end, float y, Window& window) {
  append(row, {first, last}, end, y, window);
}

void gather(const ImageView& image, int x, int y, float radius, float band, Direction along,
            Direction down, Window& window) {
  const float limit = (radius + kRim) * (radius + kRim);
  const int reach = static_cast<int>(radius + kRim);
  window.count = 0;
  window.whole = x >= reach && y >= reach && x + reach < image.width && y + reach < image.height;
  const NearLine near_along(along, band);
  const NearLine near_down(down, band);
  const bool is_inside = window.whole && x + reach + 1 + lanes_of_window() <= image.width;
  const int top = std::max(-reach, -y);
  const int bottom = std::min(reach, image.height - 1 - y);
  // A frame of a video is not in the cache, and the processor foresees no rows that are far apart.
  for (int dy = top; dy <= bottom; ++dy) {
    const std::uint8_t* row = image.data + (y + dy) * image.stride + x;
    hwy::Prefetch(row - std::min(reach, x));
    hwy::Prefetch(row + std::min(reach, image.width - 1 - x));
  }
  for (int dy = top; dy <= bottom; ++dy) {
    const auto v = static_cast<float>(dy);
    const int half = static_cast<int>(std::sqrt(limit - v * v));
    const std::uint8_t* row = image.data + (y + dy) * image.stride + x;
    const Range disc = {std::max(-half, -x), std::min(half, image.width - 1 - x)};
    Range a = near_along.columns(v, disc);
    Range b = near_down.columns(v, disc);
    if (b.first < a.first) std::swap(a, b);
    if (a.first > a.last) std::swap(a, b);
    // The second range without the pixels of the first.
    b.first = std::max(b.first, a.last + 1);
    if (is_inside) {
      append_inside(row, a, v, window);
      append_inside(row, b, v, window);
    } else {
      append(row, a, image.width - x, v, window);
      append(row, b, image.width - x, v, window);
    }
  }
  // The last vectors read beyond the pixels and multiply by 0 there, so these must be numbers.
  std::fill_n(window.x + window.count, kBeyond, 0.0F);
  std::fill_n(window.y + window.count, kBeyond, 0.0F);
  std::fill_n(window.grey + window.count, kBeyond, 0.0F);
}

SquareMeans square_means(const Window& window, Direction along, Direction down, float x, float y) {
  const hn::ScalableTag<float> d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  const auto along_x = hn::Set(d, along.x), along_y = hn::Set(d, along.y);
  const auto down_x = hn::Set(d, down.x), down_y = hn::Set(d, down.y);
  auto all = hn::Zero(d);
  auto between = hn::Zero(d);
  auto count = hn::Zero(d);
  // Beyond the window the grey level is 0.
  for (int i = 0; i < window.count; i += lanes) {
    const auto dx = hn::Sub(hn::LoadU(d, window.x + i), hn::Set(d, x));
    const auto dy = hn::Sub(hn::LoadU(d, window.y + i), hn::Set(d, y));
    const auto a = hn::Sub(hn::Mul(along_x, dy), hn::Mul(along_y, dx));
    const auto b = hn::Sub(hn::Mul(down_y, dx), hn::Mul(down_x, dy));
    const auto inside = hn::FirstN(d, static_cast<std::size_t>(window.count - i));
    const auto is_between = hn::And(inside, hn::Gt(hn::Mul(a, b), hn::Zero(d)));
    const auto grey = hn::LoadU(d, window.grey + i);
    all = hn::Add(all, grey);
    between = hn::Add(between, hn::IfThenElseZero(is_between, grey));
    count = hn::Add(count, hn::IfThenElseZero(is_between, hn::Set(d, 1)));
  }
  const auto sum = [d](auto v) { return hn::GetLane(hn::SumOfLanes(d, v)); };
  const float in = sum(count);
  const float out = static_cast<float>(window.count) - in;
  return {sum(between) / std::max(in, 1.0F), sum(hn::Sub(all, between)) / std::max(out, 1.0F)};
}

float odd_square(const Window& window) {
  const hn::ScalableTag<float> d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  const int half = window.count / 2;
  auto sum = hn::Zero(d);
  int i = 0;
  for (; i + lanes <= half; i += lanes) {
    const auto opposite = hn::Reverse(d, hn::LoadU(d, window.error + window.count - i - lanes));
    const auto odd = hn::Sub(hn::LoadU(d, window.error + i), opposite);
    sum = hn::MulAdd(odd, odd, sum);
  }
  float rest = 0;
  for (; i < half; ++i) {
    const float odd = window.error[i] - window.error[window.count - 1 - i];
    rest += odd * odd;
  }
  return hn::GetLane(hn::SumOfLanes(d, sum)) + rest;
}

}  // namespace calvin::detect::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace calvin::detect {

namespace {

HWY_EXPORT(gather);
HWY_EXPORT(append_row);
HWY_EXPORT(square_means);
HWY_EXPORT(odd_square);

// How many pixels of a disc of `radius` lie within `band` of one of two lines, at the most.
float most_pixels(float radius, float band) {
  return std::min(3.2F * (radius + 1) * (radius + 1), 8 * (radius + 1) * (band + 1));
}

}  // namespace

float gather(const ImageView& image, int x, int y, float radius, float band, Direction along,
             Direction down, Window& window) noexcept {
  while (most_pixels(radius + kRim, band) > kMostPixels) radius *= 0.9F;
  HWY_DYNAMIC_DISPATCH(gather)(image, x, y, radius, band, along, down, window);
  return radius;
}

void append_row(const std::uint8_t* row, int first, int last, int end, float y,
                Window& window) noexcept {
  HWY_DYNAMIC_DISPATCH(append_row)(row, first, last, end, y, window);
}

SquareMeans square_means(const Window& window, Direction along, Direction down, float x,
                         float y) noexcept {
  return HWY_DYNAMIC_DISPATCH(square_means)(window, along, down, x, y);
}

float odd_square(const Window& window) noexcept { return HWY_DYNAMIC_DISPATCH(odd_square)(window); }

}  // namespace calvin::detect

#endif  // HWY_ONCE
