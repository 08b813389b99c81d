// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibundistort: the library's pixels in every format.

#include "undistort_fixture.hpp"

#include <gst/check/gstcheck.h>

using namespace calvin;
using check::calibration_of;
using check::Fixture;
using check::kBarrel;

// How each format lies in memory, said once more: plane, offset, layout.
struct FormatPlane {
  int plane;
  int offset;
  PlaneLayout layout;
};
struct Format {
  const char* caps;
  std::vector<FormatPlane> planes;
};
static const Subsampling kMpeg2 = {1, 1, true, false};
static const Subsampling kJpeg = {1, 1, false, false};
static const std::vector<Format> kFormats = {
    {"GRAY8,colorimetry=1:4:0:0", {{0, 0, {{}, 1, 1, 1, {0}}}}},
    {"I420,colorimetry=bt601,chroma-site=mpeg2",
     {{0, 0, {{}, 1, 1, 1, {16}}},
      {1, 0, {kMpeg2, 1, 1, 1, {128}}},
      {2, 0, {kMpeg2, 1, 1, 1, {128}}}}},
    {"I420,colorimetry=1:4:0:0,chroma-site=jpeg",
     {{0, 0, {{}, 1, 1, 1, {0}}},
      {1, 0, {kJpeg, 1, 1, 1, {128}}},
      {2, 0, {kJpeg, 1, 1, 1, {128}}}}},
    {"NV12,colorimetry=bt709,chroma-site=mpeg2",
     {{0, 0, {{}, 1, 1, 1, {16}}}, {1, 0, {kMpeg2, 2, 2, 1, {128, 128}}}}},
    {"YUY2,colorimetry=bt601,chroma-site=mpeg2",
     {{0, 0, {{}, 1, 2, 1, {16}}}, {0, 1, {{1, 0, true, false}, 2, 4, 2, {128, 128}}}}},
    {"BGRx,colorimetry=sRGB", {{0, 0, {{}, 4, 4, 1, {0, 0, 0, 255}}}}},
};

static void check_format(const Format& format, ImageSize size, double alpha) {
  Fixture f("calibundistort");
  g_object_set(f.element, "calibration", kBarrel, "alpha", alpha, nullptr);
  const std::string caps_text = std::string("video/x-raw,format=") + format.caps +
                                ",framerate=25/1,width=" + std::to_string(size.width) +
                                ",height=" + std::to_string(size.height);
  g_autoptr(GstCaps) caps = gst_caps_from_string(caps_text.c_str());
  gst_harness_set_src_caps(f.h, gst_caps_ref(caps));
  GstVideoInfo info;
  fail_unless(gst_video_info_from_caps(&info, caps));
  g_autoptr(GstBuffer) in = Fixture::noise(GST_VIDEO_INFO_NAME(&info), size, 0);
  g_autoptr(GstBuffer) out = gst_harness_push_and_pull(f.h, gst_buffer_ref(in));
  GstVideoFrame a;
  GstVideoFrame b;
  fail_unless(gst_video_frame_map(&a, &info, in, GST_MAP_READ));
  fail_unless(gst_video_frame_map(&b, &info, out, GST_MAP_READ));
  const Camera source = fit_to_frame(calibration_of(kBarrel), size)->camera;
  for (const FormatPlane& p : format.planes) {
    const auto undistorter = Undistorter::make(source, {alpha, {}}, {p.layout}).value();
    const auto* from = static_cast<const guint8*>(GST_VIDEO_FRAME_PLANE_DATA(&a, p.plane));
    const auto* got = static_cast<const guint8*>(GST_VIDEO_FRAME_PLANE_DATA(&b, p.plane));
    const std::ptrdiff_t stride = GST_VIDEO_FRAME_PLANE_STRIDE(&b, p.plane);
    const int rows =
        (size.height + (1 << p.layout.subsampling.y_shift) - 1) >> p.layout.subsampling.y_shift;
    const int columns =
        (size.width + (1 << p.layout.subsampling.x_shift) - 1) >> p.layout.subsampling.x_shift;
    std::vector<guint8> want(static_cast<std::size_t>(stride * rows));
    undistorter.apply(0, {from + p.offset, GST_VIDEO_FRAME_PLANE_STRIDE(&a, p.plane)},
                      {want.data() + p.offset, stride});
    for (int y = 0; y < rows; ++y) {
      for (int x = 0; x < columns; ++x) {
        for (int c = 0; c < p.layout.components; ++c) {
          const std::ptrdiff_t at =
              y * stride + p.offset + x * p.layout.pixel_step + c * p.layout.component_step;
          if (got[at] == want[static_cast<std::size_t>(at)]) continue;
          fail_unless(false, "%s, alpha %f: %d instead of %d at %d, %d of plane %d", format.caps,
                      alpha, got[at], want[static_cast<std::size_t>(at)], x, y, p.plane);
        }
      }
    }
  }
  gst_video_frame_unmap(&a);
  gst_video_frame_unmap(&b);
}

GST_START_TEST(test_every_format_equals_the_library) {
  const Format& format = kFormats[static_cast<std::size_t>(__i__)];
  check_format(format, {640, 480}, 0);
  check_format(format, {321, 241}, 1);
}
GST_END_TEST;

static Suite* calibundistort_formats_suite() {
  Suite* suite = suite_create("calibundistort_formats");
  TCase* tc = tcase_create("general");
  tcase_add_loop_test(tc, test_every_format_equals_the_library, 0,
                      static_cast<int>(kFormats.size()));
  suite_add_tcase(suite, tc);
  return suite;
}

GST_CHECK_MAIN(calibundistort_formats)
