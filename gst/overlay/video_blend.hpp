// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// GStreamer 1.22's video-blend.h forgets to say that its function is C. The first declaration
// decides: include this before any of GStreamer's headers.
#pragma once

struct _GstVideoFrame;  // NOLINT(bugprone-reserved-identifier)
extern "C" int gst_video_blend(_GstVideoFrame* dest, _GstVideoFrame* src, int x, int y,
                               float global_alpha);
