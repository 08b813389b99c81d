// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The part of a pixel's polygon that lies in a disc. Internal.
#pragma once

#include "calvin/synth/pixel_polygon.hpp"
#include "calvin/target/artwork/artwork.hpp"

namespace calvin::synth {

enum class Overlap { kNone, kPart, kAll };

// `inside` is only told where it is a part. Its area is that under the circle to 1e-4 px.
Overlap cut_disc(const Polygon& all, const Artwork::Disc& disc, Polygon& inside);

}  // namespace calvin::synth
