// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A zoom table as it is calibrated, for tests of elements: calvin::check, the namespace, and
// calvin::check(), the function of the solver, are not for one file.
#pragma once

#include <cstdint>

#include "calvin/camera/zoom_table.hpp"
#include "zoom_lenses.hpp"

namespace calvin::scenes {

// 12 settings of 40 views each, with corners of 0.05 px.
[[nodiscard]] ZoomTable twelve_settings(const ZoomLens& lens, std::uint64_t seed);

}  // namespace calvin::scenes
