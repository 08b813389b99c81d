// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A frame as a mirror shows it.
#pragma once

#include <optional>

#include <gst/video/video.h>

#include "common/frames/frame_part.hpp"

namespace calvin::gst {

// Turns the rows of a frame that is mapped for reading and writing, or of that part of it, left to
// right. What needs_padding() must be padded.
void mirror_frame(GstVideoFrame& frame, const std::optional<FramePart>& part);

}  // namespace calvin::gst
