// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Whether what was given of cameras before a light can be solved. Internal.
#pragma once

#include <cstddef>
#include <vector>

#include "calvin/core/result.hpp"
#include "calvin/rig/light/alignment.hpp"
#include "calvin/rig/light_camera.hpp"

namespace calvin::rig {

// kInvalidArgument for lists that do not fit together, kDegenerate for too few cameras or instants.
[[nodiscard]] Status check(const std::vector<LightCamera>& cameras, std::size_t lights);

// kInvalidArgument for places of lights that are none, or known worse than they are apart.
[[nodiscard]] Status check_wand(const LightOptions& options);

// kInvalidArgument for a camera that is not there or there twice, and for a single place.
[[nodiscard]] Result<std::vector<KnownPlace>> known_places(const std::vector<LightCamera>& cameras,
                                                           const std::vector<CameraPlace>& places);

}  // namespace calvin::rig
