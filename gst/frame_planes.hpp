// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A GstVideoFrame as the planes that the library's kernels know.
#pragma once

#include <vector>

#include <gst/video/video.h>

#include "calvin/remap/kernel.hpp"

namespace calvin::gst {

// The formats that planes_of() knows, for GST_VIDEO_CAPS_MAKE.
#define CALVIN_PLANE_FORMATS                                                                 \
  "{ GRAY8, I420, YV12, NV12, NV21, YUY2, UYVY, YVYU, VYUY, Y42B, NV16, NV61, Y444, NV24, "  \
  "AYUV, I420_10LE, P010_10LE, I422_10LE, Y444_10LE, GRAY16_LE, GRAY16_BE, RGB, BGR, RGBx, " \
  "BGRx, xRGB, xBGR, RGBA, BGRA, ARGB, ABGR }"

// What frames are, with their true siting.
struct FrameFormat {
  GstVideoInfo info{};
  GstVideoChromaSite site = GST_VIDEO_CHROMA_SITE_UNKNOWN;

  FrameFormat() = default;
  // `chroma-site` of the caps, which GstVideoInfo 1.22 forgets where they say no colorimetry. Caps
  // without one have GStreamer's default: JPEG up to 576 lines, MPEG-2 above.
  FrameFormat(const GstVideoInfo& video, const GstCaps* caps);

  [[nodiscard]] ImageSize size() const {
    return {GST_VIDEO_INFO_WIDTH(&info), GST_VIDEO_INFO_HEIGHT(&info)};
  }
  friend bool operator==(const FrameFormat& a, const FrameFormat& b) {
    return a.site == b.site && gst_video_info_is_equal(&a.info, &b.info);
  }
  // Whether every sample of a frame of the one has its place in a frame of the other.
  [[nodiscard]] bool same_places(const FrameFormat& other) const;
};

// Whether frames show a picture that can be moved: a view of one column has no width.
[[nodiscard]] inline bool has_extent(ImageSize size) { return size.width > 1 && size.height > 1; }

// Components that share their places in one plane of a frame.
struct FramePlane {
  PlaneLayout layout;
  guint plane = 0;   // of the GstVideoFrame
  guint offset = 0;  // of the first component, bytes
};

// All samples of frames of a format, and the fill for places that nobody has seen: black in the
// range of the output, opaque.
[[nodiscard]] std::vector<FramePlane> planes_of(const FrameFormat& in, const FrameFormat& out);

// Where the plane begins in a mapped frame.
[[nodiscard]] PlaneMemory<std::uint8_t> memory_of(const GstVideoFrame& frame,
                                                  const FramePlane& plane);

}  // namespace calvin::gst
