// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Compares pixels with the background and moves it towards them, a vector at a time.

#include "calvin/core/vector_targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "calvin/detect/light/light_background.cpp"
#include <hwy/foreach_target.h>
// The order matters: Highway includes this file again for each target from the line above.
#include <hwy/highway.h>

#include "calvin/detect/light/light_background.hpp"

#ifndef CALVIN_LIGHT_LEVELS
#define CALVIN_LIGHT_LEVELS
namespace calvin::detect {

// Grey levels by which a pixel has to be brighter beyond the spread: small spots of light that are
// worth a fit have more.
inline constexpr std::uint8_t kMargin = 12;
inline constexpr std::uint8_t kLeastSpread = 8;  // four times what rounding alone may do
inline constexpr std::uint8_t kMostSpread = 120;

}  // namespace calvin::detect
#endif

HWY_BEFORE_NAMESPACE();
namespace calvin::detect::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Whether any of `count` pixels is brighter than its background.
bool any_brighter(const std::uint8_t* image, const std::uint8_t* level, const std::uint8_t* spread,
                  std::size_t count) {
  const hn::ScalableTag<std::uint8_t> d;
  const std::size_t lanes = hn::Lanes(d);
  const auto margin = hn::Set(d, kMargin);
  auto excess = hn::Zero(d);
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    const auto limit = hn::SaturatedAdd(hn::LoadU(d, level + i),
                                        hn::SaturatedAdd(hn::LoadU(d, spread + i), margin));
    excess = hn::Or(excess, hn::SaturatedSub(hn::LoadU(d, image + i), limit));
  }
  if (!hn::AllTrue(d, hn::Eq(excess, hn::Zero(d)))) return true;
  for (; i < count; ++i) {
    if (image[i] > level[i] + spread[i] + kMargin) return true;
  }
  return false;
}

void learn_pixels(const std::uint8_t* image, std::uint8_t* level, std::uint8_t* spread,
                  std::size_t count) {
  const hn::ScalableTag<std::uint8_t> d;
  const std::size_t lanes = hn::Lanes(d);
  const auto one = hn::Set(d, 1);
  const auto margin = hn::Set(d, kMargin);
  // A step of one towards `to`.
  const auto towards = [&](auto from, auto to) {
    const auto up = hn::Min(hn::SaturatedSub(to, from), one);
    return hn::Sub(hn::Add(from, up), hn::Min(hn::SaturatedSub(from, to), one));
  };
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    const auto now = hn::LoadU(d, image + i);
    const auto was = hn::LoadU(d, level + i);
    const auto wide = hn::LoadU(d, spread + i);
    const auto darker = hn::SaturatedSub(was, now);
    const auto fell = hn::Gt(darker, hn::SaturatedAdd(wide, margin));
    hn::StoreU(hn::IfThenElse(fell, hn::AverageRound(was, now), towards(was, now)), d, level + i);
    const auto apart = hn::Or(darker, hn::SaturatedSub(now, was));
    const auto twice = hn::SaturatedAdd(apart, apart);
    const auto next = towards(wide, hn::SaturatedAdd(twice, twice));
    hn::StoreU(hn::Min(hn::Max(next, hn::Set(d, kLeastSpread)), hn::Set(d, kMostSpread)), d,
               spread + i);
  }
  const auto step = [](int from, int to) { return from + (to > from ? 1 : to < from ? -1 : 0); };
  for (; i < count; ++i) {
    const int now = image[i];
    const int was = level[i];
    const bool fell = was - now > spread[i] + kMargin;
    level[i] = static_cast<std::uint8_t>(fell ? (was + now + 1) / 2 : step(was, now));
    const int apart = now > was ? now - was : was - now;
    const int next = step(spread[i], 4 * apart);
    spread[i] = static_cast<std::uint8_t>(next < kLeastSpread  ? kLeastSpread
                                          : next > kMostSpread ? kMostSpread
                                                               : next);
  }
}

}  // namespace calvin::detect::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include <algorithm>

namespace calvin::detect {

namespace {

HWY_EXPORT(any_brighter);
HWY_EXPORT(learn_pixels);

constexpr std::uint8_t kFirstSpread = 16;  // as of noise of 6 grey levels, until it is known

const std::uint8_t* row_of(const ImageView& image, int y) { return image.data + y * image.stride; }

}  // namespace

PixelBox PixelBox::grown(int by, ImageSize size) const noexcept {
  return {std::max(left - by, 0), std::max(top - by, 0), std::min(right + by, size.width - 1),
          std::min(bottom + by, size.height - 1)};
}

void LightBackground::start(const ImageView& image) {
  start(image.size(), 0, kFirstSpread);
  take(image, {0, 0, size_.width - 1, size_.height - 1});
}

void LightBackground::start(ImageSize size, std::uint8_t level, std::uint8_t spread) {
  size_ = size;
  const std::size_t count =
      static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
  level_.assign(count, level);
  spread_.assign(count, spread);
}

bool LightBackground::find_brighter(const ImageView& image, std::size_t most,
                                    std::vector<BrightRun>& runs) const {
  constexpr int kBlock = 128;  // px, looked at together
  runs.clear();
  std::size_t found = 0;
  for (int y = 0; y < size_.height; ++y) {
    const std::uint8_t* row = row_of(image, y);
    const std::size_t start = index(0, y);
    for (int first = 0; first < size_.width; first += kBlock) {
      const int end = std::min(first + kBlock, size_.width);
      const std::size_t at = start + static_cast<std::size_t>(first);
      if (!HWY_DYNAMIC_DISPATCH(any_brighter)(row + first, level_.data() + at, spread_.data() + at,
                                              static_cast<std::size_t>(end - first))) {
        continue;
      }
      for (int x = first; x < end; ++x) {
        if (row[x] <= level(x, y) + threshold(x, y)) continue;
        if (++found > most) return false;
        if (!runs.empty() && runs.back().row == y && runs.back().last == x - 1) {
          runs.back().last = x;
        } else {
          runs.push_back({y, x, x});
        }
      }
    }
  }
  return true;
}

void LightBackground::learn(const ImageView& image, const std::vector<PixelBox>& without) {
  for (int y = 0; y < size_.height; ++y) {
    const std::uint8_t* row = row_of(image, y);
    const std::size_t start = index(0, y);
    // From what ends a box to where the next one begins; the boxes may lie over each other.
    for (int x = 0; x < size_.width;) {
      int end = size_.width;
      int next = size_.width;
      for (const PixelBox& box : without) {
        if (y < box.top || y > box.bottom || box.right < x) continue;
        if (box.left < end) {
          end = std::max(box.left, x);
          next = box.right + 1;
        }
      }
      const std::size_t at = start + static_cast<std::size_t>(x);
      HWY_DYNAMIC_DISPATCH(learn_pixels)
      (row + x, level_.data() + at, spread_.data() + at, static_cast<std::size_t>(end - x));
      x = next;
    }
  }
}

void LightBackground::take(const ImageView& image, const PixelBox& part) {
  for (int y = part.top; y <= part.bottom; ++y) {
    std::copy_n(row_of(image, y) + part.left, part.width(), level_.data() + index(part.left, y));
  }
}

// A normal distribution has a median difference of 0.674 sigma.
double LightBackground::noise(int x, int y) const noexcept {
  return spread_[index(x, y)] / (4 * 0.674);
}

int LightBackground::threshold(int x, int y) const noexcept {
  return spread_[index(x, y)] + kMargin;
}

}  // namespace calvin::detect

#endif  // HWY_ONCE
