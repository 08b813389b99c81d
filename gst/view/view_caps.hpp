// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The pictures that calibview makes.
#pragma once

#include <gst/gst.h>

#include "common/frames/frame_planes.hpp"

// All but the rate.
#define CALVIN_VIEW_CAPS                                                           \
  "video/x-raw, format = (string) " CALVIN_PLANE_FORMATS                           \
  ", "                                                                             \
  "width = (int) [ 16, 8192 ], height = (int) [ 16, 8192 ], pixel-aspect-ratio = " \
  "(fraction) 1/1, interlace-mode = (string) progressive, framerate = (fraction) "

namespace calvin::gst {

// What the source makes, and what the filter does: that has the rate of its input, which may be
// variable.
inline constexpr char kMadeViewCaps[] = CALVIN_VIEW_CAPS "[ 1/3600, 240 ]";
inline constexpr char kAnyViewCaps[] = CALVIN_VIEW_CAPS "[ 0, 2147483647 ]";
// What the filter stands behind, of which it needs no pixels.
inline constexpr char kViewInputCaps[] = "video/x-raw(ANY)";

// The caps without all but one of their choices: BGRx where that may be, for what is drawn needs no
// conversion then, and the size nearest to that one. Takes `caps`.
[[nodiscard]] GstCaps* fixate_view(GstCaps* caps, int width, int height);

}  // namespace calvin::gst
