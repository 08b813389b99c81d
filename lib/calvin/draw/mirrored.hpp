// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What is to be drawn on a picture that was turned left to right, as a mirror shows it.
#pragma once

#include <string>

#include "calvin/core/observation.hpp"
#include "calvin/session/progress.hpp"

namespace calvin {

// The corners where they are then; `frame` is the size of an observation that tells none.
[[nodiscard]] Observation mirrored(Observation seen, ImageSize frame);

// The ghost and the map, and the hint with left for right. The target stays as it is.
[[nodiscard]] Progress mirrored(Progress progress);

}  // namespace calvin
