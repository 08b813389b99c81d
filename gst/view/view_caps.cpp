// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What calibview makes where downstream takes several things.

#include "view/view_caps.hpp"

#include "common/values.hpp"

namespace calvin::gst {

namespace {

// Not in grey where colours may be: a converter before an encoder of both lists what the encoder
// takes first.
GstCaps* prefer_colours(GstCaps* caps) {
  for (const char* format : {"BGRx", "RGBx", "RGBA", "RGB"}) {
    g_autoptr(GstCaps) wish =
        gst_caps_new_simple("video/x-raw", "format", G_TYPE_STRING, format, nullptr);
    GstCaps* both = gst_caps_intersect_full(caps, wish, GST_CAPS_INTERSECT_FIRST);
    if (!gst_caps_is_empty(both)) {
      gst_caps_unref(caps);
      return both;
    }
    gst_caps_unref(both);
  }
  return caps;
}

}  // namespace

GstCaps* fixate_view(GstCaps* caps, int width, int height) {
  caps = gst_caps_make_writable(gst_caps_truncate(prefer_colours(caps)));
  GstStructure* s = gst_caps_get_structure(caps, 0);
  gst_structure_fixate_field_string(s, "format", "BGRx");
  gst_structure_fixate_field_nearest_int(s, "width", width);
  gst_structure_fixate_field_nearest_int(s, "height", height);
  fixate_rate(s, 25);
  return caps;
}

}  // namespace calvin::gst
