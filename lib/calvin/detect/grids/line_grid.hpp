// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The crossings of a grid of lines that goes on beyond the picture.
#pragma once

#include <stop_token>

#include "calvin/core/observation.hpp"
#include "calvin/detect/pyramid.hpp"
#include "calvin/target/unbounded_grid.hpp"

namespace calvin::detect {

// Where its lines cross; without control points where there is no such grid.
[[nodiscard]] Observation find_line_grid(Pyramid& pyramid, const UnboundedGrid& grid,
                                         const std::stop_token& stop);

}  // namespace calvin::detect
