// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Whether a buffer holds the picture that its caps promise.

#include "common/frames/mapped_frame.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>

#include <fmt/format.h>

#include "common/frames/frame_unpacking.hpp"
#include "common/frames/padded_frame.hpp"

namespace calvin::gst {

namespace {

constexpr char kAdvice[] = "Check the element upstream, it sends frames other than its caps say.";

// Whether every pixel of a component lies in the memory that is mapped for its plane, with all of
// its bytes: kernels move those without a name too, and GStreamer pixels that share chroma
// together.
bool component_fits(const GstVideoFrame& frame, guint c) {
  const GstVideoFormatInfo* f = frame.info.finfo;
  const auto plane = static_cast<guint>(GST_VIDEO_FORMAT_INFO_PLANE(f, c));
  const std::int64_t rows = GST_VIDEO_FRAME_COMP_HEIGHT(&frame, c);
  const std::int64_t columns = GST_VIDEO_FRAME_COMP_WIDTH(&frame, c);
  const std::int64_t row_end = columns * GST_VIDEO_FORMAT_INFO_PSTRIDE(f, c);
  const std::int64_t last = (rows - 1) * GST_VIDEO_FRAME_PLANE_STRIDE(&frame, plane);
  const GstMapInfo& map = frame.map[frame.meta == nullptr ? 0 : plane];
  const std::int64_t first = static_cast<const guint8*>(frame.data[plane]) - map.data;
  return first + std::min<std::int64_t>(last, 0) >= 0 &&
         first + std::max<std::int64_t>(last, 0) + row_end <= static_cast<std::int64_t>(map.size);
}

// The same of what has no place of its own per sample: a plane of groups of pixels or of tiles has
// at least the rows, or tiles, that GStreamer gives it.
bool plane_fits(const GstVideoFrame& frame, const GstVideoInfo& plain, guint p) {
  const auto bytes = plane_bytes(frame.info, plain, p);
  if (!bytes) return false;
  const GstMapInfo& map = frame.map[frame.meta == nullptr ? 0 : p];
  const std::int64_t first = static_cast<const guint8*>(frame.data[p]) - map.data;
  return first >= 0 && first + *bytes <= static_cast<std::int64_t>(map.size);
}

// The colours of a palette are a plane of their own.
bool palette_fits(const GstVideoFrame& frame) {
  constexpr std::int64_t kBytes = 256 * 4;
  const GstMapInfo& map = frame.map[frame.meta == nullptr ? 0 : 1];
  const std::int64_t first = static_cast<const guint8*>(frame.data[1]) - map.data;
  return first >= 0 && first + kBytes <= static_cast<std::int64_t>(map.size);
}

bool all_fits(const GstVideoFrame& frame, const GstVideoInfo& plain) {
  const GstVideoFormatInfo* f = frame.info.finfo;
  if (GST_VIDEO_FORMAT_INFO_HAS_PALETTE(f)) return component_fits(frame, 0) && palette_fits(frame);
  if (needs_unpacking(f) &&
      (GST_VIDEO_FORMAT_INFO_IS_TILED(f) || GST_VIDEO_FORMAT_INFO_PSTRIDE(f, 0) == 0)) {
    for (guint p = 0; p < GST_VIDEO_FRAME_N_PLANES(&frame); ++p) {
      if (!plane_fits(frame, plain, p)) return false;
    }
    return true;
  }
  for (guint c = 0; c < GST_VIDEO_FRAME_N_COMPONENTS(&frame); ++c) {
    if (!component_fits(frame, c)) return false;
  }
  return true;
}

tl::unexpected<Error> beyond_memory() {
  return make_error(ErrorCode::kMalformed,
                    fmt::format("The rows of a frame reach beyond its memory. {}", kAdvice));
}

// The number in a meta that any program may have written, and that need not be one of a format.
int format_of(const GstVideoMeta& meta) {
  int number = 0;
  static_assert(sizeof(number) == sizeof(meta.format));
  std::memcpy(&number, &meta.format, sizeof(number));
  return number;
}

// GStreamer answers UNKNOWN by a CRITICAL, and 1.26, unlike 1.22, every number that is no format.
// Its enumeration tells which numbers are formats.
const char* name_of(int format) {
  g_autoptr(GEnumClass) formats = static_cast<GEnumClass*>(g_type_class_ref(GST_TYPE_VIDEO_FORMAT));
  const bool known =
      format != GST_VIDEO_FORMAT_UNKNOWN && g_enum_get_value(formats, format) != nullptr;
  return known ? gst_video_format_to_string(static_cast<GstVideoFormat>(format)) : "UNKNOWN";
}

// Whether a plane begins where the buffer has no memory any more.
bool begins_beyond(const GstVideoMeta& meta, gsize size) {
  return std::any_of(meta.offset, meta.offset + meta.n_planes,
                     [size](gsize offset) { return offset >= size; });
}

// Why a frame could not be mapped: there is too little of it, or its memory gives no access.
tl::unexpected<Error> unmapped(const GstVideoInfo& info, GstBuffer* buffer, GstMapFlags access) {
  const gsize size = gst_buffer_get_size(buffer);
  if (size < info.size) {
    return make_error(ErrorCode::kMalformed,
                      fmt::format("A frame has {} bytes, but {} of {}x{} px needs {}. {}", size,
                                  GST_VIDEO_INFO_NAME(&info), GST_VIDEO_INFO_WIDTH(&info),
                                  GST_VIDEO_INFO_HEIGHT(&info), info.size, kAdvice));
  }
  const GstVideoMeta* meta = gst_buffer_get_video_meta(buffer);
  if (meta != nullptr && begins_beyond(*meta, size)) return beyond_memory();
  if ((access & GST_MAP_READWRITE) == GST_MAP_READWRITE) {
    return make_error(ErrorCode::kUnsupported,
                      "The memory of a frame can be neither written nor copied: the system gives "
                      "no access to it, or somebody else is using it. Have the element upstream "
                      "send frames in system memory, v4l2src for example with io-mode=mmap.");
  }
  if ((access & GST_MAP_WRITE) != 0) {
    return make_error(ErrorCode::kUnsupported,
                      "The memory of a frame cannot be written: the system gives no access to it, "
                      "or somebody else is using it. Insert identity drop-allocation=true behind "
                      "this element, so that it writes into memory of its own.");
  }
  return make_error(ErrorCode::kUnsupported,
                    "The memory of a frame cannot be read: the system gives no access to it, or "
                    "somebody is writing to it. Have the element upstream send frames in system "
                    "memory, v4l2src for example with io-mode=mmap.");
}

// gst_video_frame_map() takes these on trust, or for a mistake of the program.
Status check(const GstVideoMeta& meta, const GstVideoInfo& info) {
  if (format_of(meta) != GST_VIDEO_INFO_FORMAT(&info) ||
      meta.width != static_cast<guint>(GST_VIDEO_INFO_WIDTH(&info)) ||
      meta.height != static_cast<guint>(GST_VIDEO_INFO_HEIGHT(&info))) {
    return make_error(
        ErrorCode::kMalformed,
        fmt::format("A frame is {} of {}x{} px, but {} of {}x{} was negotiated. {}",
                    name_of(format_of(meta)), meta.width, meta.height, GST_VIDEO_INFO_NAME(&info),
                    GST_VIDEO_INFO_WIDTH(&info), GST_VIDEO_INFO_HEIGHT(&info), kAdvice));
  }
  if (meta.n_planes != GST_VIDEO_INFO_N_PLANES(&info)) {
    return make_error(
        ErrorCode::kMalformed,
        fmt::format("The GstVideoMeta of a frame tells of {} planes, but {} has {}. {}",
                    meta.n_planes, GST_VIDEO_INFO_NAME(&info), GST_VIDEO_INFO_N_PLANES(&info),
                    kAdvice));
  }
  if (meta.map == nullptr || meta.unmap == nullptr || meta.buffer == nullptr) {
    return make_error(ErrorCode::kMalformed,
                      "The GstVideoMeta of a frame does not tell how to map it. Check the element "
                      "upstream: gst_buffer_add_video_meta() makes one that does.");
  }
  return {};
}

}  // namespace

Result<MappedFrame> MappedFrame::map(const GstVideoInfo& info, GstBuffer* buffer,
                                     GstMapFlags access) {
  if (const GstVideoMeta* meta = gst_buffer_get_video_meta(buffer); meta != nullptr) {
    if (Status said = check(*meta, info); !said) return tl::unexpected<Error>(said.error());
  }
  MappedFrame frame;
  frame.mapped_ = gst_video_frame_map(&frame.frame_, &info, buffer, access) != FALSE;
  if (!frame.mapped_) return unmapped(info, buffer, access);
  if (!all_fits(frame.frame_, info)) return beyond_memory();
  return frame;
}

}  // namespace calvin::gst
