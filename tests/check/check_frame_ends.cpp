// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// No element reads or writes beyond the memory of a frame, of whatever format: GStreamer's own
// functions do so where a width is odd.

#include <string>

#include "guarded_memory.hpp"
#include "undistort_fixture.hpp"

#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>

using namespace calvin;
using namespace calvin::check;

// Widths at which GStreamer's UYVP, NV12_10LE32, NV16_10LE32 and NV12_10BE_8L128 have no room for
// the chroma of the last column.
static const ImageSize kOdd[] = {{51, 33}, {57, 32}};

static GstVideoInfo info_of(const std::string& format, ImageSize size) {
  GstVideoInfo info;
  fail_unless(gst_video_info_set_format(&info, gst_video_format_from_string(format.c_str()),
                                        static_cast<guint>(size.width),
                                        static_cast<guint>(size.height)));
  return info;
}

// A board whose marks reach the last row and the last column.
static std::vector<Observation> seen_in(ImageSize size) {
  const Scene scene;
  Observation seen = true_observation(scene.camera, scene.board, scene.pose(3));
  seen.image_size = size;
  for (std::size_t i = 0; i < seen.uv.size(); ++i) {
    seen.uv[i] = {static_cast<double>(static_cast<int>(i) % size.width),
                  static_cast<double>(static_cast<int>(i) % size.height)};
  }
  return {seen};
}

static const char* const kElements[] = {"calibdetect mode=sync", "calibdetect mode=async",
                                        "calibundistort", "caliboverlay"};

// A lens for frames of that size.
static std::string lens_of(ImageSize size) {
  return "fx=40,fy=40,cx=25,cy=16,k1=-0.2,k2=0,width=" + std::to_string(size.width) +
         ",height=" + std::to_string(size.height);
}

GST_START_TEST(test_no_byte_beyond_the_frame) {
  const auto at = static_cast<std::size_t>(__i__);
  const std::string element = kElements[at % G_N_ELEMENTS(kElements)];
  const std::string format = formats_without_palette()[at / G_N_ELEMENTS(kElements)];
  g_autoptr(GstAllocator) guarded = new_guarded_allocator();
  for (const ImageSize size : kOdd) {
    const bool undistorts = element == "calibundistort";
    GstHarness* h =
        harness_of(make_element(undistorts ? element + " calibration=" + lens_of(size) : element));
    gst_harness_set_propose_allocator(h, GST_ALLOCATOR(gst_object_ref(guarded)), nullptr);
    gst_harness_set_src_caps(h, caps_of(format.c_str(), size));
    for (int n = 0; n < 2; ++n) {
      GstBuffer* in = gst_buffer_new_allocate(guarded, info_of(format, size).size, nullptr);
      GST_BUFFER_PTS(in) = static_cast<guint64>(n) * 40 * GST_MSECOND;
      GST_BUFFER_DURATION(in) = 40 * GST_MSECOND;
      if (element == "caliboverlay") gst::attach_observations(in, seen_in(size));
      g_autoptr(GstBuffer) out = gst_harness_push_and_pull(h, in);
      fail_unless(out != nullptr, "%s: no frame of %s", element.c_str(), format.c_str());
      fail_unless_equals_string(gst_buffer_peek_memory(out, 0)->allocator->mem_type, "guarded");
      fail_unless((out == in) != undistorts);
    }
    gst_harness_push_event(h, gst_event_new_eos());  // what a worker is at is waited for
    gst_harness_teardown(h);
  }
}
GST_END_TEST;

GST_START_TEST(test_the_source_stays_in_the_frame) {
  const std::string format = formats_without_palette()[static_cast<std::size_t>(__i__)];
  g_autoptr(GstAllocator) guarded = new_guarded_allocator();
  for (const ImageSize size : kOdd) {
    GstHarness* h =
        gst_harness_new_with_element(make_element("calibtestsrc num-buffers=2"), nullptr, "src");
    gst_object_unref(h->element);
    gst_harness_set_propose_allocator(h, GST_ALLOCATOR(gst_object_ref(guarded)), nullptr);
    gst_harness_set_sink_caps(h, caps_of(format.c_str(), size));
    gst_harness_play(h);
    g_autoptr(GstBuffer) buffer = gst_harness_pull(h);
    fail_unless_equals_string(gst_buffer_peek_memory(buffer, 0)->allocator->mem_type, "guarded");
    gst_harness_teardown(h);
  }
}
GST_END_TEST;

static Suite* frame_ends_suite() {
  gst::register_metas();
  Suite* suite = suite_create("frame_ends");
  TCase* cases = tcase_create("guarded memory");
  suite_add_tcase(suite, cases);
  const int count = static_cast<int>(formats_without_palette().size());
  tcase_add_loop_test(cases, test_no_byte_beyond_the_frame, 0,
                      count * static_cast<int>(G_N_ELEMENTS(kElements)));
  tcase_add_loop_test(cases, test_the_source_stays_in_the_frame, 0, count);
  return suite;
}

GST_CHECK_MAIN(frame_ends)
