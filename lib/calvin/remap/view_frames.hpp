// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The largest view within what cameras see, and the smallest view around it: the two ends of alpha.
#pragma once

#include <span>

#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/remap/projection.hpp"

namespace calvin {

// A camera, and the axes of the view that its pictures are to have.
struct Sight {
  Camera camera;
  Eigen::Matrix3d camera_from_view = Eigen::Matrix3d::Identity();
};

// Where the centres of the output's border pixels lie on the plane of the projection.
struct ViewFrames {
  PlaneBox inner;    // without an invalid pixel
  PlaneBox outer;    // with every pixel that is valid
  bool cut = false;  // the projection shows less than the cameras see
};

// Views of `size` px whose plane several cameras share, so that each direction has the same pixel
// in all of them; fx:fy is that of the first camera. Directions are at infinity: what is near lies
// elsewhere for cameras that stand apart. kDegenerate where a model has no valid region in its
// image, or where the cameras see nothing in common.
[[nodiscard]] Result<ViewFrames> find_view_frames(std::span<const Sight> sights,
                                                  Projection projection, ImageSize size);

}  // namespace calvin
