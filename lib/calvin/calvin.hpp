// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// All of libcalvin, from pixels to an undistorted picture; docs/library.md walks through it. Each
// of these headers can be included alone. calvin/opencv.hpp, for programs that use OpenCV, is
// apart.
#pragma once

#include "calvin/camera/camera.hpp"              // IWYU pragma: export
#include "calvin/core/calibration.hpp"           // IWYU pragma: export
#include "calvin/core/image.hpp"                 // IWYU pragma: export
#include "calvin/core/observation.hpp"           // IWYU pragma: export
#include "calvin/core/reason.hpp"                // IWYU pragma: export
#include "calvin/core/result.hpp"                // IWYU pragma: export
#include "calvin/core/rig.hpp"                   // IWYU pragma: export
#include "calvin/detect/detector.hpp"            // IWYU pragma: export
#include "calvin/geometry/se3.hpp"               // IWYU pragma: export
#include "calvin/io/calibration_io.hpp"          // IWYU pragma: export
#include "calvin/io/observations.hpp"            // IWYU pragma: export
#include "calvin/io/rig_io.hpp"                  // IWYU pragma: export
#include "calvin/remap/picture_undistorter.hpp"  // IWYU pragma: export
#include "calvin/rig/solve_rig.hpp"              // IWYU pragma: export
#include "calvin/solve/pose.hpp"                 // IWYU pragma: export
#include "calvin/solve/solve.hpp"                // IWYU pragma: export
#include "calvin/target/board.hpp"               // IWYU pragma: export
#include "calvin/version.hpp"                    // IWYU pragma: export
