// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where the samples of a plane lie in the picture: chroma planes are smaller than the luma.
#pragma once

#include <algorithm>

#include "calvin/core/image.hpp"

namespace calvin {

// How a plane is smaller than the frame: by 2^shift along each axis. A cosited sample lies on the
// first of the luma pixels it covers (MPEG-2: horizontally), otherwise in the middle of them
// (JPEG: both ways). Luma and packed RGB: the default.
struct Subsampling {
  int x_shift = 0;
  int y_shift = 0;
  bool x_cosited = false;
  bool y_cosited = false;
  // Luma pixels that the first sample covers before the frame: where the frame is a part of a
  // picture and begins on an odd pixel.
  int x_before = 0;
  int y_before = 0;

  friend bool operator==(const Subsampling&, const Subsampling&) = default;
};

// Where the samples of a plane lie in the source frame and in the output frame: chroma of the one
// siting may come out in the other.
struct PlaneSites {
  Subsampling source;
  Subsampling output;

  friend bool operator==(const PlaneSites&, const PlaneSites&) = default;
};

// The samples of a plane along one axis of the frame.
class SampleAxis {
 public:
  // `length` is that of the frame, px; `before` as Subsampling::x_before.
  SampleAxis(int length, int shift, bool cosited, int before) noexcept
      : count_((before + length + (1 << shift) - 1) >> shift),
        scale_(1 << shift),
        offset_((cosited ? 0 : (scale_ - 1) / 2) - before),
        last_(cosited ? offset_ + scale_ * (count_ - 1)
                      : (scale_ * (count_ - 1) - before + length - 1) / 2) {}

  [[nodiscard]] int count() const noexcept { return count_; }
  // px between samples, and px of the first one: a sample i lies at offset + scale i. Without
  // is_even(), the last sample lies before that.
  [[nodiscard]] double scale() const noexcept { return scale_; }
  [[nodiscard]] double offset() const noexcept { return offset_; }
  [[nodiscard]] bool is_even() const noexcept { return offset_ + scale_ * (count_ - 1) <= last_; }

  // Sample -> px of the frame. The last sample may cover fewer pixels than the others; it lies in
  // the middle of the pixels that it covers.
  [[nodiscard]] double site(int sample) const noexcept {
    return std::min(offset_ + scale_ * sample, last_);
  }

  // px of the frame -> sample, in 0..count-1; the inverse of site() between the first and the last
  // sample, clamped outside.
  [[nodiscard]] double sample(double position) const noexcept {
    const double inner = site(count_ - 2);
    if (position > inner && count_ > 1) {
      const double gap = site(count_ - 1) - inner;
      return count_ - 2 + std::min((position - inner) / gap, 1.0);
    }
    return std::clamp((position - offset_) / scale_, 0.0, count_ - 1.0);
  }

 private:
  int count_;
  double scale_;
  double offset_;
  double last_;  // px of the last sample
};

}  // namespace calvin
