// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A camera that was pushed while its rig was calibrated.
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "calvin/rig/solve_rig.hpp"

namespace calvin {

// A sentence for the user where a camera stands elsewhere in the second half of the time than in
// the first, by more than the errors of both, and by more than corners that fit as well as they do
// can leave open. Intrinsics stay as they are; each half is solved by itself: it takes as long as a
// solve of all. Empty where none has moved, or where a half does not say where cameras stand.
[[nodiscard]] std::string moved_cameras(const std::vector<RigCameraViews>& seen, RigOptions options,
                                        const std::stop_token& stop = {});

}  // namespace calvin
