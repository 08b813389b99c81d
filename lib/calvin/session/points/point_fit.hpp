// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How well manual points agree with a known camera, and which of them was chosen wrongly.
#pragma once

#include <optional>
#include <string>

#include "calvin/camera/camera.hpp"
#include "calvin/solve/view.hpp"

namespace calvin {

struct PointFit {
  double rms = 0;          // px, of all points before the camera
  double expected = 0;     // px, at most so much of right points
  std::optional<int> odd;  // id of the point without which the others agree
  double rms_without = 0;  // px, of them

  [[nodiscard]] bool agrees() const noexcept { return rms <= expected; }
};

// By the pose of the points, and where they do not agree by the poses of all of them but one.
// Absent where they have no pose.
[[nodiscard]] std::optional<PointFit> fit_points(const Camera& camera, const View& view);

// A sentence for a user.
[[nodiscard]] std::string to_text(const PointFit& fit);

}  // namespace calvin
