// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibrig where something is missing: what can be found is, and what is missing is said.

#include <cstring>
#include <string>

#include "calvin/io/rig_io.hpp"
#include "rig_fixture.hpp"

#include <gst/check/gstcheck.h>

using namespace calvin;

using check::RigFixture;

// What is missing is said at the end: an error where a file was asked for.
GST_START_TEST(test_the_end_without_a_rig_says_what_is_missing) {
  struct Case {
    bool intrinsics;
    bool both;
    GstClockTime clock_error;
    const char* word;
  };
  constexpr Case kCases[] = {{false, true, 0, "intrinsics=FILE"},
                             {true, false, 0, "has seen no board"},
                             {true, true, GST_SECOND / 2, "seen no board at the same time"}};
  for (const bool wants_file : {false, true}) {
    const Case& c = kCases[__i__];
    RigFixture f(rig_views::stereo(), c.intrinsics, c.clock_error);
    if (wants_file) {
      g_object_set(f.element, "location", (f.folder / "rig.json").c_str(), nullptr);
    }
    f.start();
    f.push_all(c.both ? 1000 : 1);
    f.end_all();
    const auto texts = f.bus.texts(wants_file ? GST_MESSAGE_ERROR : GST_MESSAGE_WARNING);
    fail_unless_equals_int(texts.size(), 1);
    fail_unless(texts[0].find(c.word) != std::string::npos, "%s", texts[0].c_str());
    fail_unless(f.final_result() == nullptr);
  }
}
GST_END_TEST;

GST_START_TEST(test_intrinsics_that_cannot_be_read_are_an_error) {
  RigFixture f(rig_views::stereo(), false);
  gst_element_set_state(f.element, GST_STATE_NULL);
  gst_child_proxy_set(GST_CHILD_PROXY(f.element), "sink_1::intrinsics", "/nowhere/cam.json",
                      "sink_1::camera", "right", nullptr);
  fail_unless_equals_int(gst_element_set_state(f.element, GST_STATE_PAUSED),
                         GST_STATE_CHANGE_FAILURE);
  const auto texts = f.bus.texts(GST_MESSAGE_ERROR);
  fail_unless_equals_int(texts.size(), 1);
  fail_unless(texts[0].find("'right'") != std::string::npos, "%s", texts[0].c_str());
}
GST_END_TEST;

// What no view could mend is said before there is one.
GST_START_TEST(test_settings_that_contradict_each_other_are_an_error) {
  struct Case {
    const char* settings[3][2];
    const char* word;  // of the error; nullptr: none
  };
  constexpr Case kCases[] = {
      {{{"mode", "floor"}, {"estimate-intrinsics", "free"}}, "not their intrinsics"},
      {{{"mode", "floor"}, {"estimate-intrinsics", "prior"}}, "not their intrinsics"},
      {{{"method", "svoboda"}, {"estimate-intrinsics", "free"}}, "estimate-intrinsics=no"},
      {{{"board", "dot"}, {"estimate-intrinsics", "prior"}}, "estimate-intrinsics=no"},
      {{{"board", "wand:150mm+350mm"}, {"estimate-intrinsics", "free"}}, "estimate-intrinsics=no"},
      {{{"board", "dot"}, {"mode", "floor"}}, "no floor"},
      {{{"board", "dot"}, {"world", "cam0"}}, "places give the frame"},
      {{{"board", "dot"}, {"baseline", "110mm"}}, "with the names of its cameras"},
      {{{"board", "dot"}, {"method", "boards"}, {"estimate-intrinsics", "free"}}, nullptr},
      {{{"board", "checkerboard:9x6:25mm"}, {"estimate-intrinsics", "free"}}, nullptr},
      {{{"mode", "floor"}}, nullptr}};
  for (const Case& c : kCases) {
    RigFixture f(rig_views::stereo());
    for (const auto& [name, value] : c.settings) {
      if (name != nullptr) gst_util_set_object_arg(G_OBJECT(f.element), name, value);
    }
    fail_unless_equals_int(gst_element_set_state(f.element, GST_STATE_NULL),
                           GST_STATE_CHANGE_SUCCESS);
    const auto changed = gst_element_set_state(f.element, GST_STATE_PAUSED);
    fail_unless((changed == GST_STATE_CHANGE_FAILURE) == (c.word != nullptr));
    const auto texts = f.bus.texts(GST_MESSAGE_ERROR);
    fail_unless_equals_int(texts.size(), c.word != nullptr ? 1 : 0);
    if (c.word != nullptr) {
      fail_unless(texts[0].find(c.word) != std::string::npos, "%s", texts[0].c_str());
    }
  }
}
GST_END_TEST;

// A camera that is linked and sees nothing keeps the others from nothing: it is named, with why.
GST_START_TEST(test_a_camera_that_sees_nothing_is_left_out) {
  RigFixture f(rig_views::ring());
  g_object_set(f.element, "location", (f.folder / "rig.json").c_str(), nullptr);
  f.start();
  f.push_all(2);
  f.end_all();
  const GstStructure* result = f.final_result();
  fail_unless(result != nullptr);
  int cameras = 0;
  gst_structure_get_int(result, "cameras", &cameras);
  fail_unless_equals_int(cameras, 3);
  const GValue* missing = gst_structure_get_value(result, "missing");
  fail_unless_equals_int(gst_value_array_get_size(missing), 1);
  const GstStructure* one = gst_value_get_structure(gst_value_array_get_value(missing, 0));
  fail_unless_equals_string(gst_structure_get_string(one, "camera"), "cam2");
  fail_unless(std::strstr(gst_structure_get_string(one, "reason"), "has seen no board") != nullptr);
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "'cam2' is not in the rig"));
  fail_unless(f.bus.texts(GST_MESSAGE_ERROR).empty());
  const auto rig = read_rig(f.folder / "rig.json");
  fail_unless(rig.has_value());
  f.cameras.erase(f.cameras.begin() + 2);
  fail_unless(f.worst(*rig) < 5, "%f sigmas", f.worst(*rig));
}
GST_END_TEST;

// A camera whose pictures change their size before the end has seen nothing at that size: the rig
// that was found before stays, and is the final one.
GST_START_TEST(test_a_rig_stays_where_the_last_solve_fails) {
  RigFixture f(rig_views::stereo());
  const std::string location = f.folder / "rig.json";
  g_object_set(f.element, "location", location.c_str(), nullptr);
  f.start();
  f.push_all();
  for (int n = 0; n < 600 && f.bus.named("calib-rig-result").empty(); ++n) g_usleep(10 * 1000);
  fail_unless(!f.bus.named("calib-rig-result").empty());
  Observation other = f.cameras[1].observations.front();
  for (Pixel& at : other.uv) at = {at.u / 2, at.v / 2};
  other.image_size = {f.cameras[1].calibration.image_size.width / 2,
                      f.cameras[1].calibration.image_size.height / 2};
  other.timestamp = 100 * GST_SECOND;
  gst_buffer_unref(f.push(1, {other}, other.timestamp));
  f.end_all();
  fail_unless(f.bus.texts(GST_MESSAGE_ERROR).empty());
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "the rig before it stays"));
  const GstStructure* result = f.final_result();
  fail_unless(result != nullptr);
  const auto rig = read_rig(location);
  fail_unless(rig.has_value());
  fail_unless(*print_rig(*rig) == gst_structure_get_string(result, "json"));
  fail_unless(f.worst(*rig) < 5, "%f sigmas", f.worst(*rig));
}
GST_END_TEST;

// Of no camera by that name nothing is inserted, and events of others go upstream.
GST_START_TEST(test_only_cameras_that_are_there_are_inserted_again) {
  RigFixture f(rig_views::stereo());
  f.start();
  gboolean done = TRUE;
  g_signal_emit_by_name(f.element, "reinsert", "nobody", &done);
  fail_if(done);
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "'nobody'"));
  g_signal_emit_by_name(f.element, "reinsert", "cam1", &done);
  fail_unless(done);
  const auto passes = [&](GstStructure* structure) {
    gst_harness_push_upstream_event(f.harnesses[0],
                                    gst_event_new_custom(GST_EVENT_CUSTOM_UPSTREAM, structure));
    bool found = false;
    while (GstEvent* event = gst_harness_try_pull_upstream_event(f.harnesses[0])) {
      found = found || GST_EVENT_TYPE(event) == GST_EVENT_CUSTOM_UPSTREAM;
      gst_event_unref(event);
    }
    return found;
  };
  fail_unless(passes(gst_structure_new_empty("something-else")));
  fail_if(passes(gst_structure_new("calvin-reinsert", "camera", G_TYPE_STRING, "cam1", nullptr)));
  fail_if(passes(gst_structure_new("calvin-reinsert", "camera", G_TYPE_STRING, "who", nullptr)));
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "'who'"));
}
GST_END_TEST;

static Suite* calibrig_failures_suite(void) {
  Suite* s = suite_create("calibrig_failures");
  TCase* tc = tcase_create("general");
  suite_add_tcase(s, tc);
  tcase_set_timeout(tc, 120);
  tcase_add_loop_test(tc, test_the_end_without_a_rig_says_what_is_missing, 0, 3);
  tcase_add_test(tc, test_intrinsics_that_cannot_be_read_are_an_error);
  tcase_add_test(tc, test_settings_that_contradict_each_other_are_an_error);
  tcase_add_test(tc, test_a_camera_that_sees_nothing_is_left_out);
  tcase_add_test(tc, test_a_rig_stays_where_the_last_solve_fails);
  tcase_add_test(tc, test_only_cameras_that_are_there_are_inserted_again);
  return s;
}

GST_CHECK_MAIN(calibrig_failures);
