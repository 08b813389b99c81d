// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// By how much the corners of a board are really off, as the board itself tells.
#pragma once

#include "calvin/core/image.hpp"
#include "calvin/detect/lattice.hpp"

namespace calvin::detect {

// The ratio of the errors of the nodes of a fitted lattice, in px of the image, to their sigmas. A
// grid is smooth, whatever the lens: what is left of a homography is a polynomial of the fifth
// degree over the image, and the corners' own errors are what is left of that. Where corners are
// too few for it, or a wide lens bends the board more: what is left of a homography, for a wide
// lens of one to the image straightened, changes so slowly over six corners by five (or five by
// four) that the corners' own errors are what their mixed difference has. Over five by three a wide
// lens still shows. The compression of an image, or a blur that is not the fit's, make errors that
// the noise in the window of one corner does not tell. 1 where there are too few corners; the
// fewer, the nearer to it.
[[nodiscard]] float scatter(const Lattice& lattice, ImageSize image);

}  // namespace calvin::detect
