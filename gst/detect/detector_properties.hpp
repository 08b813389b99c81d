// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The properties of calibdetect.
#pragma once

#include "common/properties.hpp"
#include "detect/calib_detector.hpp"

namespace calvin::gst {

extern const Properties<CalibDetector> kDetectorProperties;

}  // namespace calvin::gst
