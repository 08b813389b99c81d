// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A grey picture into a frame of a raw format.
#pragma once

#include <gst/video/video.h>

#include "calvin/core/image.hpp"

namespace calvin::gst {

// Y of GRAY8, I420, NV12 and YUY2, or B, G and R of BGRx, become the grey levels; chroma is
// neutral. The frame is mapped for writing and has the picture's size.
void write_luma(const GrayImage& picture, GstVideoFrame& frame);

}  // namespace calvin::gst
