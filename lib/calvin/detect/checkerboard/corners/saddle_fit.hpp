// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A corner to a small fraction of a pixel: the least squares fit of a smooth saddle to the pixels
// around it.
//
//   grey(p) = level + slope . p + (contrast + contrast_slope . p) s(a / wa, b / wb)
//
// with p from the corner, a the distance of the pixel from the edge in direction `along`, to the
// side of `down`, and b its distance from the edge in direction `down`, to the side of `along`; cut
// off at 255 and at 0, as an over-exposed image is. s is a Gaussian blur's: e(a / wa) e(b / wb)
// with e(x) = erf(x / sqrt 2) where the edges are perpendicular, and more where they are not, see
// saddle_model-inl.hpp; in a sharp picture e is that of a pixel's square and what else there is of
// blur. The edges may be bent: a = straight distance - bend (u^2 + wa^2) / 2, u the way along the
// edge; the term in wa^2 is the effect of the blur. Estimated: place, both directions, level,
// contrast and both widths. Bends and slopes are given by the caller, who knows the neighbours: a
// small window cannot tell them from the place, as all are odd about the corner, and left free they
// cost 30 % of the accuracy.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "calvin/core/image.hpp"
#include "calvin/detect/checkerboard/corners/corner.hpp"
#include "calvin/detect/checkerboard/corners/edge_dots.hpp"

namespace calvin::detect {

inline constexpr int kMaxFitRadius = 60;  // px

// What neighbours let expect of the edges of a corner, for a window that is too noisy to tell.
struct ExpectedEdges {
  Direction along;
  Direction down;
  float along_width = 1;  // px
  float down_width = 1;
  double x = 0;  // px, where the edges cross
  double y = 0;
  float sigma = 0;  // px, 1 sigma of x and of y; 0: the place is not expected
};

struct SaddleFit {
  double x = 0;
  double y = 0;
  Direction along;
  Direction down;
  float level = 0;  // grey levels
  // Half the difference of the squares, grey levels; positive: bright between along and down.
  float contrast = 0;
  float along_width = 1.3F;  // px, 1 sigma of the blur across the edge
  float down_width = 1.3F;

  // Whether the gain is estimated too, and the gain: how far bright squares reach beyond the edges,
  // px. Over-exposed white reaches further; where ink has run, bright squares end before the
  // corner.
  bool has_gain = false;
  float gain = 0;

  // Given by the caller.
  float along_bend = 0;  // 1/px
  float down_bend = 0;
  // px from an edge, where something else begins; pixels beyond are left out.
  float room = std::numeric_limits<float>::infinity();
  Direction slope = {0, 0};           // grey levels per px
  Direction contrast_slope = {0, 0};  // grey levels per px
  // With it, what is expected counts as a measurement: directions to .08 rad, widths to a quarter.
  bool has_expected = false;
  ExpectedEdges expected;

  // On the edges; they are taken out of the pixels where the contrast is known.
  EdgeDots dots;

  // Results of the last step.
  float radius = 0;        // px, of the window
  float residual = 0;      // grey levels, RMS
  float noise = 0;         // grey levels, 1 sigma, from what differs between opposite pixels
  bool at_border = false;  // the window is cut there, and `noise` is told by all residuals
  float sigma = 0;         // px, 1 sigma per coordinate, from `noise` and rounding
  float rounding = 0;  // px, the part of sigma that other corners of the row or column may share
  float cut = 0;       // share of the pixels that are white or black, and would be more so

  // Half the difference of the squares and the middle between them as the image shows them.
  [[nodiscard]] float swing() const { return 0.5F * (bright() - dark()); }
  [[nodiscard]] float middle() const { return 0.5F * (bright() + dark()); }

 private:
  [[nodiscard]] float bright() const { return std::min(level + std::abs(contrast), 255.0F); }
  [[nodiscard]] float dark() const { return std::max(level - std::abs(contrast), 0.0F); }
};

// What a pixel of a sharp image is taken for. Points are quicker, and .05 px off where edges run
// along rows of pixels.
enum class Pixels { kSquares, kPoints };

// Improves the fit in at most `steps` steps of Gauss and Newton, until one moves the place by less
// than `tolerance` px, which leaves an error of about the square of that. Pixels within `radius` px
// of the corner count, as far as they are in the image (of step 1). With a `contrast` of 0, level
// and contrast are taken from the image first. False where the fit runs away, by more than 0.6
// radius, or where there is no saddle; the fit is then spoilt.
[[nodiscard]] bool fit_saddle(const ImageView& image, float radius, int steps, SaddleFit& fit,
                              float tolerance = 0.02F, Pixels pixels = Pixels::kSquares) noexcept;

}  // namespace calvin::detect
