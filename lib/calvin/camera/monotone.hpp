// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Whether a camera is one all over its image.
#pragma once

#include "calvin/camera/camera.hpp"

namespace calvin {

// Whether every pixel, from border to border, has a ray and that ray leads back to it: then the
// radial distortion grows monotonely as far as the image shows, and nothing folds back inside it.
// kDegenerate names the nearest pixel that has none. A fisheye lens whose picture does not fill the
// image is not valid in the black corners, and this says so too.
[[nodiscard]] Status check_monotone(const Camera& camera);

}  // namespace calvin
