// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A sink pad of calibrig: one camera, with properties of its own.
#pragma once

#include <atomic>
#include <cstddef>
#include <vector>

#include <gst/gst.h>

#include "common/frames/frame_points.hpp"
#include "rig/rig_solver.hpp"

G_DECLARE_FINAL_TYPE(GstCalibRigPad, gst_calib_rig_pad, GST, CALIB_RIG_PAD, GstPad)

namespace calvin::gst {

// A new, floating pad. `source`, the new pad behind it, lives as long as it does. Each of the two
// answers queries as the other one's peer does.
[[nodiscard]] GstPad* new_rig_pad(GstPadTemplate* templ, const char* name, std::size_t camera,
                                  GstPad* source);

[[nodiscard]] std::size_t camera_of(GstPad* pad);
[[nodiscard]] GstPad* source_of(GstPad* pad);
// The sink pad before a source pad; nullptr once it was released.
[[nodiscard]] GstPad* sink_of(GstPad* source);

// The name of the pad's number, as cam0, where none was set.
[[nodiscard]] RigCameraSettings settings_of(GstPad* pad);

// What the streaming thread of the pad uses, and the element while there is none.
struct RigPadStream {
  GstSegment segment;
  guint64 rig_number = 0;              // of the rig that went downstream last
  bool at_end = false;                 // under the object lock of the element
  std::atomic<bool> is_known = false;  // the solver was told of the camera since it started
  bool has_own_intrinsics =
      false;  // by the property, as it was then: those of upstream do not count
  FramePoints points;
};
[[nodiscard]] RigPadStream& stream_of(GstPad* pad);

// The settings of a pad as they are now, which are those of its camera until the next start.
[[nodiscard]] RigCameraSettings take_settings(GstPad* pad);

// New references of all sink pads of the element, by their numbers.
[[nodiscard]] std::vector<GstPad*> sink_pads_of(GstElement* rig);
[[nodiscard]] RigNames names_of(const std::vector<GstPad*>& pads);

// Fills in GstChildProxyInterface: `sink_0::intrinsics=left.json`.
void sink_pads_as_children(gpointer iface, gpointer data);

}  // namespace calvin::gst
