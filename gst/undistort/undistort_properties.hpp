// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The properties of calibundistort.
#pragma once

#include "common/properties.hpp"
#include "undistort/undistort_state.hpp"

namespace calvin::gst {

extern const Properties<UndistortState> kUndistortProperties;

}  // namespace calvin::gst
