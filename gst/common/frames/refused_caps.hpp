// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a user reads when the neighbour upstream sends what an element cannot take.
#pragma once

#include <optional>

#include <gst/gst.h>
#include <gst/video/video.h>

#include "calvin/core/result.hpp"

namespace calvin::gst {

// Why none of `caps` fits `accepted`, the template of a raw video pad, and what to insert. Absent
// where something fits. `set`: the caps are of frames that will come, not of some that may.
[[nodiscard]] std::optional<Error> explain_refusal(const GstCaps* caps, const GstCaps* accepted,
                                                   bool set);

// What interlaced video does to the corners of a board, and what to insert; absent for video that
// is progressive, and for mixed video, of which each frame says what it is and most are
// progressive.
[[nodiscard]] std::optional<Error> explain_fields(const GstVideoInfo& info);

// GStreamer refuses such caps before an element sees them and tells the user no more than
// "not-negotiated". From here on the sink pad of `element` posts the error, when such caps are
// set and when upstream has no others. Call it once, in init.
void explain_refused_caps(GstElement* element);

}  // namespace calvin::gst
