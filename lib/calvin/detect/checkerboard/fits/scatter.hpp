// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The errors of the corners of a board beside their sigmas, measured on the board itself.
#pragma once

#include "calvin/core/image.hpp"
#include "calvin/detect/checkerboard/lattice.hpp"

namespace calvin::detect {

// The ratio of the errors of a fitted lattice's nodes (px of the image) to their sigmas. A sigma
// comes from the noise in one window; compression of the image, or a blur that is not the fit's,
// make errors that one window does not show. The ratio is 1 for too few corners, and the fewer the
// corners the nearer it is to 1.
//
// A board is a smooth grid, whatever the lens, so that roughness is error. Two measures:
//   surface      the residuals of a polynomial of the fifth degree over the image, fitted to the
//                distances of the corners from a homography. Uses all corners, and so is preferred;
//                fails where corners are few or a wide lens bends the board more.
//   differences  mixed differences of the same distances over six corners by five, or five by four
//                (over five by three a wide lens still shows). So few of them are independent that
//                a ratio well below 1 is chance, and is not told.
// Before a wide lens, the image is first straightened by the one-parameter model that makes the
// board most like a plane.
[[nodiscard]] float scatter(const Lattice& lattice, ImageSize image);

}  // namespace calvin::detect
