// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A GstVideoFrame as the planes that the library's kernels know.

#include "common/frames/frame_planes.hpp"

#include <algorithm>
#include <array>
#include <bit>

#include "common/frames/frame_unpacking.hpp"

namespace calvin::gst {

namespace {

using Values = std::array<gint, GST_VIDEO_MAX_COMPONENTS>;

Subsampling subsampling_of(const FrameFormat& format, guint component) {
  const GstVideoFormatInfo* f = format.info.finfo;
  Subsampling s;
  s.x_shift = static_cast<int>(GST_VIDEO_FORMAT_INFO_W_SUB(f, component));
  s.y_shift = static_cast<int>(GST_VIDEO_FORMAT_INFO_H_SUB(f, component));
  s.x_cosited = s.x_shift > 0 && (format.site & GST_VIDEO_CHROMA_SITE_H_COSITED) != 0;
  s.y_cosited = s.y_shift > 0 && (format.site & GST_VIDEO_CHROMA_SITE_V_COSITED) != 0;
  return s;
}

SampleType sample_type(const GstVideoFormatInfo* f, guint component) {
  if (GST_VIDEO_FORMAT_INFO_DEPTH(f, component) == 8) return SampleType::kU8;
  return GST_VIDEO_FORMAT_INFO_IS_LE(f) ? SampleType::kU16Little : SampleType::kU16Big;
}

// Components of one plane and of one subsampling, in the order in which they lie in memory.
std::vector<std::vector<guint>> groups_of(const FrameFormat& format) {
  const GstVideoFormatInfo* f = format.info.finfo;
  std::vector<std::vector<guint>> groups;
  for (guint c = 0; c < GST_VIDEO_FORMAT_INFO_N_COMPONENTS(f); ++c) {
    const auto same = std::find_if(groups.begin(), groups.end(), [&](const auto& group) {
      const guint other = group.front();
      return GST_VIDEO_FORMAT_INFO_PLANE(f, c) == GST_VIDEO_FORMAT_INFO_PLANE(f, other) &&
             subsampling_of(format, c) == subsampling_of(format, other);
    });
    if (same == groups.end()) {
      groups.push_back({c});
    } else {
      same->push_back(c);
    }
  }
  for (std::vector<guint>& group : groups) {
    std::sort(group.begin(), group.end(), [f](guint a, guint b) {
      return GST_VIDEO_FORMAT_INFO_POFFSET(f, a) < GST_VIDEO_FORMAT_INFO_POFFSET(f, b);
    });
  }
  return groups;
}

// Black, and 1 for alpha.
Values fill_of(const GstVideoInfo& info) {
  Values offsets{};
  Values scales{};
  gst_video_color_range_offsets(info.colorimetry.range, info.finfo, offsets.data(), scales.data());
  // Some formats have it and do not say so. Where there is none, nobody asks.
  offsets[GST_VIDEO_COMP_A] = scales[GST_VIDEO_COMP_A];
  return offsets;
}

// Where the components begin, and how far each is from the next.
void place(const GstVideoFormatInfo* f, const std::vector<guint>& components, FramePlane& joined) {
  PlaneLayout& layout = joined.layout;
  const guint first = components.front();
  const std::ptrdiff_t bytes = layout.sample == SampleType::kU8 ? 1 : 2;
  layout.pixel_step = GST_VIDEO_FORMAT_INFO_PSTRIDE(f, first);
  layout.shift = static_cast<int>(GST_VIDEO_FORMAT_INFO_SHIFT(f, first));
  if (layout.pixel_step == bytes * layout.components) {
    // Nothing between them: GStreamer's table counts the offsets of P010 in samples.
    layout.component_step = bytes;
    return;
  }
  joined.offset = static_cast<guint>(GST_VIDEO_FORMAT_INFO_POFFSET(f, first));
  if (components.size() > 1) {
    layout.component_step =
        GST_VIDEO_FORMAT_INFO_POFFSET(f, components[1]) - GST_VIDEO_FORMAT_INFO_POFFSET(f, first);
  }
}

// The byte of RGBx or xRGB that has no name is carried along.
void add_unnamed(FramePlane& joined) {
  PlaneLayout& layout = joined.layout;
  if (layout.pixel_step != 4 || layout.components != 3) return;
  layout.components = 4;
  layout.fill[3] = 255;
  if (joined.offset == 0) return;
  std::rotate(layout.fill.begin(), layout.fill.begin() + 3, layout.fill.end());
  joined.offset = 0;
}

// The siting of frames whose caps say nothing of it. Only from caps does GstVideoInfo get it in
// every version: gst_video_info_set_format() of 1.26 leaves it unknown.
GstVideoChromaSite default_site(const GstVideoInfo& info) {
  g_autoptr(GstCaps) plain = gst_caps_new_simple(
      "video/x-raw", "format", G_TYPE_STRING, GST_VIDEO_INFO_NAME(&info), "width", G_TYPE_INT,
      GST_VIDEO_INFO_WIDTH(&info), "height", G_TYPE_INT, GST_VIDEO_INFO_HEIGHT(&info), nullptr);
  GstVideoInfo read;
  return gst_video_info_from_caps(&read, plain) ? GST_VIDEO_INFO_CHROMA_SITE(&read)
                                                : GST_VIDEO_CHROMA_SITE_UNKNOWN;
}

// A plane of one component, wherever it lies.
FramePlane plane_for(const FrameFormat& in, const FrameFormat& out, guint component, gint fill) {
  FramePlane plane;
  plane.layout.subsampling = subsampling_of(in, component);
  plane.layout.output_subsampling = subsampling_of(out, component);
  plane.layout.bits = static_cast<int>(GST_VIDEO_FORMAT_INFO_DEPTH(in.info.finfo, component));
  plane.layout.fill[0] = static_cast<std::uint16_t>(fill);
  return plane;
}

// The planes of an UnpackedFrame.
std::vector<FramePlane> unpacked_planes(const FrameFormat& in, const FrameFormat& out,
                                        const Values& fill) {
  constexpr bool kBig = std::endian::native == std::endian::big;
  std::vector<FramePlane> planes;
  for (guint c = 0; c < GST_VIDEO_FORMAT_INFO_N_COMPONENTS(in.info.finfo); ++c) {
    FramePlane plane = plane_for(in, out, c, fill[c]);
    plane.plane = c;
    plane.layout.sample = kBig ? SampleType::kU16Big : SampleType::kU16Little;
    plane.layout.pixel_step = plane.layout.component_step = sizeof(std::uint16_t);
    planes.push_back(plane);
  }
  return planes;
}

}  // namespace

FrameFormat::FrameFormat(const GstVideoInfo& video, const GstCaps* caps) : info(video) {
  const char* said = gst_structure_get_string(gst_caps_get_structure(caps, 0), "chroma-site");
  if (said != nullptr) site = gst_video_chroma_site_from_string(said);
  if (site == GST_VIDEO_CHROMA_SITE_UNKNOWN) site = default_site(video);
}

bool FrameFormat::same_places(const FrameFormat& other) const {
  if (size() != other.size()) return false;
  for (guint c = 0; c < GST_VIDEO_FORMAT_INFO_N_COMPONENTS(info.finfo); ++c) {
    if (subsampling_of(*this, c) != subsampling_of(other, c)) return false;
  }
  return true;
}

std::vector<FramePlane> planes_of(const FrameFormat& in, const FrameFormat& out) {
  const GstVideoFormatInfo* f = in.info.finfo;
  const Values fill = fill_of(out.info);
  if (needs_unpacking(f)) return unpacked_planes(in, out, fill);
  std::vector<FramePlane> planes;
  for (const std::vector<guint>& group : groups_of(in)) {
    const guint first = group.front();
    FramePlane joined = plane_for(in, out, first, fill[first]);
    joined.plane = static_cast<guint>(GST_VIDEO_FORMAT_INFO_PLANE(f, first));
    PlaneLayout& layout = joined.layout;
    layout.components = static_cast<int>(group.size());
    layout.sample = sample_type(f, first);
    for (std::size_t i = 0; i < group.size(); ++i) {
      layout.fill[i] = static_cast<std::uint16_t>(fill[group[i]]);
    }
    place(f, group, joined);
    if (GST_VIDEO_FORMAT_INFO_IS_RGB(f)) add_unnamed(joined);
    planes.push_back(joined);
  }
  return planes;
}

PlaneMemory<std::uint8_t> memory_of(const GstVideoFrame& frame, const FramePlane& plane) {
  auto* data = static_cast<std::uint8_t*>(GST_VIDEO_FRAME_PLANE_DATA(&frame, plane.plane));
  return {data + plane.offset, GST_VIDEO_FRAME_PLANE_STRIDE(&frame, plane.plane)};
}

}  // namespace calvin::gst
