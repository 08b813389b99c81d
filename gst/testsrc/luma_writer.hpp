// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A grey picture into a frame of a raw format.
#pragma once

#include <gst/video/video.h>

#include "calvin/core/image.hpp"

namespace calvin::gst {

// Y, or R, G and B become the grey levels, of which 255 is the largest value of the format; chroma
// is neutral, alpha opaque. The frame is mapped for writing and has the picture's size; its format
// has no palette.
void write_luma(const GrayImage& picture, GstVideoFrame& frame);

}  // namespace calvin::gst
