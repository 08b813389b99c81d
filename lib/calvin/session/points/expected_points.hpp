// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where the points of a board that nobody has chosen yet are to be looked for, once some of them
// tell its pose before a known camera.
#pragma once

#include <cstddef>
#include <set>
#include <vector>

#include "calvin/camera/camera.hpp"
#include "calvin/session/points/manual_points.hpp"
#include "calvin/solve/view.hpp"

namespace calvin {

struct ExpectedPoint {
  int id = 0;
  PointChoice choice;  // at its projection
  double reach = 0;    // px, in which nothing but this point is expected
};

// At most so many of the points of the board of `chosen` that are neither in it nor among
// `without`, in the order of their ids, as far as they are in the picture. Each is looked for
// within `reach` px, and within 0.4 of the way to the next point, so that it is no other one.
// Empty where the chosen points do not agree with the camera.
[[nodiscard]] std::vector<ExpectedPoint> expected_points(const Camera& camera, const View& chosen,
                                                         const std::set<int>& without,
                                                         std::size_t most, double reach);

}  // namespace calvin
