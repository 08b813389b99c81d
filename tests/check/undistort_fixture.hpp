// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What the tests of calibundistort share: the element in a harness, and frames of noise.
#pragma once

#include <random>

#include "calvin/io/settings.hpp"
#include "calvin/remap/fit.hpp"
#include "calvin/remap/undistorter.hpp"
#include "support.hpp"

#include <gst/check/gstharness.h>

namespace calvin::check {

inline constexpr char kBarrel[] =
    "fx=480,fy=478,cx=325,cy=236,k1=-0.28,k2=0.09,p1=0.0005,p2=-0.0007,width=640,height=480";

inline Calibration calibration_of(const char* text) {
  return parse_calibration_setting(text).value();
}
struct Fixture {
  explicit Fixture(const char* launch, bool live = false)
      : h(gst_harness_new_parse(launch)),
        element(gst_harness_find_element(h, "calibundistort")),
        bus(h->element) {
    gst_harness_set_live(h, live);
  }
  ~Fixture() {
    bus.detach();
    gst_object_unref(element);
    gst_harness_teardown(h);
  }
  void set_caps(const char* format, ImageSize size) {
    gst_harness_set_src_caps(h, caps_of(format, size));
  }
  // The frame that comes out for one of grey noise; the same noise each time.
  GstBuffer* push(ImageSize size, int n = 0) {
    return gst_harness_push_and_pull(h, noise("GRAY8", size, n));
  }
  static GstBuffer* noise(const char* format, ImageSize size, int n) {
    GstVideoInfo info;
    gst_video_info_set_format(&info, gst_video_format_from_string(format),
                              static_cast<guint>(size.width), static_cast<guint>(size.height));
    GstBuffer* buffer = gst_buffer_new_allocate(nullptr, info.size, nullptr);
    GstMapInfo map;
    gst_buffer_map(buffer, &map, GST_MAP_WRITE);
    std::mt19937 random(1);
    for (gsize i = 0; i < map.size; ++i) map.data[i] = static_cast<guint8>(random());
    gst_buffer_unmap(buffer, &map);
    GST_BUFFER_PTS(buffer) = static_cast<guint64>(n) * 40 * GST_MSECOND;
    GST_BUFFER_DURATION(buffer) = 40 * GST_MSECOND;
    return buffer;
  }
  GstHarness* h;
  GstElement* element;
  Bus bus;
};

inline constexpr ImageSize kSize = {640, 480};

}  // namespace calvin::check
