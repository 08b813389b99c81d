// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The focal lengths of a lens that zooms, one for each view of a plane. Internal.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/core/result.hpp"
#include "calvin/solve/methods/method_result.hpp"

namespace calvin {

// A camera without distortion that keeps its principal point and its pixels while it zooms, px.
struct ZoomingPinhole {
  Pixel center;
  double aspect = 1;  // fx / fy
  // Of each view; absent where no lens sees its plane so, which noise and distortion bring about.
  std::vector<std::optional<double>> fx;
};

// P. Sturm, S. Maybank, On Plane-Based Camera Calibration: A General Algorithm, Singularities,
// Applications, CVPR 1999: the image of the absolute conic, of which the last number is another one
// in each view, linearly from the homographies. Each view has two equations, of which one goes to
// its own number; the principal point and the aspect, as far as they are not known before
// (MethodInput::centered and square), take one view each. kDegenerate, with the view and what to
// do: a plane that is parallel to the image, which tells no focal length; fewer views than
// unknowns; planes that leave the principal point or the aspect open, as those that are tilted
// about one axis alone.
[[nodiscard]] Result<ZoomingPinhole> sturm_maybank(const MethodInput& input);

// What to say of a view whose focal length is absent.
[[nodiscard]] Error no_focal_length(std::size_t view);

}  // namespace calvin
