// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What filters share. calibdetect and calibsolve are always passthrough for pixels and yet may
// attach metas, which needs a writable buffer, not writable memory. caliboverlay and calibundistort
// change pixels.
#pragma once

#include <optional>

#include <gst/base/gstbasetransform.h>
#include <gst/video/video.h>

// Caps of raw video in system memory. What a GstVideoOverlayComposition on the frames will draw is
// not in the picture yet, so they are taken with that too; GStreamer knows two ways to write so.
#define CALVIN_RAW_CAPS(formats)                                                                               \
  GST_VIDEO_CAPS_MAKE(formats)                                                                                 \
  "; " GST_VIDEO_CAPS_MAKE_WITH_FEATURES(                                                                      \
      GST_CAPS_FEATURE_META_GST_VIDEO_OVERLAY_COMPOSITION,                                                     \
      formats) "; " GST_VIDEO_CAPS_MAKE_WITH_FEATURES(GST_CAPS_FEATURE_MEMORY_SYSTEM_MEMORY                    \
                                                      ","                                                      \
                                                      " " GST_CAPS_FEATURE_META_GST_VIDEO_OVERLAY_COMPOSITION, \
                                                      formats)

namespace calvin::gst {

// A filter that attaches metas, for class_init and instance_init: the pads of any raw video, and
// passthrough with transform_ip on every buffer, without QoS (it would drop video, not work).
void install_meta_filter(GstBaseTransformClass* trans_class);
void configure_meta_filter(GstBaseTransform* trans);

// A GstVideoFilter that changes pixels, for class_init: it works on frames as they are mapped, and
// on none that pass through.
void install_pixel_filter(GstBaseTransformClass* trans_class);

// Any raw video in system memory, with overlays that wait to be drawn or without, or in DMA memory
// under a name that there is for it, on both pads.
void add_raw_video_pads(GstElementClass* element_class);

// What the LATENCY query upstream of a sink pad says of the source; absent where nobody answers.
// Streaming thread.
[[nodiscard]] std::optional<bool> upstream_says_live(GstPad* sink);

// True unless the LATENCY query upstream says that the source is not live, or what does not answer
// it has a duration or can be seeked: anything else must not be held up. Streaming thread.
[[nodiscard]] bool upstream_is_live(GstPad* sink);

}  // namespace calvin::gst
