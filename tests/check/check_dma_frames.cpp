// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Frames in DMA memory, which GStreamer names so from 1.24 on: linear ones are used where they are,
// under that name or as system memory, whichever follows. The memory is that of a file in memory,
// which GStreamer's own allocator for dmabufs maps.

#include "undistort_fixture.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <gst/allocators/gstdmabuf.h>
#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>

using namespace calvin;
using namespace calvin::check;

#if GST_CHECK_VERSION(1, 24, 0)

// A format of GStreamer's, and what the kernel calls it (linux/drm_fourcc.h).
struct Format {
  const char* mapped;
  const char* dma;
};
static const Format kFormats[] = {
    {"YUY2", "YUYV"}, {"UYVY", "UYVY"},  {"NV12", "NV12"},
    {"I420", "YU12"}, {"GRAY8", "R8  "}, {"BGRx", "XR24"},
};

static GstCaps* dma_caps_of(const char* dma_format, ImageSize size) {
  GstCaps* caps = caps_of("DMA_DRM", size);
  gst_caps_set_features_simple(caps, gst_caps_features_new("memory:DMABuf", nullptr));
  gst_caps_set_simple(caps, "drm-format", G_TYPE_STRING, dma_format, nullptr);
  return caps;
}

// The same bytes in memory of GstDmaBufAllocator. Takes the buffer.
static GstBuffer* in_dma_memory(GstBuffer* plain) {
  const gsize size = gst_buffer_get_size(plain);
  const int file = memfd_create("frame", MFD_CLOEXEC);
  fail_unless(file >= 0 && ftruncate(file, static_cast<off_t>(size)) == 0);
  void* bytes = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  fail_unless(bytes != MAP_FAILED);
  gst_buffer_extract(plain, 0, bytes, size);
  munmap(bytes, size);
  g_autoptr(GstAllocator) allocator = gst_dmabuf_allocator_new();
  GstBuffer* buffer = gst_buffer_new();
  gst_buffer_append_memory(buffer, gst_dmabuf_allocator_alloc(allocator, file, size));
  gst_buffer_copy_into(buffer, plain, GST_BUFFER_COPY_METADATA, 0, static_cast<gsize>(-1));
  gst_buffer_unref(plain);
  return buffer;
}

static bool has_format(GstHarness* h, const char* format) {
  g_autoptr(GstCaps) caps = gst_pad_get_current_caps(h->sinkpad);
  return g_strcmp0(gst_structure_get_string(gst_caps_get_structure(caps, 0), "format"), format) ==
         0;
}

static void check_found(GstBuffer* buffer, const Scene& scene, int n, const char* format) {
  const auto observations = gst::read_observations(buffer);
  fail_unless_equals_int(observations.size(), 1);
  const Observation truth = scene.truth(n);
  fail_unless(observations[0].ids == truth.ids, "%s: no board", format);
  for (std::size_t i = 0; i < truth.uv.size(); ++i) {
    const Pixel seen = observations[0].uv[i];
    fail_unless(std::hypot(seen.u - truth.uv[i].u, seen.v - truth.uv[i].v) < 0.3, "%s", format);
  }
}

// Pushes a frame that shows the board; the memory that comes out is the one that went in.
static void check_detection(const char* line, const Format& format, const char* comes_out) {
  const Scene scene;
  GstHarness* h = gst_harness_new_parse(line);
  gst_harness_set_src_caps(h, dma_caps_of(format.dma, scene.size));
  GstBuffer* in = in_dma_memory(frame_of(scene.picture(3), format.mapped, 0));
  const GstMemory* memory = gst_buffer_peek_memory(in, 0);
  g_autoptr(GstBuffer) out = gst_harness_push_and_pull(h, in);
  fail_unless(out != nullptr, "%s: %s stops", line, format.dma);
  fail_unless(gst_buffer_peek_memory(out, 0) == memory, "%s was copied", format.dma);
  fail_unless(has_format(h, comes_out), "%s: %s comes out", line, format.dma);
  check_found(out, scene, 3, format.dma);
  gst_harness_teardown(h);
}

GST_START_TEST(test_boards_are_found_in_dma_memory) {
  check_detection("calibdetect mode=sync ! calibsolve", kFormats[__i__], "DMA_DRM");
}
GST_END_TEST;

GST_START_TEST(test_they_go_on_as_system_memory) {
  const Format& format = kFormats[__i__];
  check_detection("calibdetect mode=sync ! capsfilter caps=video/x-raw", format, format.mapped);
}
GST_END_TEST;

// caliboverlay draws on the frames where they are.
GST_START_TEST(test_drawing_on_dma_memory) {
  const Scene scene;
  GstHarness* h = gst_harness_new_parse("calibrate mode=sync");
  gst_harness_set_src_caps(h, dma_caps_of("NV12", scene.size));
  g_autoptr(GstBuffer) plain = frame_of(scene.picture(3), "NV12", 0);
  GstBuffer* in = in_dma_memory(gst_buffer_copy(plain));
  const GstMemory* memory = gst_buffer_peek_memory(in, 0);
  g_autoptr(GstBuffer) out = gst_harness_push_and_pull(h, in);
  fail_unless(gst_buffer_peek_memory(out, 0) == memory, "the frame was copied");
  fail_unless(has_format(h, "NV12"));
  GstMapInfo map;
  fail_unless(gst_buffer_map(plain, &map, GST_MAP_READ));
  fail_unless(gst_buffer_memcmp(out, 0, map.data, map.size) != 0, "nothing was drawn");
  gst_buffer_unmap(plain, &map);
  gst_harness_teardown(h);
}
GST_END_TEST;

// Undistorted to the same bytes as frames in system memory.
GST_START_TEST(test_undistorting_dma_memory) {
  const Format& format = kFormats[__i__];
  const std::string line = std::string("calibundistort calibration=") + kBarrel;
  Fixture plain(line.c_str());
  plain.set_caps(format.mapped, kSize);
  Fixture dma(line.c_str());
  gst_harness_set_src_caps(dma.h, dma_caps_of(format.dma, kSize));
  g_autoptr(GstBuffer) expected =
      gst_harness_push_and_pull(plain.h, Fixture::noise(format.mapped, kSize, 0));
  g_autoptr(GstBuffer) out =
      gst_harness_push_and_pull(dma.h, in_dma_memory(Fixture::noise(format.mapped, kSize, 0)));
  fail_unless(out != nullptr, "%s stops", format.dma);
  fail_unless(has_format(dma.h, format.mapped));
  GstMapInfo map;
  fail_unless(gst_buffer_map(expected, &map, GST_MAP_READ));
  fail_unless_equals_int(gst_buffer_get_size(out), map.size);
  fail_unless(gst_buffer_memcmp(out, 0, map.data, map.size) == 0, "%s is another picture",
              format.dma);
  gst_buffer_unmap(expected, &map);
  fail_unless(dma.bus.texts(GST_MESSAGE_WARNING).empty());
}
GST_END_TEST;

// Without a calibration frames pass where they are.
GST_START_TEST(test_undistort_passes_dma_memory) {
  Fixture f("calibundistort");
  gst_harness_set_src_caps(f.h, dma_caps_of("YUYV", kSize));
  GstBuffer* in = in_dma_memory(Fixture::noise("YUY2", kSize, 0));
  const GstMemory* memory = gst_buffer_peek_memory(in, 0);
  g_autoptr(GstBuffer) out = gst_harness_push_and_pull(f.h, in);
  fail_unless(gst_buffer_peek_memory(out, 0) == memory, "the frame was copied");
  fail_unless(has_format(f.h, "YUY2"));
}
GST_END_TEST;

// A source that asks where its frames should lie is not sent to a pool of system memory; strides
// of any kind are fine.
GST_START_TEST(test_no_pool_is_proposed_for_dma_memory) {
  static const char* const kLines[] = {"calibundistort",
                                       "calibdetect ! capsfilter caps=video/x-raw", "caliboverlay"};
  const std::string calibrated = std::string("calibundistort calibration=") + kBarrel;
  GstHarness* h = gst_harness_new_parse(__i__ == 3 ? calibrated.c_str() : kLines[__i__]);
  GstCaps* caps = dma_caps_of("NV12", kSize);
  gst_harness_set_src_caps(h, gst_caps_ref(caps));
  gst_buffer_unref(gst_harness_push_and_pull(h, in_dma_memory(Fixture::noise("NV12", kSize, 0))));
  g_autoptr(GstQuery) query = gst_query_new_allocation(caps, TRUE);
  fail_unless(gst_pad_peer_query(h->srcpad, query));
  fail_unless_equals_int(gst_query_get_n_allocation_pools(query), 0);
  fail_unless(gst_query_find_allocation_meta(query, GST_VIDEO_META_API_TYPE, nullptr));
  gst_caps_unref(caps);
  gst_harness_teardown(h);
}
GST_END_TEST;

#endif

// Frames in tiles cannot be read by their rows; GStreamer says no more than "not-negotiated".
GST_START_TEST(test_tiles_are_refused_with_advice) {
  static const char* const kElements[] = {"calibdetect", "calibsolve", "caliboverlay", "calibrate",
                                          "calibundistort"};
  GstHarness* h = harness_of(make_element(kElements[__i__]));
  Bus bus(h->element);
  gst_harness_push_event(h, gst_event_new_stream_start("tiles"));
  g_autoptr(GstCaps) caps = gst_caps_from_string(
      "video/x-raw(memory:DMABuf),format=DMA_DRM,drm-format=(string)\"NV12:0x0100000000000002\","
      "width=640,height=480,framerate=30/1");
  gst_harness_push_event(h, gst_event_new_caps(caps));
  for (const char* part : {"the tiled format NV12:0x0100000000000002", "glupload", "vapostproc"}) {
    fail_unless(bus.says(GST_MESSAGE_ERROR, part), "%s: nothing of %s", kElements[__i__], part);
  }
  bus.detach();
  gst_harness_teardown(h);
}
GST_END_TEST;

static Suite* dma_frames_suite() {
  gst::register_metas();
  Suite* suite = suite_create("dma_frames");
  TCase* tc = tcase_create("general");
#if GST_CHECK_VERSION(1, 24, 0)
  const int formats = static_cast<int>(std::size(kFormats));
  tcase_add_loop_test(tc, test_boards_are_found_in_dma_memory, 0, formats);
  tcase_add_loop_test(tc, test_they_go_on_as_system_memory, 0, formats);
  tcase_add_test(tc, test_drawing_on_dma_memory);
  tcase_add_loop_test(tc, test_undistorting_dma_memory, 0, formats);
  tcase_add_test(tc, test_undistort_passes_dma_memory);
  tcase_add_loop_test(tc, test_no_pool_is_proposed_for_dma_memory, 0, 4);
#endif
  tcase_add_loop_test(tc, test_tiles_are_refused_with_advice, 0, 5);
  suite_add_tcase(suite, tc);
  return suite;
}

GST_CHECK_MAIN(dma_frames)
