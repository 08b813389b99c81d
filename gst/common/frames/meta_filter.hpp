// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What calibdetect and calibsolve share: a filter that is always passthrough for pixels and yet
// may attach metas. Attaching needs a writable buffer, not writable memory.
#pragma once

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

// For GstBaseTransformClass::prepare_output_buffer: the input itself where it is writable, else a
// copy that shares its memory.
GstFlowReturn share_input_buffer(GstBaseTransform* trans, GstBuffer* in, GstBuffer** out);

// For GstBaseTransformClass::propose_allocation of a class derived directly from GStreamer's: as
// its parent, without the crop meta that a sink may offer. Frames then are as large as their caps.
// For frames in DMA memory that go on as others no pool is proposed.
gboolean propose_uncropped_allocation(GstBaseTransform* trans, GstQuery* decide_query,
                                      GstQuery* query);

// Passthrough with transform_ip on every buffer, no QoS (it would drop video, not work).
void configure_meta_filter(GstBaseTransform* trans);

// Any raw video in system memory, with overlays that wait to be drawn or without, or in DMA memory
// under a name that there is for it, on both pads.
void add_raw_video_pads(GstElementClass* element_class);

// True unless the LATENCY query upstream says that the source is not live: one that cannot answer
// must not be held up. Streaming thread.
[[nodiscard]] bool upstream_is_live(GstBaseTransform* trans);

}  // namespace calvin::gst
