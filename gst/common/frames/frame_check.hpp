// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Whether a buffer holds the picture that its caps promise.
#pragma once

#include <gst/video/video.h>

#include "calvin/core/result.hpp"

namespace calvin::gst {

// GStreamer itself believes what a GstVideoMeta says, and GstVideoFilter lets a frame that it
// cannot read through unwritten: this finds both. The frame must not be read after an Error.
[[nodiscard]] Status check_frame(const GstVideoInfo& info, GstBuffer* buffer);

}  // namespace calvin::gst
