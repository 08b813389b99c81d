// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a method of an older tool makes of views by itself, before any least squares. Internal.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calvin/camera/camera.hpp"
#include "calvin/core/image.hpp"
#include "calvin/core/result.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/solve/residuals/points.hpp"

namespace calvin {

struct MethodResult {
  Camera camera;
  std::vector<SE3> camera_from_board;  // of the views given, m
  std::vector<std::string> remarks;    // what only this method has: sentences for the user
  // The camera that the least squares start from, where that is another one.
  std::optional<Camera> start;
};

struct MethodInput {
  std::span<const PointSet> views;
  ImageSize size;     // px
  bool skew = false;  // whether the axes of the image may be oblique
  // Whether the principal point is at the centre of the image, and fx = fy, where a method can make
  // use of that.
  bool centered = false;
  bool square = false;
};

}  // namespace calvin
