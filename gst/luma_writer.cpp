// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#include "luma_writer.hpp"

#include <algorithm>

namespace calvin::gst {

namespace {

constexpr std::uint8_t kNeutral = 128;

// Everything that is not luma, and the padding of packed formats.
void fill_plane(GstVideoFrame& frame, guint plane, std::uint8_t value) {
  auto* data = static_cast<std::uint8_t*>(GST_VIDEO_FRAME_PLANE_DATA(&frame, plane));
  const std::ptrdiff_t stride = GST_VIDEO_FRAME_PLANE_STRIDE(&frame, plane);
  const int height = GST_VIDEO_FRAME_COMP_HEIGHT(&frame, plane);
  for (int y = 0; y < height; ++y) std::fill_n(data + y * stride, stride, value);
}

void write_component(const GrayImage& picture, GstVideoFrame& frame, guint component) {
  auto* data = static_cast<std::uint8_t*>(GST_VIDEO_FRAME_COMP_DATA(&frame, component));
  const std::ptrdiff_t stride = GST_VIDEO_FRAME_COMP_STRIDE(&frame, component);
  const std::ptrdiff_t step = GST_VIDEO_FRAME_COMP_PSTRIDE(&frame, component);
  const std::uint8_t* in = picture.pixels.data();
  for (int y = 0; y < picture.height; ++y) {
    std::uint8_t* out = data + y * stride;
    for (int x = 0; x < picture.width; ++x, out += step) *out = *in++;
  }
}

}  // namespace

void write_luma(const GrayImage& picture, GstVideoFrame& frame) {
  const bool rgb = GST_VIDEO_FORMAT_INFO_IS_RGB(frame.info.finfo);
  if (GST_VIDEO_FORMAT_INFO_N_COMPONENTS(frame.info.finfo) > 1) {
    for (guint plane = 0; plane < GST_VIDEO_FRAME_N_PLANES(&frame); ++plane) {
      fill_plane(frame, plane, rgb ? 255 : kNeutral);
    }
  }
  for (guint component = 0; component < (rgb ? 3U : 1U); ++component) {
    write_component(picture, frame, component);
  }
}

}  // namespace calvin::gst
