// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What the tests of calibundistort share: the element in a harness, and frames of noise.
#pragma once

#include <random>

#include "calvin/camera/frame_fit.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/io/settings.hpp"
#include "calvin/remap/undistorter.hpp"
#include "common/calibration_event.hpp"
#include "support.hpp"

#include <gst/check/gstharness.h>

namespace calvin::check {

inline constexpr char kBarrel[] =
    "fx=480,fy=478,cx=325,cy=236,k1=-0.28,k2=0.09,p1=0.0005,p2=-0.0007,width=640,height=480";

inline constexpr char kPincushion[] =
    "fx=480,fy=478,cx=325,cy=236,k1=0.1,k2=0,p1=0,p2=0,width=640,height=480";

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

inline Camera camera_of(const char* text) { return Camera::make(calibration_of(text)).value(); }
inline std::string json_of(const char* text) {
  Calibration calibration = calibration_of(text);
  calibration.camera = "left";
  return print_calibration(calibration).value();
}
inline GstEvent* event_of(const char* text) {
  return gst::new_calibration_event({"left", json_of(text)});
}

// What the library makes of the grey noise.
inline std::vector<guint8> gray_through(const Undistorter& undistorter,
                                        const Sampling& sampling = {}) {
  const ImageSize size = undistorter.source().image_size();
  g_autoptr(GstBuffer) in = Fixture::noise("GRAY8", size, 0);
  GstVideoInfo info;
  gst_video_info_set_format(&info, GST_VIDEO_FORMAT_GRAY8, static_cast<guint>(size.width),
                            static_cast<guint>(size.height));
  GstMapInfo map;
  gst_buffer_map(in, &map, GST_MAP_READ);
  const ImageSize shown = undistorter.output().image_size();
  std::vector<guint8> out(static_cast<std::size_t>(shown.width * shown.height));
  undistorter.apply(0, {map.data, info.stride[0]}, {out.data(), shown.width}, sampling);
  gst_buffer_unmap(in, &map);
  return out;
}

inline std::vector<guint8> expected_gray(const char* text, ImageSize size, double alpha = 0,
                                         ImageSize output = {}) {
  const Camera source = fit_to_frame(calibration_of(text), size)->camera;
  return gray_through(Undistorter::make(source, {alpha, output}, {PlaneLayout{}}).value());
}

// The pixels of a grey frame without padding.
inline std::vector<guint8> gray_of(GstBuffer* buffer, ImageSize size) {
  GstVideoInfo info;
  gst_video_info_set_format(&info, GST_VIDEO_FORMAT_GRAY8, static_cast<guint>(size.width),
                            static_cast<guint>(size.height));
  GstVideoFrame frame;
  g_assert_true(gst_video_frame_map(&frame, &info, buffer, GST_MAP_READ));
  std::vector<guint8> pixels;
  for (int y = 0; y < size.height; ++y) {
    const auto* row = static_cast<const guint8*>(GST_VIDEO_FRAME_PLANE_DATA(&frame, 0)) +
                      static_cast<std::ptrdiff_t>(y) * GST_VIDEO_FRAME_PLANE_STRIDE(&frame, 0);
    pixels.insert(pixels.end(), row, row + size.width);
  }
  gst_video_frame_unmap(&frame);
  return pixels;
}

inline std::string output_calibration(const Fixture& f) {
  g_autofree gchar* text = nullptr;
  g_object_get(f.element, "output-calibration", &text, nullptr);
  return text != nullptr ? text : "";
}

// Says of a buffer that holds a picture of the format that `part` of it is the frame.
inline void add_crop(GstBuffer* buffer, GstVideoInfo info, const FramePart& part) {
  gst_buffer_add_video_meta_full(buffer, GST_VIDEO_FRAME_FLAG_NONE, GST_VIDEO_INFO_FORMAT(&info),
                                 static_cast<guint>(part.whole.width),
                                 static_cast<guint>(part.whole.height),
                                 GST_VIDEO_INFO_N_PLANES(&info), info.offset, info.stride);
  GstVideoCropMeta* crop = gst_buffer_add_video_crop_meta(buffer);
  crop->x = static_cast<guint>(part.x);
  crop->y = static_cast<guint>(part.y);
  crop->width = static_cast<guint>(part.size.width);
  crop->height = static_cast<guint>(part.size.height);
}

// The calibration events that came out since the last call.
inline std::vector<gst::CalibrationEvent> events_out(Fixture& f) {
  std::vector<gst::CalibrationEvent> all;
  while (GstEvent* event = gst_harness_try_pull_event(f.h)) {
    if (auto calibration = gst::parse_calibration_event(event)) all.push_back(*calibration);
    gst_event_unref(event);
  }
  return all;
}

}  // namespace calvin::check
