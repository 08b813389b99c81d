// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Frames in DMA memory. From GStreamer 1.24 on their caps have the format DMA_DRM and tell in
// `drm-format` what the kernel calls it. A linear one, whose name has no modifier, is mapped and
// read like any other frame; here are its caps as those of system memory, and back. What is tiled
// is left out. Before 1.24 there are no such caps, and these functions change nothing.
#pragma once

#include <gst/base/gstbasetransform.h>
#include <gst/video/video.h>

namespace calvin::gst {

// Of the frames of fixed caps as they are mapped. False where they have no such format.
[[nodiscard]] bool video_info_of(GstVideoInfo& info, const GstCaps* caps);

// A copy in which frames in DMA memory are said to be in system memory.
[[nodiscard]] GstCaps* mapped_caps(const GstCaps* caps);

// Appends the same frames in DMA memory. Takes the caps.
[[nodiscard]] GstCaps* with_dma_caps(GstCaps* caps);

// For GstBaseTransformClass::transform_caps of an element that hands on the memory that it gets:
// frames in DMA memory go out as such, or as system memory.
GstCaps* share_memory_transform_caps(GstBaseTransform* trans, GstPadDirection direction,
                                     GstCaps* caps, GstCaps* filter);
// The same of an element that may have to hand on other memory: always system memory.
GstCaps* map_memory_transform_caps(GstBaseTransform* trans, GstPadDirection direction,
                                   GstCaps* caps, GstCaps* filter);

// For GstBaseTransformClass::set_caps of a class derived directly from GstVideoFilter, which knows
// no frames in DMA memory: it gets the caps of frames as they are mapped.
gboolean set_mapped_caps(GstBaseTransform* trans, GstCaps* in, GstCaps* out);

// For GstBaseTransformClass::get_unit_size.
gboolean mapped_unit_size(GstBaseTransform* trans, GstCaps* caps, gsize* size);

}  // namespace calvin::gst
