// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A disc to a small fraction of a pixel: the least squares fit of a blurred ellipse to the pixels
// near its rim.
//
//   grey(p) = (1 + slope . p) (inside + (outside - inside) (1 + erf(s / (sqrt 2 width))) / 2)
//
// with p from the centre and s the distance of the pixel from the rim, positive outside. Estimated:
// the centre, the three numbers of the ellipse, both grey levels and the width. The slope of the
// light is given by the caller, who knows the neighbours: near a rim it can hardly be told from the
// place.
#pragma once

#include "calvin/core/image.hpp"
#include "calvin/detect/circles/ellipse.hpp"

namespace calvin::detect {

struct DiscFit {
  Ellipse ellipse;
  double width = 0.8;  // px, 1 sigma of the blur across the rim

  // Given by the caller: of the light, of itself per px.
  double slope_x = 0;
  double slope_y = 0;
  // Of the radius, from the rim inwards, where something else begins: the hole of a ring.
  double room = 1;

  double off = 1.5;  // px, by which the rim may be off before the first fit

  // Results of the last step.
  double noise = 0;     // grey levels, 1 sigma
  double residual = 0;  // grey levels, RMS
  double sigma = 0;     // px, 1 sigma per coordinate of the centre
};

// Improves a fit, in at most `steps` steps of Gauss and Newton. The image has step 1. False where
// the fit runs away, or too much of the rim is beyond the border of the image.
[[nodiscard]] bool fit_disc(const ImageView& image, int steps, DiscFit& fit) noexcept;

}  // namespace calvin::detect
