// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// When a session of calibrig is over: every camera has come to its end. A pad that nobody is linked
// to is no camera, and nobody waits for it.
#pragma once

#include <gst/gst.h>

namespace calvin::gst {

// Under the object lock of the element.
struct RigEnd {
  bool is_over = false;
  guint32 seqnum = GST_SEQNUM_INVALID;  // of the event that came last
};

// A camera's stream begins, or goes on after its end.
void camera_runs(GstElement* rig, RigEnd& end, GstPad* pad);

// A camera has come to its end. Whether the session has with it: true once.
[[nodiscard]] bool camera_ends(GstElement* rig, RigEnd& end, GstPad* pad, GstEvent* eos);

// A pad was taken away. Whether all others were at their end, and waited for it alone: true once.
[[nodiscard]] bool camera_goes(GstElement* rig, RigEnd& end);

// Where nobody is linked behind it, the pipeline ends where this element does.
[[nodiscard]] bool is_last(GstElement* rig);

}  // namespace calvin::gst
