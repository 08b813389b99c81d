// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What most tests of the elements include, parsed once; see lib/pch/calvin_pch.hpp. Without
// gstcheck.h, whose macro `fail` no other header may meet.
// Before GStreamer's headers.
#include "../../gst/overlay/video_blend.hpp"

// Before fmt; see there.
#include "calvin/core/vector_targets.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gst/app/gstappsink.h>
#include <gst/app/gstappsrc.h>
#include <gst/check/gstharness.h>
#include <gst/gst.h>
#include <gst/video/video.h>
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <tl/expected.hpp>
