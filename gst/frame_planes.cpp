// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A GstVideoFrame as the planes that the library's kernels know.

#include "frame_planes.hpp"

#include <algorithm>

namespace calvin::gst {

namespace {

Subsampling subsampling_of(const GstVideoInfo& info, guint component) {
  Subsampling s;
  s.x_shift = static_cast<int>(GST_VIDEO_FORMAT_INFO_W_SUB(info.finfo, component));
  s.y_shift = static_cast<int>(GST_VIDEO_FORMAT_INFO_H_SUB(info.finfo, component));
  const auto site = GST_VIDEO_INFO_CHROMA_SITE(&info) == GST_VIDEO_CHROMA_SITE_UNKNOWN
                        ? GST_VIDEO_CHROMA_SITE_MPEG2
                        : GST_VIDEO_INFO_CHROMA_SITE(&info);
  s.x_cosited = s.x_shift > 0 && (site & GST_VIDEO_CHROMA_SITE_H_COSITED) != 0;
  s.y_cosited = s.y_shift > 0 && (site & GST_VIDEO_CHROMA_SITE_V_COSITED) != 0;
  return s;
}

// The layout of components that are listed in the order of their bytes.
FramePlane join(const GstVideoInfo& info, const std::vector<guint>& components,
                const std::array<gint, GST_VIDEO_MAX_COMPONENTS>& black) {
  const GstVideoFormatInfo* f = info.finfo;
  const guint first = components.front();
  FramePlane joined;
  joined.plane = static_cast<guint>(GST_VIDEO_FORMAT_INFO_PLANE(f, first));
  joined.offset = static_cast<guint>(GST_VIDEO_FORMAT_INFO_POFFSET(f, first));
  PlaneLayout& layout = joined.layout;
  layout.subsampling = subsampling_of(info, first);
  layout.pixel_step = GST_VIDEO_FORMAT_INFO_PSTRIDE(f, first);
  layout.components = static_cast<int>(components.size());
  if (components.size() > 1) {
    layout.component_step =
        GST_VIDEO_FORMAT_INFO_POFFSET(f, components[1]) - GST_VIDEO_FORMAT_INFO_POFFSET(f, first);
  }
  layout.fill.fill(255);
  for (std::size_t i = 0; i < components.size(); ++i) {
    layout.fill[i] = static_cast<std::uint8_t>(black[components[i]]);
  }
  // The byte of BGRx that has no name is carried along.
  if (GST_VIDEO_FORMAT_INFO_IS_RGB(f) && layout.pixel_step == 4 && layout.components == 3 &&
      joined.offset == 0) {
    layout.components = 4;
  }
  return joined;
}

}  // namespace

std::vector<FramePlane> planes_of(const GstVideoInfo& info) {
  const GstVideoFormatInfo* f = info.finfo;
  std::array<gint, GST_VIDEO_MAX_COMPONENTS> black{};
  std::array<gint, GST_VIDEO_MAX_COMPONENTS> scale{};
  gst_video_color_range_offsets(info.colorimetry.range, f, black.data(), scale.data());
  std::vector<std::vector<guint>> groups;
  const guint count = GST_VIDEO_FORMAT_INFO_N_COMPONENTS(f);
  for (guint c = 0; c < count; ++c) {
    const auto same = std::find_if(groups.begin(), groups.end(), [&](const auto& group) {
      const guint other = group.front();
      return GST_VIDEO_FORMAT_INFO_PLANE(f, c) == GST_VIDEO_FORMAT_INFO_PLANE(f, other) &&
             subsampling_of(info, c) == subsampling_of(info, other);
    });
    if (same == groups.end()) {
      groups.push_back({c});
    } else {
      same->push_back(c);
    }
  }
  std::vector<FramePlane> planes;
  for (std::vector<guint>& group : groups) {
    std::sort(group.begin(), group.end(), [f](guint a, guint b) {
      return GST_VIDEO_FORMAT_INFO_POFFSET(f, a) < GST_VIDEO_FORMAT_INFO_POFFSET(f, b);
    });
    planes.push_back(join(info, group, black));
  }
  return planes;
}

PlaneMemory<std::uint8_t> memory_of(const GstVideoFrame& frame, const FramePlane& plane) {
  auto* data = static_cast<std::uint8_t*>(GST_VIDEO_FRAME_PLANE_DATA(&frame, plane.plane));
  return {data + plane.offset, GST_VIDEO_FRAME_PLANE_STRIDE(&frame, plane.plane)};
}

}  // namespace calvin::gst
