// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What no file may hold, since the readers refuse it: looked at before anything is printed, alike
// for all formats. Internal.
#pragma once

#include "calvin/core/calibration.hpp"
#include "calvin/core/result.hpp"
#include "calvin/core/rig.hpp"

namespace calvin::io {

// kInvalidArgument, and the field, for a number that is not finite or none of its kind, as a sigma
// below 0. The camera itself is not looked at.
[[nodiscard]] Status check_printable(const Calibration& calibration);

// The same of a rig and all of its cameras, and for one without cameras or with a name twice.
[[nodiscard]] Status check_printable(const Rig& rig);

}  // namespace calvin::io
