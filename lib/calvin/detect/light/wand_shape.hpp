// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which spots lie as three lights on a wand do: on a line, and the one in the middle nearer to one
// end. A picture keeps the order of points on a line, and their ratio up to perspective, so that
// two unequal distances name all three. Internal.
#pragma once

#include <cstddef>
#include <vector>

#include "calvin/core/result.hpp"
#include "calvin/detect/light/light_choice.hpp"
#include "calvin/target/point_light.hpp"

namespace calvin::detect {

// kUnsupported for a wand whose lights no picture tells apart.
[[nodiscard]] Status check_shape(const PointLight& light);

// All sets of spots that may be the lights of the wand, in the order of the lights. `wand` are the
// places along it, of one that check_shape() takes.
[[nodiscard]] std::vector<std::vector<std::size_t>> sets_of_wand(
    const std::vector<LightSpotSeen>& spots, const std::vector<double>& wand);

}  // namespace calvin::detect
