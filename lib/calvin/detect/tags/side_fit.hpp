// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A side of a tag to a small fraction of a pixel: the least squares fit of blurred edges to the
// pixels along it.
//
//   grey(p) = in(t) + (out(t) - in(t)) v
//   v = e(0) - first (e(border) - e(second)) - second e(second) + second - beyond e(gap)
//   e(at) = (1 + erf((s - at) / (sqrt 2 width))) / 2,  s = n - offset - slope t - bend (1 - t^2)
//
// with t along the side, -1 to 1 from one corner of the tag to the other, n the distance from the
// line between these corners, positive outside, in(t) and out(t) linear. `first` and `second` are
// the bits of the first two rows behind the border, blurred along the side, and begin at `border`
// and `second`, which are negative; `beyond` is 1 where another tag, or a bit of the tag's own that
// is like its border, begins at `gap`. Estimated: offset, slope, the bend as far as it is not
// known, the width and the four numbers of the grey levels.
#pragma once

#include <optional>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/detect/tags/point.hpp"

namespace calvin::detect {

// An edge beside the side, px across it at t = 0, and its slope by t.
struct NextEdge {
  double at = 0;
  double slope = 0;
};

// px, 1 sigma of the blur across a side of a picture of which nothing is known.
inline constexpr double kUsualWidth = 0.8;

// How much of a side is looked at.
enum class SideCare {
  kRough,  // of a long side, some lines of pixels across it
  kFull,   // the same first, then all pixels near it
  kAgain,  // all pixels: the guess is what was fitted before
};

// Where the side is thought to be, as a line from corner to corner whose left is outside, and what
// is beside it.
struct SideGuess {
  Point from;
  Point to;
  double reach = 1;            // px, how far it may be off
  double bend = 0;             // px, of its middle, positive outside, as far as it is known
  double bend_sigma = 1;       // px
  double width = kUsualWidth;  // px, 1 sigma of the blur, from which the fit begins
  bool inverted = false;       // the tag is light
  SideCare care = SideCare::kFull;

  NextEdge border;  // where the first row of bits begins
  NextEdge second;  // where the second row begins
  NextEdge gap;     // where the next tag begins
  bool beyond = false;
  std::vector<double> cuts;   // t, from the first bit to the end of the last one
  std::vector<float> first;   // 1 for a light bit
  std::vector<float> behind;  // of the second row
  // Where a tag has bits outside of its border: 0 for one that is like what is around the border.
  std::vector<double> outer_cuts;
  std::vector<float> outer;
};

struct SideFit {
  // px, beside the guessed line at t = -1 and at t = 1, positive outside, and 1 sigma: after a
  // rough fit what all pixels would have left of it.
  double offset[2] = {0, 0};
  double sigma[2] = {0, 0};
  double slope[2] = {0, 0};       // of the side against the guessed line, at these places
  bool seen[2] = {false, false};  // something else covers the side at the other ones
  double width = 0;               // px, 1 sigma of the blur across the side
};

// The image has step 1. Absent where there is no such side.
[[nodiscard]] std::optional<SideFit> fit_side(const ImageView& image, const SideGuess& guess);

}  // namespace calvin::detect
