// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What moves with the pixels of a frame: metas on their way down, pointer events on their way up.
#pragma once

#include <gst/gst.h>

#include "calvin/remap/undistorter.hpp"

namespace calvin::gst {

enum class MetaFate {
  kDone,    // mapped onto the output buffer, or its place is not in the output
  kCopy,    // has no place in the picture
  kOthers,  // nothing is known of it here
};

// Maps a meta of the buffer `in` onto `out`: observations, regions of interest.
[[nodiscard]] MetaFate map_meta(const Undistorter& undistorter, GstBuffer* in, GstMeta* meta,
                                GstBuffer* out);

// The navigation event for whoever made the source picture. Takes the event. In pointer events the
// top left corner of the picture is (0, 0), as videoscale has it. A pointer where the output shows
// nothing is taken to the border of what it shows: a button that was released there is up.
[[nodiscard]] GstEvent* map_navigation(const Undistorter& undistorter, GstEvent* event);

}  // namespace calvin::gst
