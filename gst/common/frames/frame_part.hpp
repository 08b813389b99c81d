// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which part of the picture in a buffer is the frame: GstVideoCropMeta.
#pragma once

#include <optional>

#include <gst/video/video.h>

#include "calvin/camera/frame_fit.hpp"
#include "calvin/core/image.hpp"

namespace calvin::gst {

// px of the picture in memory, whose size GstVideoMeta tells or else the caps, and which is at
// least as large as those. Absent: the frame is all of it, and of the size in the caps.
[[nodiscard]] std::optional<FramePart> part_of(GstBuffer* buffer, const GstVideoInfo& info);

// What is the frame of a picture in memory.
[[nodiscard]] ImageView frame_of(const ImageView& picture, const std::optional<FramePart>& part);

// The format of what is in memory, where only the part is the frame, and of the frame.
[[nodiscard]] GstVideoInfo with_size(const GstVideoInfo& info, ImageSize size);

}  // namespace calvin::gst
