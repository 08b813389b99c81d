// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Writes the luma plane of plain formats directly, and all others through GStreamer's own packer.

#include "testsrc/luma_writer.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include "common/frames/frame_unpacking.hpp"
#include "common/frames/padded_frame.hpp"

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

// Whether all but the grey levels is one value: in YUV, alpha is not chroma's.
bool is_plain(const GstVideoFormatInfo* f) {
  return GST_VIDEO_FORMAT_INFO_DEPTH(f, 0) == 8 && !needs_unpacking(f) &&
         (GST_VIDEO_FORMAT_INFO_IS_RGB(f) || GST_VIDEO_FORMAT_INFO_N_COMPONENTS(f) <= 3);
}

// By GStreamer's own packer, from lines of alpha and Y U V or R G B of 8 or of 16 bits.
template <typename Sample>
void pack_luma(const GrayImage& picture, GstVideoFrame& frame) {
  constexpr Sample kMost = std::numeric_limits<Sample>::max();
  constexpr std::size_t kSpare = 64;  // packers take groups of pixels
  const GstVideoFormatInfo* f = frame.info.finfo;
  const bool rgb = GST_VIDEO_FORMAT_INFO_IS_RGB(f);
  const auto width = static_cast<std::size_t>(picture.width);
  std::vector<Sample> line(4 * (width + kSpare), static_cast<Sample>(kMost / 2 + 1));
  const std::uint8_t* in = picture.pixels.data();
  for (int y = 0; y < picture.height; ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      const auto level = static_cast<Sample>(*in++ * (kMost / 255));
      Sample* pixel = line.data() + 4 * x;
      pixel[0] = kMost;
      pixel[1] = level;
      if (rgb) pixel[2] = pixel[3] = level;
    }
    f->pack_func(f, GST_VIDEO_PACK_FLAG_NONE, line.data(), 0, frame.data, frame.info.stride,
                 GST_VIDEO_INFO_CHROMA_SITE(&frame.info), y, picture.width);
  }
}

}  // namespace

void write_luma(const GrayImage& picture, GstVideoFrame& frame) {
  const GstVideoFormatInfo* f = frame.info.finfo;
  if (!is_plain(f)) {
    const bool wide = has_wide_lines(f);
    const auto pack = wide ? pack_luma<std::uint16_t> : pack_luma<std::uint8_t>;
    if (!needs_padding(frame.info)) return pack(picture, frame);
    PaddedFrame padded(frame);
    pack(picture, *padded);
    padded.copy_to(frame);
    return;
  }
  const bool rgb = GST_VIDEO_FORMAT_INFO_IS_RGB(f);
  if (GST_VIDEO_FORMAT_INFO_N_COMPONENTS(f) > 1) {
    for (guint plane = 0; plane < GST_VIDEO_FRAME_N_PLANES(&frame); ++plane) {
      fill_plane(frame, plane, rgb ? 255 : kNeutral);
    }
  }
  for (guint component = 0; component < (rgb ? 3U : 1U); ++component) {
    write_component(picture, frame, component);
  }
}

}  // namespace calvin::gst
