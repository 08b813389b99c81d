// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What most files of the plugin include, parsed once; see lib/pch/calvin_pch.hpp.
// Before GStreamer's headers.
#include "../overlay/video_blend.hpp"

#include <algorithm>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gst/gst.h>
#include <gst/video/gstvideofilter.h>
#include <gst/video/video.h>
#include <Eigen/Core>
#include <tl/expected.hpp>
