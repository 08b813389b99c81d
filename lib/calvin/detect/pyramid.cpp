// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Averages of 2x2 pixels, level after level.

#include "calvin/core/vector_targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "calvin/detect/pyramid.cpp"
#include <hwy/foreach_target.h>
// The order matters: Highway includes this file again for each target from the line above.
#include <hwy/highway.h>

#include "calvin/detect/pyramid.hpp"

HWY_BEFORE_NAMESPACE();
namespace calvin::detect::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// The mean of each 2 x 2 pixels of two rows, rounded; `count` of them.
void halve_rows(const std::uint8_t* upper, const std::uint8_t* lower, std::uint8_t* out,
                std::size_t count) {
  std::size_t i = 0;
#if HWY_TARGET != HWY_SCALAR
  const hn::ScalableTag<std::uint16_t> d;
  const hn::Rebind<std::uint8_t, decltype(d)> d8;
  const hn::Repartition<std::uint8_t, decltype(d)> d_bytes;
  const hn::RebindToSigned<decltype(d)> d_signed;
  const auto low = hn::Set(d, 0xff);
  const auto pair_sum = [&](const std::uint8_t* row) {
    const auto pairs = hn::BitCast(d, hn::LoadU(d_bytes, row));
    return hn::Add(hn::And(pairs, low), hn::ShiftRight<8>(pairs));
  };
  const std::size_t lanes = hn::Lanes(d);
  for (; i + lanes <= count; i += lanes) {
    const auto sum = hn::Add(pair_sum(upper + 2 * i), pair_sum(lower + 2 * i));
    const auto mean = hn::ShiftRight<2>(hn::Add(sum, hn::Set(d, 2)));
    hn::StoreU(hn::DemoteTo(d8, hn::BitCast(d_signed, mean)), d8, out + i);
  }
#endif
  for (; i < count; ++i) {
    const int sum = upper[2 * i] + upper[2 * i + 1] + lower[2 * i] + lower[2 * i + 1];
    out[i] = static_cast<std::uint8_t>((sum + 2) / 4);
  }
}

}  // namespace calvin::detect::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include <algorithm>

#include "calvin/detect/luma.hpp"
#include "calvin/detect/smoothing.hpp"

namespace calvin::detect {

namespace {

HWY_EXPORT(halve_rows);

ImageView resized(std::vector<std::uint8_t>& pixels, int width, int height) {
  const auto size = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  if (pixels.size() < size) pixels.resize(size);
  return {pixels.data(), width, height, width, 1};
}

}  // namespace

void Pyramid::build(const ImageView& image, int most_levels, ImageSize least) {
  views_[0] = image;
  for (ImageView& calm : calm_) calm = {};
  if (image.step != 1) {
    take_luma(image, own_);
    views_[0] = own_.view();
  }
  for (count_ = 1; count_ < std::min(most_levels, kMaxLevels); ++count_) {
    const ImageView& from = views_[count_ - 1];
    const int width = from.width / 2;
    const int height = from.height / 2;
    if (width < least.width || height < least.height) break;
    ImageView& to = views_[count_] = resized(pixels_[count_], width, height);
    for (int y = 0; y < height; ++y) {
      const std::uint8_t* upper = from.data + 2 * y * from.stride;
      HWY_DYNAMIC_DISPATCH(halve_rows)
      (upper, upper + from.stride, pixels_[count_].data() + y * to.stride,
       static_cast<std::size_t>(width));
    }
  }
}

const ImageView& Pyramid::calm_level(int i) {
  constexpr float kNoisy = 2.5F;  // grey levels
  ImageView& calm = calm_[i];
  if (calm.data == nullptr) {
    calm = noise_of(level(i)) > kNoisy ? smoothed(level(i), calm_pixels_[i], sums_) : level(i);
  }
  return calm;
}

}  // namespace calvin::detect

#endif  // HWY_ONCE
