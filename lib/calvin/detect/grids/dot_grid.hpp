// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The dots of a grid that goes on beyond the picture.
#pragma once

#include <stop_token>

#include "calvin/core/observation.hpp"
#include "calvin/detect/circles/circle_pattern.hpp"
#include "calvin/detect/pyramid.hpp"

namespace calvin::detect {

// The images of the centres of all dots, the bias of the ellipses' centres taken off. Without
// control points where there is no such grid.
[[nodiscard]] Observation find_dot_grid(Pyramid& pyramid, const CirclePattern& pattern,
                                        const std::stop_token& stop);

}  // namespace calvin::detect
