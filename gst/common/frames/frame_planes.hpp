// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A GstVideoFrame as the planes that the library's kernels know.
#pragma once

#include <vector>

#include <gst/video/video.h>

#include "calvin/remap/map/plane_layout.hpp"

namespace calvin::gst {

// Those that newer versions of GStreamer have besides, without MT2110T and MT2110R: their last
// column is lost where the width is odd.
#if GST_CHECK_VERSION(1, 24, 0)
#define CALVIN_PLANE_FORMATS_1_24                                                          \
  ", A422, A444, RBGA, A420_12LE, A420_12BE, A422_12LE, A422_12BE, A444_12LE, A444_12BE, " \
  "A420_16LE, A420_16BE, A422_16LE, A422_16BE, A444_16LE, A444_16BE, GBR_16LE, GBR_16BE, " \
  "NV12_10LE40_4L4"
#else
#define CALVIN_PLANE_FORMATS_1_24 ""
#endif
#if GST_CHECK_VERSION(1, 26, 0)
#define CALVIN_PLANE_FORMATS_1_26 ", GRAY10_LE16, Y216_LE, Y216_BE, Y416_LE, Y416_BE"
#else
#define CALVIN_PLANE_FORMATS_1_26 ""
#endif

// The formats that planes_of() knows, for GST_VIDEO_CAPS_MAKE: all but those with a palette, whose
// numbers have nothing between them. What is usual comes first.
#define CALVIN_PLANE_FORMATS                                                                      \
  "{ I420, NV12, YUY2, BGRx, GRAY8, YV12, NV21, UYVY, YVYU, VYUY, Y42B, NV16, NV61, Y444, NV24, " \
  "AYUV, I420_10LE, P010_10LE, I422_10LE, Y444_10LE, GRAY16_LE, GRAY16_BE, RGB, BGR, RGBx, "      \
  "xRGB, xBGR, RGBA, BGRA, ARGB, ABGR, "                                                          \
  "VUYA, v308, IYU2, Y41B, YUV9, YVU9, A420, AV12, RGBP, BGRP, GBR, GBRA, "                       \
  "I420_10BE, I422_10BE, Y444_10BE, P010_10BE, GBR_10LE, GBR_10BE, GBRA_10LE, GBRA_10BE, "        \
  "A420_10LE, A420_10BE, A422_10LE, A422_10BE, A444_10LE, A444_10BE, Y210, "                      \
  "I420_12LE, I420_12BE, I422_12LE, I422_12BE, Y444_12LE, Y444_12BE, P012_LE, P012_BE, "          \
  "GBR_12LE, GBR_12BE, GBRA_12LE, GBRA_12BE, Y212_LE, Y212_BE, Y412_LE, Y412_BE, "                \
  "P016_LE, P016_BE, Y444_16LE, Y444_16BE, v216, AYUV64, ARGB64, ARGB64_LE, ARGB64_BE, "          \
  "ABGR64_LE, ABGR64_BE, RGBA64_LE, RGBA64_BE, BGRA64_LE, BGRA64_BE, "                            \
  "v210, UYVP, GRAY10_LE32, NV12_10LE32, NV16_10LE32, NV12_10LE40, Y410, r210, RGB10A2_LE, "      \
  "BGR10A2_LE, RGB16, BGR16, RGB15, BGR15, IYU1, NV12_4L4, NV12_32L32, NV12_16L32S, NV12_64Z32, " \
  "NV12_8L128, NV12_10BE_8L128" CALVIN_PLANE_FORMATS_1_24 CALVIN_PLANE_FORMATS_1_26 " }"

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
  guint plane = 0;   // of the GstVideoFrame, or of the UnpackedFrame where the format needs that
  guint offset = 0;  // of the first component, bytes
};

// All samples of frames of a format, and the fill for places that nobody has seen: black in the
// range of the output, opaque.
[[nodiscard]] std::vector<FramePlane> planes_of(const FrameFormat& in, const FrameFormat& out);

// Where the plane begins in a mapped frame.
[[nodiscard]] PlaneMemory<std::uint8_t> memory_of(const GstVideoFrame& frame,
                                                  const FramePlane& plane);

}  // namespace calvin::gst
