// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The lattice of a grid that goes on beyond the picture: the largest one, with the parts of it that
// missing rows have cut off, numbered about its middle.
#pragma once

#include <optional>
#include <span>
#include <stop_token>

#include "calvin/detect/circles/disc_lattice.hpp"
#include "calvin/detect/circles/ellipse.hpp"
#include "calvin/target/unbounded_grid.hpp"

namespace calvin::detect {

inline constexpr int kFewestGridPoints = 16;

// Cells of the grid as the detector counts them, from the middle to the first and the last one.
inline constexpr int kGridReach = UnboundedGrid::kSide / 2 - 1;

// Out of the points of an image, each with an ellipse whose shape is that of a circle on the grid.
// Rows run along the x axis of the image as nearly as may be. `middle`: of the image, px. Absent
// where there are fewer than kFewestGridPoints in a lattice, and where a stop was requested.
[[nodiscard]] std::optional<DiscLattice> grid_lattice(std::span<const Ellipse> points,
                                                      const Pixel& middle,
                                                      const std::stop_token& stop);

}  // namespace calvin::detect
