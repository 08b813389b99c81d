// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Grey levels from interleaved bytes, a vector at a time.

#include "calvin/core/vector_targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "calvin/detect/luma.cpp"
#include <hwy/foreach_target.h>
// The order matters: Highway includes this file again for each target from the line above.
#include <hwy/highway.h>

#include "calvin/detect/luma.hpp"

#ifndef CALVIN_DETECT_LUMA_WEIGHTS
#define CALVIN_DETECT_LUMA_WEIGHTS
namespace calvin {
// The weight of each byte of a pixel; their sum is 256.
struct LumaWeights {
  std::uint16_t of[4] = {0, 0, 0, 0};
};
}  // namespace calvin
#endif

HWY_BEFORE_NAMESPACE();
namespace calvin::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <int kStep>
void luma_row_of(const std::uint8_t* from, const LumaWeights& weights, std::uint8_t* to,
                 std::size_t count) {
  std::size_t i = 0;
#if HWY_TARGET != HWY_SCALAR
  const hn::ScalableTag<std::uint16_t> d;
  const hn::Rebind<std::uint8_t, decltype(d)> d8;
  const hn::RebindToSigned<decltype(d)> d_signed;
  const std::size_t lanes = hn::Lanes(d);
  const auto part = [&](auto bytes, int at) {
    return hn::Mul(hn::PromoteTo(d, bytes), hn::Set(d, weights.of[at]));
  };
  for (; i + lanes <= count; i += lanes) {
    hn::Vec<decltype(d8)> a, b, c;
    auto sum = hn::Set(d, 128);
    if constexpr (kStep == 4) {
      hn::Vec<decltype(d8)> e;
      hn::LoadInterleaved4(d8, from + kStep * i, a, b, c, e);
      sum = hn::Add(sum, part(e, 3));
    } else {
      hn::LoadInterleaved3(d8, from + kStep * i, a, b, c);
    }
    sum = hn::Add(hn::Add(sum, part(a, 0)), hn::Add(part(b, 1), part(c, 2)));
    hn::StoreU(hn::DemoteTo(d8, hn::BitCast(d_signed, hn::ShiftRight<8>(sum))), d8, to + i);
  }
#endif
  for (; i < count; ++i) {
    unsigned sum = 128;
    for (std::size_t k = 0; k < kStep; ++k) sum += weights.of[k] * from[kStep * i + k];
    to[i] = static_cast<std::uint8_t>(sum >> 8);
  }
}

void luma_row(const std::uint8_t* from, int step, const LumaWeights& weights, std::uint8_t* to,
              std::size_t count) {
  if (step == 3) {
    luma_row_of<3>(from, weights, to, count);
  } else {
    luma_row_of<4>(from, weights, to, count);
  }
}

// Every second byte.
void halves_row(const std::uint8_t* from, std::uint8_t* to, std::size_t count) {
  std::size_t i = 0;
#if HWY_TARGET != HWY_SCALAR
  const hn::ScalableTag<std::uint8_t> d;
  const std::size_t lanes = hn::Lanes(d);
  // Not the last pixels: the memory may end at the last pixel's first byte.
  for (; i + lanes < count; i += lanes) {
    hn::Vec<decltype(d)> even, odd;
    hn::LoadInterleaved2(d, from + 2 * i, even, odd);
    hn::StoreU(even, d, to + i);
  }
#endif
  for (; i < count; ++i) to[i] = from[2 * i];
}

}  // namespace calvin::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include <algorithm>

namespace calvin {

namespace {

HWY_EXPORT(luma_row);
HWY_EXPORT(halves_row);

void resize(GrayImage& image, int width, int height) {
  image.width = width;
  image.height = height;
  image.pixels.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
}

}  // namespace

void take_luma(const RgbView& image, GrayImage& to) {
  resize(to, image.width, image.height);
  LumaWeights weights;
  weights.of[image.red] = 77;
  weights.of[image.green] = 150;
  weights.of[image.blue] = 29;
  for (int y = 0; y < image.height; ++y) {
    HWY_DYNAMIC_DISPATCH(luma_row)
    (image.data + y * image.stride, image.step, weights, to.row(y),
     static_cast<std::size_t>(image.width));
  }
}

void take_luma(const ImageView& image, GrayImage& to) {
  resize(to, image.width, image.height);
  for (int y = 0; y < image.height; ++y) {
    const std::uint8_t* from = image.data + y * image.stride;
    std::uint8_t* out = to.row(y);
    if (image.step == 1) {
      std::copy_n(from, image.width, out);
    } else if (image.step == 2) {
      HWY_DYNAMIC_DISPATCH(halves_row)(from, out, static_cast<std::size_t>(image.width));
    } else {
      for (int x = 0; x < image.width; ++x) out[x] = from[x * image.step];
    }
  }
}

}  // namespace calvin

#endif  // HWY_ONCE
