// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The library's overlay tiles onto a mapped frame of any raw format.
#pragma once

#include <gst/video/video.h>

#include "calvin/draw/overlay.hpp"
#include "common/frames/frame_part.hpp"

namespace calvin::gst {

// `frame` must be mapped for reading and writing; the tile belongs on `part` of it, if there is
// one. False where libgstvideo cannot blend onto the format.
bool blend_tile(GstVideoFrame* frame, const OverlayTile& tile,
                const std::optional<FramePart>& part = {});

}  // namespace calvin::gst
