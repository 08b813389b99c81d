// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The pixels along a side of a tag, and a first line through them.
#pragma once

#include <optional>

#include "calvin/core/image.hpp"
#include "calvin/detect/tags/side_fit.hpp"
#include "calvin/detect/tags/side_sums.hpp"

namespace calvin::detect {

// How far pixels are taken: px from the side to the next edge, at the least.
[[nodiscard]] double room_inside(const SideGuess& guess);
[[nodiscard]] double room_outside(const SideGuess& guess);

// Coordinates along and across a line from corner to corner.
class SideFrame {
 public:
  explicit SideFrame(const SideGuess& guess);

  // px, half of the length.
  [[nodiscard]] double half() const { return half_; }
  [[nodiscard]] double along(const Point& p) const { return (p - middle_).dot(along_) / half_; }
  [[nodiscard]] double across(const Point& p) const { return (p - middle_).dot(outwards_); }
  [[nodiscard]] Point at(double t, double n) const {
    return middle_ + half_ * t * along_ + n * outwards_;
  }
  [[nodiscard]] const Point& along() const { return along_; }
  [[nodiscard]] const Point& outwards() const { return outwards_; }

 private:
  Point middle_;
  Point along_;
  Point outwards_;
  double half_;
};

// offset + slope t + bend (1 - t^2)
struct SideCurve {
  double offset = 0;  // px
  double slope = 0;   // px
  double bend = 0;    // px

  [[nodiscard]] double at(double t) const { return offset + slope * t + bend * (1 - t * t); }
};

// Through the places across the side where the grey level changes most; absent where it does so
// along less than half of the side that is in the image.
[[nodiscard]] std::optional<SideCurve> coarse_side(const ImageView& image, const SideFrame& frame,
                                                   const SideGuess& guess);

// Which pixels near a curve are taken.
struct SideBand {
  double inside = 0;   // px across the curve
  double outside = 0;  // px
  double end = 1;      // |t|
  double blur = 0;     // px, of bits along the side
  int every = 1;       // one in so many lines of pixels across the side
};
void gather_side(const ImageView& image, const SideFrame& frame, const SideGuess& guess,
                 const SideCurve& curve, const SideBand& band, SidePixels& pixels);

}  // namespace calvin::detect
