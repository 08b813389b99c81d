// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How much of its picture a camera can be used for.
#pragma once

#include "calvin/camera/camera.hpp"

namespace calvin {

// The part of the picture, 0..1, that carries what the camera sees. Pixels to which no ray leads
// count for nothing, and where some pixels see nearly everything the others count for little: it is
// (sum of w)^2 / (n * sum of w^2) over cells of solid angle w. 1 where every pixel sees as much as
// the next; above 0.3 for any real lens that fills its picture.
[[nodiscard]] double usable_area(const Camera& camera);

// px^2: the part of the picture that a flat board can be shown in, up to 85 degrees from the axis.
// A lens of 180 degrees may leave the corners of its picture black. Where the model ends before
// that, which may be its own fault alone, it is all of the picture there.
[[nodiscard]] double visible_area(const Camera& camera);

// kDegenerate where that is below 0.2, with a message that says what to check: then nothing of the
// kind that people calibrate is meant, and an undistorted picture shows little but one colour.
[[nodiscard]] Status check_usable_area(const Camera& camera);

}  // namespace calvin
