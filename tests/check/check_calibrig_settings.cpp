// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What calibrig makes of its settings and of its pads.

#include <string>
#include <vector>

#include "calvin/io/board_names.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/io/rig_io.hpp"
#include "common/calibration_event.hpp"
#include "pipeline.hpp"
#include "rig_fixture.hpp"

#include <gst/check/gstcheck.h>

using namespace calvin;

using check::RigFixture;
using rig_views::SeenByCamera;

// Equal boards are the same however they are spelled, as they are for calibdetect.
GST_START_TEST(test_a_board_counts_in_any_spelling) {
  RigFixture f(rig_views::stereo());
  const std::string names = f.folder / "boards.json";
  const std::string shown = f.cameras[0].observations[0].board;
  fail_unless(add_board(names, "desk", shown).has_value());
  const std::string spellings[] = {names + "#desk", "checkerboard:9x6:2.5cm",
                                   "charuco:5x7:100mm:70mm:DICT_5X5_100;" + shown, "auto"};
  gst_element_set_state(f.element, GST_STATE_NULL);
  g_object_set(f.element, "board", spellings[__i__].c_str(), nullptr);
  f.run();
  fail_unless(f.final_result() != nullptr);
  fail_unless(f.bus.texts(GST_MESSAGE_WARNING).empty());
}
GST_END_TEST;

// Who asked for another board than the one that is shown hears which one was seen.
GST_START_TEST(test_another_board_is_named) {
  RigFixture f(rig_views::stereo());
  gst_element_set_state(f.element, GST_STATE_NULL);
  g_object_set(f.element, "board", "checkerboard:9x6:30mm", nullptr);
  f.run();
  fail_unless(f.final_result() == nullptr);
  const auto texts = f.bus.texts(GST_MESSAGE_WARNING);
  fail_unless_equals_int(texts.size(), 1);
  const char* const words =
      "'cam0' has seen checkerboard:9x6:25mm, and board= says "
      "checkerboard:9x6:30mm";
  fail_unless(texts[0].find(words) != std::string::npos, "%s", texts[0].c_str());
}
GST_END_TEST;

// As calibdetect refuses them.
GST_START_TEST(test_a_text_that_is_no_board_is_an_error_at_the_start) {
  const char* const texts[] = {"foo", "auto:25parsec", "/nowhere/boards.json#desk"};
  RigFixture f(rig_views::stereo());
  gst_element_set_state(f.element, GST_STATE_NULL);
  g_object_set(f.element, "board", texts[__i__], nullptr);
  fail_unless_equals_int(gst_element_set_state(f.element, GST_STATE_PAUSED),
                         GST_STATE_CHANGE_FAILURE);
  fail_unless_equals_int(f.bus.texts(GST_MESSAGE_ERROR).size(), 1);
}
GST_END_TEST;

// What is wrong with the cameras that are linked is said before a session is lost by it.
GST_START_TEST(test_what_no_rig_comes_of_is_an_error_at_the_start) {
  struct Case {
    std::vector<SeenByCamera> (*cameras)();
    const char* property;  // of the element, or of a pad
    const char* value;
    const char* word;  // of the error; nullptr: none
  };
  const Case cases[] = {
      {rig_views::stereo, "sink_1::camera", "cam0", "are called 'cam0'"},
      {rig_views::stereo, "sink_1::camera", "left", nullptr},
      {rig_views::stereo, "world", "foo", "'foo', which is none of its cameras"},
      {rig_views::stereo, "world", "cam1", nullptr},
      {rig_views::stereo, "world", "board:x180", nullptr},
      {rig_views::ring, "mode", "stereo", "has two cameras, and 4 are linked"},
      {rig_views::stereo, "mode", "stereo", nullptr},
      {rig_views::ring, "baseline", "110mm", "name two of them"},
      {rig_views::stereo, "baseline", "110mm", nullptr},
      {rig_views::ring, "baseline", "cam0:foo:110mm", "between 'cam0' and 'foo'"},
      {rig_views::ring, "baseline", "cam0:cam3:110mm", nullptr},
  };
  for (const Case& c : cases) {
    RigFixture f(c.cameras());
    gst_element_set_state(f.element, GST_STATE_NULL);
    if (std::string(c.property).find("::") == std::string::npos) {
      gst_util_set_object_arg(G_OBJECT(f.element), c.property, c.value);
    } else {
      gst_child_proxy_set(GST_CHILD_PROXY(f.element), c.property, c.value, nullptr);
    }
    const auto changed = gst_element_set_state(f.element, GST_STATE_PAUSED);
    fail_unless((changed == GST_STATE_CHANGE_FAILURE) == (c.word != nullptr), "%s", c.value);
    const auto texts = f.bus.texts(GST_MESSAGE_ERROR);
    fail_unless_equals_int(texts.size(), c.word != nullptr ? 1 : 0);
    if (c.word == nullptr) continue;
    fail_unless(texts[0].find(c.word) != std::string::npos, "%s", texts[0].c_str());
  }
}
GST_END_TEST;

// A camera that comes later and with which no rig would come of the others costs them nothing: it
// is left out, which is said when it comes. Its frames pass.
GST_START_TEST(test_a_camera_that_does_not_go_with_the_others_is_left_out) {
  const bool is_stereo = __i__ > 0;
  RigFixture f(rig_views::stereo());
  gst_element_set_state(f.element, GST_STATE_NULL);
  if (is_stereo) gst_util_set_object_arg(G_OBJECT(f.element), "mode", "stereo");
  f.start();
  f.cameras.push_back(f.cameras[1]);
  f.harnesses.push_back(gst_harness_new_with_element(f.element, "sink_2", "src_2"));
  if (!is_stereo) {
    gst_child_proxy_set(GST_CHILD_PROXY(f.element), "sink_2::camera", "cam1", nullptr);
  }
  gst_harness_set_src_caps(f.harnesses[2],
                           check::caps_of("GRAY8", f.cameras[2].calibration.image_size));
  const auto texts = f.bus.texts(GST_MESSAGE_WARNING);
  fail_unless_equals_int(texts.size(), 1);
  fail_unless(texts[0].find("sink_2, which came later, is left out") != std::string::npos, "%s",
              texts[0].c_str());
  f.push_all();
  f.end_all();
  const GstStructure* result = f.final_result();
  fail_unless(result != nullptr);
  int cameras = 0;
  gst_structure_get_int(result, "cameras", &cameras);
  fail_unless_equals_int(cameras, 2);
  fail_unless_equals_int(gst_value_array_get_size(gst_structure_get_value(result, "missing")), 0);
}
GST_END_TEST;

// A pad that nobody is linked to is no camera, whenever it was requested: nobody waits for it.
GST_START_TEST(test_a_pad_that_is_never_linked_holds_nobody_up) {
  const bool before = __i__ > 0;
  RigFixture f(rig_views::stereo());
  gst_element_set_state(f.element, GST_STATE_NULL);
  gst_util_set_object_arg(G_OBJECT(f.element), "mode", "stereo");
  g_autoptr(GstPad) early = before ? gst_element_request_pad_simple(f.element, "sink_%u") : nullptr;
  f.start();
  g_autoptr(GstPad) late = gst_element_request_pad_simple(f.element, "sink_%u");
  f.push_all();
  f.end_all();
  const GstStructure* result = f.final_result();
  fail_unless(result != nullptr);
  fail_unless_equals_int(gst_value_array_get_size(gst_structure_get_value(result, "missing")), 0);
  fail_unless(f.bus.texts(GST_MESSAGE_WARNING).empty());
}
GST_END_TEST;

// Linked while the others run it is one.
GST_START_TEST(test_a_pad_that_is_linked_later_is_a_camera) {
  RigFixture f(rig_views::stereo());
  gst_element_set_state(f.element, GST_STATE_NULL);
  g_autoptr(GstPad) pad = gst_element_request_pad_simple(f.element, "sink_2");
  const std::string file = f.folder / "cam1.json";
  g_object_set(pad, "camera", "top", "intrinsics", file.c_str(), nullptr);
  g_object_set(f.element, "world", "top", nullptr);
  f.start();
  f.cameras.push_back(f.cameras[1]);
  f.harnesses.push_back(gst_harness_new_with_element(f.element, "sink_2", "src_2"));
  gst_harness_set_src_caps(f.harnesses[2],
                           check::caps_of("GRAY8", f.cameras[2].calibration.image_size));
  f.push_all();
  f.end_all();
  const GstStructure* result = f.final_result();
  fail_unless(result != nullptr);
  fail_unless_equals_string(gst_structure_get_string(result, "world"), "top");
  const auto rig = parse_rig(gst_structure_get_string(result, "json"));
  fail_unless(rig.has_value() && rig->cameras.size() == 3);
}
GST_END_TEST;

// The pipeline ends, too, where this element is its last one.
GST_START_TEST(test_the_pipeline_ends_without_a_pad_that_is_never_linked) {
  check::Pipeline pipeline(
      "calibrig name=rig calibtestsrc num-buffers=3 ! rig.sink_0 "
      "calibtestsrc num-buffers=3 ! rig.sink_1");
  g_autoptr(GstPad) unlinked = gst_element_request_pad_simple(pipeline.get("rig"), "sink_%u");
  const auto progress = pipeline.play("calib-rig-progress");
  fail_unless(progress.empty());
}
GST_END_TEST;

// Nor does anybody wait for a pad that is released after the others have come to their end.
GST_START_TEST(test_a_camera_that_goes_holds_nobody_up) {
  RigFixture f(rig_views::ring());
  f.start();
  f.push_all();
  for (std::size_t c = 0; c < 3; ++c) {
    gst_harness_push_event(f.harnesses[c], gst_event_new_eos());
  }
  fail_unless(f.final_result() == nullptr);
  g_autoptr(GstPad) pad = gst_element_get_static_pad(f.element, "sink_3");
  gst_element_release_request_pad(f.element, pad);
  for (int n = 0; n < 600 && f.final_result() == nullptr; ++n) g_usleep(10 * 1000);
  const GstStructure* result = f.final_result();
  fail_unless(result != nullptr);
  int cameras = 0;
  gst_structure_get_int(result, "cameras", &cameras);
  fail_unless_equals_int(cameras, 3);
}
GST_END_TEST;

// What is set while the element runs is for the next start, as the warning says: also what is asked
// for at the end of a session alone.
GST_START_TEST(test_settings_stay_while_the_element_runs) {
  RigFixture f(rig_views::ring());
  const std::string before = f.folder / "before.json";
  const std::string later = f.folder / "later.json";
  gst_element_set_state(f.element, GST_STATE_NULL);
  g_object_set(f.element, "location", before.c_str(), nullptr);
  f.start();
  gst_util_set_object_arg(G_OBJECT(f.element), "mode", "stereo");
  g_object_set(f.element, "location", later.c_str(), "export",
               ("mrcal:" + f.folder / "models").c_str(), nullptr);
  gst_child_proxy_set(GST_CHILD_PROXY(f.element), "sink_1::camera", "left", nullptr);
  fail_unless_equals_int(f.bus.texts(GST_MESSAGE_WARNING).size(), 4);
  // Without a name it is the camera of the pad, which is called what it was called at the start.
  gst_harness_push_upstream_event(
      f.harnesses[1],
      gst_event_new_custom(GST_EVENT_CUSTOM_UPSTREAM, gst_structure_new_empty("calvin-reinsert")));
  f.push_all();
  f.end_all();
  const GstStructure* result = f.final_result();
  fail_unless(result != nullptr);
  fail_unless_equals_string(gst_structure_get_string(result, "location"), before.c_str());
  fail_unless(read_rig(before).has_value());
  fail_if(g_file_test(later.c_str(), G_FILE_TEST_EXISTS));
  fail_unless_equals_int(f.bus.texts(GST_MESSAGE_WARNING).size(), 4);
  fail_unless(f.bus.texts(GST_MESSAGE_ERROR).empty());
  // It is what the application reads, and what the next start takes.
  g_autofree char* location = nullptr;
  g_object_get(f.element, "location", &location, nullptr);
  fail_unless_equals_string(location, later.c_str());
}
GST_END_TEST;

// Intrinsics that a pad is given while it runs are for the next start; till then those that come
// from upstream count.
GST_START_TEST(test_intrinsics_of_a_pad_stay_while_it_runs) {
  RigFixture f(rig_views::stereo(), false);
  f.start();
  for (std::size_t c = 0; c < f.cameras.size(); ++c) {
    const std::string property = "sink_" + std::to_string(c) + "::intrinsics";
    gst_child_proxy_set(GST_CHILD_PROXY(f.element), property.c_str(), "/nowhere/cam.json", nullptr);
    const auto json = print_calibration(f.cameras[c].calibration);
    gst_harness_push_event(f.harnesses[c], gst::new_calibration_event({"x", *json}));
  }
  fail_unless_equals_int(f.bus.texts(GST_MESSAGE_WARNING).size(), f.cameras.size());
  f.push_all();
  f.end_all();
  fail_unless(f.final_result() != nullptr);
}
GST_END_TEST;

static Suite* calibrig_settings_suite(void) {
  Suite* s = suite_create("calibrig_settings");
  TCase* tc = tcase_create("general");
  suite_add_tcase(s, tc);
  tcase_set_timeout(tc, 120);
  tcase_add_loop_test(tc, test_a_board_counts_in_any_spelling, 0, 4);
  tcase_add_test(tc, test_another_board_is_named);
  tcase_add_loop_test(tc, test_a_text_that_is_no_board_is_an_error_at_the_start, 0, 3);
  tcase_add_test(tc, test_what_no_rig_comes_of_is_an_error_at_the_start);
  tcase_add_loop_test(tc, test_a_camera_that_does_not_go_with_the_others_is_left_out, 0, 2);
  tcase_add_loop_test(tc, test_a_pad_that_is_never_linked_holds_nobody_up, 0, 2);
  tcase_add_test(tc, test_a_pad_that_is_linked_later_is_a_camera);
  tcase_add_test(tc, test_the_pipeline_ends_without_a_pad_that_is_never_linked);
  tcase_add_test(tc, test_a_camera_that_goes_holds_nobody_up);
  tcase_add_test(tc, test_settings_stay_while_the_element_runs);
  tcase_add_test(tc, test_intrinsics_of_a_pad_stay_while_it_runs);
  return s;
}

GST_CHECK_MAIN(calibrig_settings);
