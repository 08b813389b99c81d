// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibdetect mode=async looks at a frame that has gone on: whoever changes that frame downstream,
// and whoever waits for its memory upstream, does not notice.

#include <cstring>
#include <random>

#include "common/values.hpp"
#include "support.hpp"

#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>

using namespace calvin;

struct Fixture {
  explicit Fixture(const char* launch, const char* format, ImageSize size)
      : element(check::make_element(launch)), h(check::harness_of(element)) {
    gst_harness_set_src_caps(h, check::caps_of(format, size));
  }
  ~Fixture() { gst_harness_teardown(h); }

  GstElement* element;
  GstHarness* h;
};

// What the last frames before EOS left to be told.
static std::vector<Observation> told_at_eos(GstHarness* h) {
  gst_harness_push_event(h, gst_event_new_eos());
  std::vector<Observation> told;
  while (GstEvent* event = gst_harness_try_pull_event(h)) {
    if (gst_event_has_name(event, gst::kObservationName)) {
      told = gst::observations_from_structure(gst_event_get_structure(event));
    }
    gst_event_unref(event);
  }
  return told;
}

static const char* const kFormats[] = {"GRAY8", "NV12", "RGB", "v210"};

GST_START_TEST(test_whoever_draws_on_the_frame_does_not_disturb) {
  const check::Scene scene;
  const char* format = kFormats[__i__];
  const Observation truth = scene.truth(2);
  for (int round = 0; round < 10; ++round) {
    Fixture f("calibdetect mode=async", format, scene.size);
    GstBuffer* out =
        gst_harness_push_and_pull(f.h, check::frame_of(scene.picture(2), format, round));
    out = gst_buffer_make_writable(out);
    fail_unless_equals_int(gst_buffer_memset(out, 0, 77, gst_buffer_get_size(out)),
                           gst_buffer_get_size(out));
    const auto told = told_at_eos(f.h);
    fail_unless_equals_int(told.size(), 1);
    fail_unless_equals_int(told[0].ids.size(), truth.ids.size());
    // What was written is there, too.
    GstMapInfo map;
    fail_unless(gst_buffer_map(out, &map, GST_MAP_READ));
    for (gsize i = 0; i < map.size; i += 997) fail_unless_equals_int(map.data[i], 77);
    gst_buffer_unmap(out, &map);
    gst_buffer_unref(out);
  }
}
GST_END_TEST;

// A camera with a single buffer: once the frame has been shown, the camera has it back, however
// long the detection takes. So too where a tee keeps us from owning the frame.
GST_START_TEST(test_a_frame_from_a_small_pool_goes_back_at_once) {
  const bool shared = __i__ == 1;
  const ImageSize size{4000, 3000};
  GstCaps* caps = check::caps_of("GRAY8", size);
  const gsize bytes = static_cast<gsize>(size.width) * static_cast<gsize>(size.height);
  g_autoptr(GstBufferPool) pool = gst_buffer_pool_new();
  GstStructure* config = gst_buffer_pool_get_config(pool);
  gst_buffer_pool_config_set_params(config, caps, static_cast<guint>(bytes), 1, 1);
  fail_unless(gst_buffer_pool_set_config(pool, config));
  gst_caps_unref(caps);
  fail_unless(gst_buffer_pool_set_active(pool, TRUE));

  std::string boards = kDefaultBoard.data();
  for (int cols = 10; cols < 17; ++cols) {
    boards += ";checkerboard:" + std::to_string(cols) + "x6:25mm";
  }
  Fixture f(("calibdetect mode=async board=" + boards).c_str(), "GRAY8", size);
  GstBufferPoolAcquireParams at_once{};
  at_once.flags = GST_BUFFER_POOL_ACQUIRE_FLAG_DONTWAIT;
  GstBuffer* in = nullptr;
  fail_unless_equals_int(gst_buffer_pool_acquire_buffer(pool, &in, &at_once), GST_FLOW_OK);
  GstMapInfo map;
  fail_unless(gst_buffer_map(in, &map, GST_MAP_WRITE));
  std::mt19937 random(1);
  for (gsize i = 0; i + 4 <= map.size; i += 4) {
    const auto noise = static_cast<guint32>(random());
    std::memcpy(map.data + i, &noise, 4);
  }
  gst_buffer_unmap(in, &map);
  GST_BUFFER_PTS(in) = 0;
  if (shared) {
    GstBuffer* copy = gst_buffer_copy(in);
    gst_buffer_unref(in);
    in = copy;
  }
  gst_buffer_unref(gst_harness_push_and_pull(f.h, in));
  GstBuffer* next = nullptr;
  fail_unless_equals_int(gst_buffer_pool_acquire_buffer(pool, &next, &at_once), GST_FLOW_OK);
  gst_buffer_unref(next);
  gst_buffer_pool_set_active(pool, FALSE);
}
GST_END_TEST;

static Suite* calibdetect_async_suite() {
  Suite* suite = suite_create("calibdetect_async");
  TCase* tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_checked_fixture(tc, gst::register_metas, nullptr);
  tcase_add_loop_test(tc, test_whoever_draws_on_the_frame_does_not_disturb, 0,
                      G_N_ELEMENTS(kFormats));
  tcase_add_loop_test(tc, test_a_frame_from_a_small_pool_goes_back_at_once, 0, 2);
  return suite;
}

GST_CHECK_MAIN(calibdetect_async)
