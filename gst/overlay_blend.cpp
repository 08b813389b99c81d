// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// GStreamer 1.22's video-blend.h forgets to say that this function is C. The first declaration
// decides, so this one comes before any of GStreamer's headers.
struct _GstVideoFrame;
extern "C" int gst_video_blend(_GstVideoFrame* dest, _GstVideoFrame* src, int x, int y,
                               float global_alpha);

#include "overlay_blend.hpp"

#include <gst/video/video-overlay-composition.h>

namespace calvin::gst {

bool blend_tile(GstVideoFrame* frame, const OverlayTile& tile) {
  GstVideoInfo info;
  gst_video_info_set_format(&info, GST_VIDEO_OVERLAY_COMPOSITION_FORMAT_RGB,
                            static_cast<guint>(tile.width), static_cast<guint>(tile.height));
  info.flags = static_cast<GstVideoFlags>(info.flags | GST_VIDEO_FLAG_PREMULTIPLIED_ALPHA);
  g_autoptr(GstBuffer) pixels = gst_buffer_new_wrapped_full(
      GST_MEMORY_FLAG_READONLY, const_cast<std::uint8_t*>(tile.pixels.data()), tile.pixels.size(),
      0, tile.pixels.size(), nullptr, nullptr);
  GstVideoFrame source;
  if (!gst_video_frame_map(&source, &info, pixels, GST_MAP_READ)) return false;
  const gboolean blended = gst_video_blend(frame, &source, tile.x, tile.y, 1);
  gst_video_frame_unmap(&source);
  return blended != FALSE;
}

}  // namespace calvin::gst
