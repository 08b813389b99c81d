// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How noisy an image is, and what is left of it where its noise is taken out.
#pragma once

#include <cstdint>
#include <vector>

#include "calvin/core/image.hpp"

namespace calvin::detect {

// The noise of an image (of step 1), grey levels, 1 sigma: by a thousand second differences over
// two px, whose median edges do not reach unless the image has little else. What JPEG has
// taken off the finest noise is not counted.
[[nodiscard]] float noise_of(const ImageView& image) noexcept;

// An image (of step 1) blurred by a Gaussian of 1 px (binomial, 5x5), which leaves a quarter of the
// noise. Uses the memory of `pixels`, which has to stay. `sums` is scratch.
[[nodiscard]] ImageView smoothed(const ImageView& image, std::vector<std::uint8_t>& pixels,
                                 std::vector<std::uint16_t>& sums);

}  // namespace calvin::detect
