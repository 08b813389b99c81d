// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The property `runs`: corners that are refined with the camera that they gave.

#include <map>
#include <string>

#include "calvin/detect/patches.hpp"
#include "solve_fixture.hpp"

#include <gst/check/gstcheck.h>

using namespace calvin;
using check::SolveFixture;

// What a poor detector sees of frame n: corners that are off by 0.1 px per coordinate.
static GstBuffer* poorly_seen(SolveFixture& f, int n, bool patches) {
  GstBuffer* buffer = check::frame_of(f.scene.picture(n), "GRAY8", n);
  Observation o = f.seen(n);
  o.timestamp = GST_BUFFER_PTS(buffer);
  if (patches) o.patches = cut_patches(f.scene.picture(n).view(), o, f.scene.board);
  gst::attach_observations(buffer, std::vector{o});
  return buffer;
}

// The RMS of the final result, px.
static double final_rms(const char* properties, bool patches) {
  SolveFixture f(properties);
  for (int n = 0; n < 8; ++n) {
    gst_buffer_unref(gst_harness_push_and_pull(f.h, poorly_seen(f, n, patches)));
  }
  f.eos();
  const GstStructure* result = f.result("final");
  fail_unless(result != nullptr, "%s", properties);
  return check::get(result, "rms");
}

GST_START_TEST(test_more_runs_leave_what_the_pictures_tell) {
  const double once = final_rms("runs=1", true);
  const double often = final_rms("runs=3", true);
  fail_unless(once > 0.1, "%f", once);
  fail_unless(often < 0.03, "%f", often);
  fail_unless_equals_float(final_rms("runs=3", false), once);
}
GST_END_TEST;

GST_START_TEST(test_calibdetect_sends_the_pixels_of_the_corners_along) {
  const check::Scene scene;
  GstHarness* h = check::harness_of(check::make_element("calibdetect mode=sync"));
  gst_harness_set_src_caps(h, check::caps_of("YUY2", scene.size));
  const GrayImage picture = scene.picture(3);
  // Not before somebody asks, as a calibsolve does that refines corners with the camera.
  g_autoptr(GstBuffer) bare = gst_harness_push_and_pull(h, check::frame_of(picture, "YUY2", 0));
  fail_unless(gst::read_observations(bare).at(0).patches == nullptr);
  fail_unless(gst_harness_push_upstream_event(
      h, gst_event_new_custom(GST_EVENT_CUSTOM_UPSTREAM,
                              gst_structure_new_empty(gst::kWantPatchesName))));
  GstBuffer* in = check::frame_of(picture, "YUY2", 0);
  g_autoptr(GstBuffer) out = gst_harness_push_and_pull(h, in);
  g_autoptr(GstBuffer) copy = gst_buffer_copy(out);
  gst_harness_teardown(h);
  const auto seen = gst::read_observations(copy).at(0);
  fail_unless(seen.found() && seen.patches);
  GstMapInfo map;
  fail_unless(gst_buffer_map(out, &map, GST_MAP_READ));
  for (std::size_t i = 0; i < seen.ids.size(); ++i) {
    const ImageView patch = patch_view(*seen.patches, i);
    const auto& [x, y] = seen.patches->origin[i];
    for (int row = 0; row < patch.height; ++row) {
      for (int column = 0; column < patch.width; ++column) {
        const int luma = map.data[2 * ((y + row) * scene.size.width + x + column)];
        fail_unless_equals_int(patch.at(column, row), luma);
      }
    }
  }
  gst_buffer_unmap(out, &map);
}
GST_END_TEST;

// How often since it was last looked at.
static int times_asked(SolveFixture& f) {
  int asked = 0;
  while (gst_harness_upstream_events_in_queue(f.h) > 0) {
    g_autoptr(GstEvent) event = gst_harness_pull_upstream_event(f.h);
    asked += gst_event_has_name(event, gst::kWantPatchesName) != FALSE ? 1 : 0;
  }
  return asked;
}

GST_START_TEST(test_calibsolve_asks_for_them_where_it_looks_again) {
  SolveFixture at_once("runs=2");
  fail_unless_equals_int(times_asked(at_once), 1);
  SolveFixture later("runs=1");
  later.push_views(2);
  fail_unless_equals_int(times_asked(later), 0);
  g_object_set(later.element, "runs", 3, nullptr);
  later.push_views(2);
  fail_unless_equals_int(times_asked(later), 1);
}
GST_END_TEST;

// Whoever writes the meta: patches that cannot be those of the corners are none.
GST_START_TEST(test_broken_patches_are_none) {
  SolveFixture f("runs=2");
  g_autoptr(GstBuffer) buffer = poorly_seen(f, 0, true);
  Observation o = gst::read_observations(buffer).at(0);
  auto broken = std::make_shared<CornerPatches>(*o.patches);
  broken->origin.pop_back();
  o.patches = broken;
  gst::attach_observations(buffer, std::vector{o});
  fail_unless(gst::read_observations(buffer).at(0).patches == nullptr);
}
GST_END_TEST;

static void count_notify(GObject* /*object*/, GParamSpec* spec, std::map<std::string, int>* seen) {
  ++(*seen)[spec->name];
}

// Two names of one setting, on the bin as well.
GST_START_TEST(test_refinements_are_runs_less_one) {
  for (const char* name : {"calibsolve", "calibrate"}) {
    g_autoptr(GstElement) element = gst_element_factory_make(name, nullptr);
    gst_object_ref_sink(element);
    std::map<std::string, int> seen;
    g_signal_connect(element, "notify", G_CALLBACK(count_notify), &seen);
    const auto value = [element](const char* property) {
      int found = -1;
      g_object_get(element, property, &found, nullptr);
      return found;
    };
    fail_unless_equals_int(value("refinements"), 0);
    g_object_set(element, "refinements", 4, nullptr);
    fail_unless_equals_int(value("runs"), 5);
    fail_unless(seen["runs"] > 0 && seen["refinements"] > 0);
    seen.clear();
    g_object_set(element, "runs", 3, nullptr);
    fail_unless_equals_int(value("refinements"), 2);
    fail_unless(seen["runs"] > 0 && seen["refinements"] > 0);
  }
}
GST_END_TEST;

static Suite* calibsolve_runs_suite() {
  Suite* suite = suite_create("calibsolve_runs");
  TCase* tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_checked_fixture(tc, gst::register_metas, nullptr);
  tcase_add_test(tc, test_more_runs_leave_what_the_pictures_tell);
  tcase_add_test(tc, test_refinements_are_runs_less_one);
  tcase_add_test(tc, test_calibdetect_sends_the_pixels_of_the_corners_along);
  tcase_add_test(tc, test_calibsolve_asks_for_them_where_it_looks_again);
  tcase_add_test(tc, test_broken_patches_are_none);
  return suite;
}

GST_CHECK_MAIN(calibsolve_runs)
