// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// caliboverlay over frames of one grey, and where it has drawn.
#pragma once

#include <cstdint>
#include <string>

#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>
#include <gst/video/video.h>

namespace calvin::check {

constexpr std::uint8_t kGround = 100;

struct OverlayHarness {
  explicit OverlayHarness(const std::string& format_and_size) {
    const std::string caps =
        "video/x-raw, framerate=30/1, interlace-mode=progressive, format=" + format_and_size;
    h = gst_harness_new("caliboverlay");
    gst_harness_set_src_caps_str(h, caps.c_str());
    g_autoptr(GstCaps) parsed = gst_caps_from_string(caps.c_str());
    fail_unless(gst_video_info_from_caps(&info, parsed));
  }
  ~OverlayHarness() { gst_harness_teardown(h); }

  [[nodiscard]] GstBuffer* frame(GstClockTime pts = 0) const {
    GstBuffer* buffer = gst_buffer_new_allocate(nullptr, GST_VIDEO_INFO_SIZE(&info), nullptr);
    gst_buffer_memset(buffer, 0, kGround, GST_VIDEO_INFO_SIZE(&info));
    GST_BUFFER_PTS(buffer) = pts;
    return buffer;
  }

  GstHarness* h = nullptr;
  GstVideoInfo info{};
};

struct Box {
  int left, top, right, bottom;
  [[nodiscard]] bool holds(int x, int y) const {
    return x >= left && x <= right && y >= top && y <= bottom;
  }
};

// How many samples of the buffer's components differ from the ground, inside and outside the box.
struct Changes {
  int inside = 0;
  int outside = 0;
};

inline Changes changes(const GstVideoInfo& info, GstBuffer* buffer, const Box& box) {
  Changes result;
  GstVideoFrame frame;
  fail_unless(gst_video_frame_map(&frame, &info, buffer, GST_MAP_READ));
  for (guint c = 0; c < GST_VIDEO_FRAME_N_COMPONENTS(&frame); ++c) {
    const auto* data = GST_VIDEO_FRAME_COMP_DATA(&frame, c);
    const int dx = 1 << GST_VIDEO_FORMAT_INFO_W_SUB(frame.info.finfo, c);
    const int dy = 1 << GST_VIDEO_FORMAT_INFO_H_SUB(frame.info.finfo, c);
    for (int y = 0; y < GST_VIDEO_FRAME_COMP_HEIGHT(&frame, c); ++y) {
      for (int x = 0; x < GST_VIDEO_FRAME_COMP_WIDTH(&frame, c); ++x) {
        const auto* line =
            static_cast<const std::uint8_t*>(data) + y * GST_VIDEO_FRAME_COMP_STRIDE(&frame, c);
        if (line[x * GST_VIDEO_FRAME_COMP_PSTRIDE(&frame, c)] == kGround) continue;
        ++(box.holds(x * dx, y * dy) ? result.inside : result.outside);
      }
    }
  }
  gst_video_frame_unmap(&frame);
  return result;
}

}  // namespace calvin::check
