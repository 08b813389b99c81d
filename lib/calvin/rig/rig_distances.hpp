// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How far corners are apart by the rays of two cameras, beside how far they are on the board: in
// millimetres what residuals say in px. Internal.
#pragma once

#include <optional>
#include <vector>

#include "calvin/geometry/se3.hpp"
#include "calvin/rig/common_corners.hpp"

namespace calvin::rig {

struct DistanceError {
  double bias = 0;    // mean ratio less 1
  double spread = 0;  // m, root mean square of what is left
};

// Of the corners of each common view of two cameras. Absent where no two rays meet at an angle of a
// degree.
[[nodiscard]] std::optional<DistanceError> distance_error(
    const std::vector<std::vector<CommonCorner>>& views, const SE3& b_from_a);

}  // namespace calvin::rig
