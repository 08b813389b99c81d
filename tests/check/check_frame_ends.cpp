// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// No element reads or writes beyond the memory of a frame, of whatever format: GStreamer's own
// functions do so where a width is odd. And no element takes a frame whose last pixel is not all
// there, nor refuses one that has all its pixels.

#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

#include "calvin_config.h"
#include "common/frames/padded_frame.hpp"
#include "guarded_memory.hpp"
#include "undistort_fixture.hpp"

#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>

using namespace calvin;
using namespace calvin::check;

// Widths at which GStreamer's UYVP, NV12_10LE32, NV16_10LE32 and NV12_10BE_8L128 have no room for
// the chroma of the last column.
static const ImageSize kOdd[] = {{51, 33}, {57, 32}};

static const char* const kElements[] = {"calibdetect mode=sync", "calibdetect mode=async",
                                        "calibundistort", "caliboverlay"};
static const std::size_t kElementCount = G_N_ELEMENTS(kElements);

// A test takes one of the sizes where not all are asked for: another one for the next format, and
// for the next element.
static std::vector<ImageSize> some_of(const std::vector<ImageSize>& sizes, std::size_t at) {
  if (std::getenv("CALVIN_FULL") != nullptr) return sizes;
  return {sizes[(at / kElementCount + at % kElementCount) % sizes.size()]};
}

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

// A lens for frames of that size.
static std::string lens_of(ImageSize size) {
  return "fx=40,fy=40,cx=25,cy=16,k1=-0.2,k2=0,width=" + std::to_string(size.width) +
         ",height=" + std::to_string(size.height);
}

// A test is a process, which takes longer than what it does: each tries all elements.
static void assert_no_byte_beyond(std::size_t at) {
  const std::string element = kElements[at % kElementCount];
  const std::string format = formats_without_palette()[at / kElementCount];
  g_autoptr(GstAllocator) guarded = new_guarded_allocator();
  for (const ImageSize size : some_of({kOdd[0], kOdd[1]}, at)) {
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

GST_START_TEST(test_no_byte_beyond_the_frame) {
  const auto format = static_cast<std::size_t>(__i__);
  for (std::size_t e = 0; e < kElementCount; ++e) assert_no_byte_beyond(format * kElementCount + e);
}
GST_END_TEST;

// Bytes up to the end of the last pixel: some formats have unused ones behind it, in the last row
// or as rows. Of what GStreamer's table has no place for, a row of groups is one of pixels.
static gsize end_of_pixels(const GstVideoInfo& info) {
  const GstVideoFormatInfo* f = info.finfo;
  if (GST_VIDEO_FORMAT_INFO_HAS_PALETTE(f) || GST_VIDEO_FORMAT_INFO_IS_TILED(f)) return info.size;
  gsize end = 0;
  for (guint c = 0; c < GST_VIDEO_FORMAT_INFO_N_COMPONENTS(f); ++c) {
    const int rows = GST_VIDEO_INFO_COMP_HEIGHT(&info, c);
    const int stride = GST_VIDEO_INFO_COMP_STRIDE(&info, c);
    const int step = GST_VIDEO_INFO_COMP_PSTRIDE(&info, c);
    const int row = step > 0 ? step * GST_VIDEO_INFO_COMP_WIDTH(&info, c) : stride;
    const gsize begin = GST_VIDEO_INFO_PLANE_OFFSET(&info, GST_VIDEO_FORMAT_INFO_PLANE(f, c));
    end = std::max(end, begin + static_cast<gsize>((rows - 1) * stride + row));
  }
  return end;
}

// A frame of GStreamer's own rows that is said to be all there, of which `bytes` are.
static GstBuffer* frame_of_bytes(GstAllocator* allocator, GstVideoInfo info, gsize bytes) {
  GstBuffer* buffer = gst_buffer_new_allocate(allocator, bytes, nullptr);
  gst_buffer_add_video_meta_full(buffer, GST_VIDEO_FRAME_FLAG_NONE, GST_VIDEO_INFO_FORMAT(&info),
                                 static_cast<guint>(GST_VIDEO_INFO_WIDTH(&info)),
                                 static_cast<guint>(GST_VIDEO_INFO_HEIGHT(&info)),
                                 GST_VIDEO_INFO_N_PLANES(&info), info.offset, info.stride);
  const ImageSize size = {GST_VIDEO_INFO_WIDTH(&info), GST_VIDEO_INFO_HEIGHT(&info)};
  gst::attach_observations(buffer, seen_in(size));
  return buffer;
}

// What an element says of one frame, all of which it has looked at.
static std::string said_of(const std::string& element, const std::string& format, ImageSize size,
                           GstBuffer* in) {
  const bool undistorts = element == "calibundistort";
  GstElement* made = make_element(undistorts ? element + " calibration=" + lens_of(size) : element);
  Bus bus(made);
  GstHarness* h = harness_of(made);
  gst_harness_set_src_caps(h, caps_of(format.c_str(), size));
  fail_unless_equals_int(gst_harness_push(h, in), GST_FLOW_OK);
  gst_harness_push_event(h, gst_event_new_eos());
  const std::string said = join(bus.texts(GST_MESSAGE_WARNING), " ");
  bus.detach();
  gst_harness_teardown(h);
  return said;
}

static void assert_taken_if_last_pixel_is_there(std::size_t at) {
  const std::string element = kElements[at % kElementCount];
  const std::string format = raw_formats()[at / kElementCount];
  const std::vector<std::string> plain = formats_without_palette();
  const bool has_values = std::find(plain.begin(), plain.end(), format) != plain.end();
  if (!has_values && element.find("calibdetect") == std::string::npos) return;
  if (element == "caliboverlay" && !CALVIN_HAVE_CAIRO) return;  // which then reads no frame
  g_autoptr(GstAllocator) guarded = new_guarded_allocator();
  const auto sizes = some_of({kOdd[0], kOdd[1], {52, 34}}, at);
  for (const ImageSize size : sizes) {
    const GstVideoInfo info = info_of(format, size);
    const gsize end = end_of_pixels(info);
    for (const gsize bytes : {info.size, end, end - 1}) {
      const std::string said = said_of(element, format, size, frame_of_bytes(guarded, info, bytes));
      const bool refused = said.find("reach beyond its memory") != std::string::npos;
      fail_unless(bytes < end ? refused : said.empty(), "%s, %s of %dx%d, %d of %d bytes: %s",
                  element.c_str(), format.c_str(), size.width, size.height, static_cast<int>(bytes),
                  static_cast<int>(end), said.c_str());
    }
  }
}

GST_START_TEST(test_a_frame_is_taken_if_its_last_pixel_is_all_there) {
  const auto format = static_cast<std::size_t>(__i__);
  for (std::size_t e = 0; e < kElementCount; ++e) {
    assert_taken_if_last_pixel_is_there(format * kElementCount + e);
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

// A frame each plane of which ends as a padded one does, before memory that is no one's.
static GstVideoFrame padded_planes(const GstVideoInfo& info, GstAllocator* allocator,
                                   std::vector<GstMemory*>& memories) {
  GstVideoFrame frame = {};
  frame.info = info;
  for (guint p = 0; p < GST_VIDEO_INFO_N_PLANES(&info); ++p) {
    const gsize bytes =
        static_cast<gsize>(gst::plane_bytes(info, info, p).value_or(0)) + gst::kPadding;
    memories.push_back(gst_allocator_alloc(allocator, bytes, nullptr));
    GstMapInfo map;
    fail_unless(gst_memory_map(memories.back(), &map, GST_MAP_READWRITE));
    frame.data[p] = map.data;  // stays where it is
    gst_memory_unmap(memories.back(), &map);
  }
  return frame;
}

GST_START_TEST(test_padding_has_room_for_what_gstreamer_reads_and_writes) {
  const std::string format = formats_without_palette()[static_cast<std::size_t>(__i__)];
  g_autoptr(GstAllocator) guarded = new_guarded_allocator();
  for (const ImageSize size : {kOdd[0], kOdd[1], ImageSize{49, 131}, ImageSize{643, 483}}) {
    const GstVideoInfo info = info_of(format, size);
    if (!gst::needs_padding(info)) continue;
    std::vector<GstMemory*> memories;
    GstVideoFrame frame = padded_planes(info, guarded, memories);
    std::vector<guint64> line(static_cast<std::size_t>(size.width) + 64);  // of four samples each
    for (int y = 0; y < size.height; ++y) {
      info.finfo->unpack_func(info.finfo, GST_VIDEO_PACK_FLAG_NONE, line.data(), frame.data,
                              info.stride, 0, y, size.width);
      info.finfo->pack_func(info.finfo, GST_VIDEO_PACK_FLAG_NONE, line.data(), 0, frame.data,
                            info.stride, GST_VIDEO_INFO_CHROMA_SITE(&info), y, size.width);
    }
    for (GstMemory* memory : memories) gst_memory_unref(memory);
  }
}
GST_END_TEST;

static Suite* frame_ends_suite() {
  gst::register_metas();
  Suite* suite = suite_create("frame_ends");
  TCase* cases = tcase_create("guarded memory");
  suite_add_tcase(suite, cases);
  const int count = static_cast<int>(formats_without_palette().size());
  tcase_add_loop_test(cases, test_no_byte_beyond_the_frame, 0, count);
  tcase_add_loop_test(cases, test_a_frame_is_taken_if_its_last_pixel_is_all_there, 0,
                      static_cast<int>(raw_formats().size()));
  tcase_add_loop_test(cases, test_the_source_stays_in_the_frame, 0, count);
  tcase_add_loop_test(cases, test_padding_has_room_for_what_gstreamer_reads_and_writes, 0, count);
  return suite;
}

GST_CHECK_MAIN(frame_ends)
