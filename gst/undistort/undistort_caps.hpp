// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How calibundistort negotiates: the same frames, or else frames of another size.
#pragma once

#include <gst/base/gstbasetransform.h>

#include "calvin/core/result.hpp"
#include "common/frames/frame_planes.hpp"

namespace calvin::gst {

// For GstBaseTransformClass: the same caps first, then those with any size and chroma siting.
GstCaps* undistort_transform_caps(GstBaseTransform* trans, GstPadDirection direction, GstCaps* caps,
                                  GstCaps* filter);

// For GstBaseTransformClass: the size of the input, or the one nearest to it, with its aspect where
// the other side leaves a choice. Pixels keep their shape, colours and chroma their meaning: what
// the input's caps leave to the number of lines is said where the output has another one.
GstCaps* undistort_fixate_caps(GstBaseTransform* trans, GstPadDirection direction, GstCaps* caps,
                               GstCaps* othercaps);

// Whether frames of the one kind can be made into frames of the other without a calibration: as
// they are, or scaled.
[[nodiscard]] Status check_move(const FrameFormat& in, const FrameFormat& out);

void add_undistort_pads(GstElementClass* element_class);

}  // namespace calvin::gst
