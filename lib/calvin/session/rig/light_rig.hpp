// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The cameras of a session before a light: what they have seen as solve_light() takes it, and what
// it has found as the rig of a session.
#pragma once

#include <stop_token>

#include "calvin/core/result.hpp"
#include "calvin/rig/solve_rig.hpp"
#include "calvin/session/rig/rig_session.hpp"

namespace calvin {

// The places of cameras in the order of the job, the first of which is the rig where no places are
// known. Cameras that share too little with the others are left out and named, as long as enough
// are there. Views are instants in `links` and `rejected`. Errors are those of light_cameras() and
// solve_light().
[[nodiscard]] Result<RigSolution> solve_light_rig(const RigJob& job, std::stop_token stop = {});

}  // namespace calvin
