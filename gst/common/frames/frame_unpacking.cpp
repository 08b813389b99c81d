// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Frames whose samples the kernels cannot read where they lie, as planes that they can.

#include "common/frames/frame_unpacking.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace calvin::gst {

namespace {

// GStreamer's functions take pixels by small groups, and the last group may go beyond the line.
constexpr std::size_t kSpare = 64;
constexpr std::size_t kSamples = 4;  // of a pixel in an unpacked line

// A line as GStreamer unpacks it: alpha, then R G B or Y U V, at full size.
template <typename Sample>
std::vector<Sample> new_line(int width) {
  // What a format has no component for is opaque and without colour.
  return std::vector<Sample>(kSamples * (static_cast<std::size_t>(width) + kSpare),
                             static_cast<Sample>(1) << (std::numeric_limits<Sample>::digits - 1));
}

}  // namespace

bool needs_unpacking(const GstVideoFormatInfo* format) {
  const bool lone_words = GST_VIDEO_FORMAT_INFO_DEPTH(format, 0) != 8 &&
                          GST_VIDEO_FORMAT_INFO_N_COMPONENTS(format) >= 3 &&
                          GST_VIDEO_FORMAT_INFO_N_PLANES(format) == 1;
  // IYU1 has no place per pixel, and does not say that it is complex.
  return lone_words || GST_VIDEO_FORMAT_INFO_PSTRIDE(format, 0) == 0 ||
         GST_VIDEO_FORMAT_INFO_IS_COMPLEX(format) || GST_VIDEO_FORMAT_INFO_IS_TILED(format);
}

bool has_wide_lines(const GstVideoFormatInfo* format) {
  return format->unpack_format == GST_VIDEO_FORMAT_AYUV64 ||
         format->unpack_format == GST_VIDEO_FORMAT_ARGB64;
}

bool can_pack_into(const GstVideoFrame& frame) {
  const auto unit =
      static_cast<std::uintptr_t>(std::max(GST_VIDEO_FORMAT_INFO_PSTRIDE(frame.info.finfo, 0), 1));
  for (guint p = 0; p < GST_VIDEO_FRAME_N_PLANES(&frame); ++p) {
    const auto begin = reinterpret_cast<std::uintptr_t>(GST_VIDEO_FRAME_PLANE_DATA(&frame, p));
    const auto stride = static_cast<std::uintptr_t>(GST_VIDEO_FRAME_PLANE_STRIDE(&frame, p));
    if (begin % unit != 0 || stride % unit != 0) return false;
  }
  return true;
}

UnpackedFrame::UnpackedFrame(const GstVideoInfo& info)
    : format_(info.finfo),
      width_(GST_VIDEO_INFO_WIDTH(&info)),
      height_(GST_VIDEO_INFO_HEIGHT(&info)),
      has_wide_lines_(has_wide_lines(format_)) {
  const int sample_bits = has_wide_lines_ ? 16 : 8;
  for (guint c = 0; c < GST_VIDEO_FORMAT_INFO_N_COMPONENTS(format_); ++c) {
    Plane plane;
    plane.width = GST_VIDEO_INFO_COMP_WIDTH(&info, c);
    plane.x_shift = static_cast<int>(GST_VIDEO_FORMAT_INFO_W_SUB(format_, c));
    plane.y_shift = static_cast<int>(GST_VIDEO_FORMAT_INFO_H_SUB(format_, c));
    plane.spare_bits = sample_bits - static_cast<int>(GST_VIDEO_FORMAT_INFO_DEPTH(format_, c));
    plane.first = c == GST_VIDEO_COMP_A ? 0 : c + 1;
    const int rows = GST_VIDEO_INFO_COMP_HEIGHT(&info, c);
    plane.words.resize(static_cast<std::size_t>(plane.width) * static_cast<std::size_t>(rows));
    planes_.push_back(std::move(plane));
  }
}

PlaneMemory<std::uint8_t> UnpackedFrame::plane(guint component) {
  Plane& plane = planes_[component];
  return {reinterpret_cast<std::uint8_t*>(plane.words.data()),
          static_cast<std::ptrdiff_t>(sizeof(std::uint16_t)) * plane.width};
}

// Rows that share chroma stay together.
int UnpackedFrame::row_of(int part, int parts) const {
  constexpr std::int64_t kTogether = 4;
  const std::int64_t groups = (height_ + kTogether - 1) / kTogether;
  return static_cast<int>(std::min<std::int64_t>(groups * part / parts * kTogether, height_));
}

template <typename Sample>
void UnpackedFrame::unpack_rows(const GstVideoFrame& frame, int begin, int end) {
  std::vector<Sample> line = new_line<Sample>(width_);
  for (int y = begin; y < end; ++y) {
    format_->unpack_func(format_, GST_VIDEO_PACK_FLAG_TRUNCATE_RANGE, line.data(), frame.data,
                         frame.info.stride, 0, y, width_);
    for (Plane& plane : planes_) {
      if (y % (1 << plane.y_shift) != 0) continue;
      std::uint16_t* to = plane.row(y);
      const Sample* from = line.data() + plane.first;
      const std::size_t step = kSamples << plane.x_shift;
      for (int x = 0; x < plane.width; ++x, from += step) {
        to[x] = static_cast<std::uint16_t>(*from >> plane.spare_bits);
      }
    }
  }
}

template <typename Sample>
void UnpackedFrame::pack_rows(const GstVideoFrame& frame, int begin, int end) const {
  std::vector<Sample> line = new_line<Sample>(width_);
  for (int y = begin; y < end; ++y) {
    for (const Plane& plane : planes_) {
      const std::uint16_t* from = plane.row(y);
      Sample* to = line.data() + plane.first;
      for (int x = 0; x < width_; ++x, to += kSamples) {
        *to = static_cast<Sample>(from[x >> plane.x_shift] << plane.spare_bits);
      }
    }
    format_->pack_func(format_, GST_VIDEO_PACK_FLAG_TRUNCATE_RANGE, line.data(), 0,
                       const_cast<gpointer*>(frame.data), frame.info.stride,
                       GST_VIDEO_INFO_CHROMA_SITE(&frame.info), y, width_);
  }
}

void UnpackedFrame::unpack(const GstVideoFrame& frame, int part, int parts) {
  const int begin = row_of(part, parts);
  const int end = row_of(part + 1, parts);
  has_wide_lines_ ? unpack_rows<std::uint16_t>(frame, begin, end)
                  : unpack_rows<std::uint8_t>(frame, begin, end);
}

void UnpackedFrame::pack(const GstVideoFrame& frame, int part, int parts) const {
  const int begin = row_of(part, parts);
  const int end = row_of(part + 1, parts);
  has_wide_lines_ ? pack_rows<std::uint16_t>(frame, begin, end)
                  : pack_rows<std::uint8_t>(frame, begin, end);
}

}  // namespace calvin::gst
