// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The ellipse around a place of an image, to a fraction of a pixel: what discs are told by.
#pragma once

#include <optional>

#include "calvin/core/image.hpp"
#include "calvin/detect/circles/ellipse.hpp"

namespace calvin::detect {

// Looks for the rim along rays from a place inside of a disc, at most `reach` px away. Absent where
// the rim is no ellipse, or has less than `contrast` grey levels.
[[nodiscard]] std::optional<Ellipse> measure_blob(const ImageView& image, double x, double y,
                                                  bool light, double reach, float contrast);

// An ellipse of which the rim is known to a part of the radius, such as one that a smaller picture
// has shown, by where the grey level half way is passed around it: to a small part of the blur.
// Absent where it is not passed all around.
[[nodiscard]] std::optional<Ellipse> closer_ellipse(const ImageView& image, const Ellipse& near);

}  // namespace calvin::detect
