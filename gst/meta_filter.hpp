// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What calibdetect and calibsolve share: a filter that is always passthrough for pixels and yet
// may attach metas. Attaching needs a writable buffer, not writable memory.
#pragma once

#include <gst/base/gstbasetransform.h>

namespace calvin::gst {

// For GstBaseTransformClass::prepare_output_buffer: the input itself where it is writable, else a
// copy that shares its memory.
GstFlowReturn share_input_buffer(GstBaseTransform* trans, GstBuffer* in, GstBuffer** out);

// Passthrough with transform_ip on every buffer, no QoS (it would drop video, not work).
void configure_meta_filter(GstBaseTransform* trans);

// Any raw video in system memory, on both pads.
void add_raw_video_pads(GstElementClass* element_class);

// True when the LATENCY query upstream says that the source is live. Streaming thread.
[[nodiscard]] bool upstream_is_live(GstBaseTransform* trans);

}  // namespace calvin::gst
