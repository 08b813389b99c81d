// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibrig: frames of several cameras pass, whatever becomes of the others, and where the cameras
// stand comes out as it is.

#include <chrono>
#include <cmath>
#include <cstring>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "calvin/io/calibration_io.hpp"
#include "calvin/io/rig_io.hpp"
#include "common/calibration_event.hpp"
#include "rig_fixture.hpp"

#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>

using namespace calvin;

using check::RigFixture;
using rig_views::SeenByCamera;

GST_START_TEST(test_two_cameras_stand_where_they_are) {
  RigFixture f(rig_views::stereo());
  const std::string location = f.folder / "rig.json";
  gst_element_set_state(f.element, GST_STATE_NULL);
  g_object_set(f.element, "location", location.c_str(), nullptr);
  // Of another session: it is kept.
  fail_unless(g_file_set_contents(location.c_str(), "{\"another\": 1}", -1, nullptr));
  f.run();
  const GstStructure* result = f.final_result();
  fail_unless(result != nullptr);
  int cameras = 0;
  gst_structure_get_int(result, "cameras", &cameras);
  fail_unless_equals_int(cameras, 2);
  const auto rig = read_rig(location);
  fail_unless(rig.has_value());
  fail_unless(f.worst(*rig) < 5, "%f sigmas", f.worst(*rig));
  g_autofree char* kept = nullptr;
  fail_unless(g_file_get_contents((location + "~").c_str(), &kept, nullptr, nullptr));
  fail_unless_equals_string(kept, "{\"another\": 1}");
  const auto posted = parse_rig(gst_structure_get_string(result, "json"));
  fail_unless(posted.has_value() && print_rig(*posted).value() == print_rig(*rig).value());
  // Simulated pictures of one instant are a millisecond apart.
  guint64 pairing = 0;
  gst_structure_get_uint64(result, "pairing", &pairing);
  fail_unless_equals_uint64(pairing, GST_MSECOND);
  fail_unless(f.bus.texts(GST_MESSAGE_WARNING).empty());
}
GST_END_TEST;

// They see different sides of a box alone: without its being said that these are fixed to each
// other the rig is refused.
GST_START_TEST(test_cameras_that_look_at_each_other) {
  const bool is_said = __i__ > 0;
  RigFixture f(rig_views::before_a_box());
  const std::string location = f.folder / "rig.json";
  gst_element_set_state(f.element, GST_STATE_NULL);
  g_object_set(f.element, "location", location.c_str(), "fixed-boards", gboolean(is_said), nullptr);
  f.run();
  const auto rig = read_rig(location);
  fail_unless(rig.has_value() == is_said);
  if (!is_said) return;
  fail_unless(f.final_result() != nullptr);
  fail_unless_equals_int(rig->fixed_boards.size(), 3);
  fail_unless(f.worst(*rig) < 5, "%f sigmas", f.worst(*rig));
  fail_unless(f.bus.texts(GST_MESSAGE_WARNING).empty());
}
GST_END_TEST;

// Intrinsics that the pads are given, and that the views tell, too.
GST_START_TEST(test_estimates_intrinsics) {
  RigFixture f(rig_views::stereo());
  gst_element_set_state(f.element, GST_STATE_NULL);
  gst_util_set_object_arg(G_OBJECT(f.element), "estimate-intrinsics", "free");
  f.run();
  const GstStructure* result = f.final_result();
  fail_unless(result != nullptr);
  const auto rig = parse_rig(gst_structure_get_string(result, "json"));
  fail_unless(rig.has_value() && rig->cameras.size() == 2);
  fail_unless(f.worst(*rig) < 5, "%f sigmas", f.worst(*rig));
  for (const RigCamera& camera : rig->cameras) {
    for (std::size_t i = 0; i < 4; ++i) {
      fail_unless(camera.calibration.parameters[i].sigma.value_or(0) > 0);
    }
    fail_unless(camera.calibration.expected_error.value_or(1e9) < 1);
  }
}
GST_END_TEST;

GST_START_TEST(test_four_cameras_of_different_lenses_and_sizes) {
  RigFixture f(rig_views::ring());
  f.run();
  const GstStructure* result = f.final_result();
  fail_unless(result != nullptr);
  const auto rig = parse_rig(gst_structure_get_string(result, "json"));
  fail_unless(rig.has_value() && rig->cameras.size() == 4);
  fail_unless(f.worst(*rig) < 5, "%f sigmas", f.worst(*rig));
  // The rig went downstream on every pad, ahead of the end.
  for (GstHarness* h : f.harnesses) {
    bool told = false;
    while (GstEvent* event = gst_harness_try_pull_event(h)) {
      told = told || gst_event_has_name(event, "calvin-rig");
      gst_event_unref(event);
    }
    fail_unless(told || h != f.harnesses.back());
  }
}
GST_END_TEST;

// The distance between the cameras is known, and boards are 2 % smaller than they say: the rig is
// as large as the distance says, in every file, and the cameras are not taken for pushed.
GST_START_TEST(test_a_known_distance_sets_the_scale) {
  RigFixture f(rig_views::stereo());
  const double truth =
      (f.cameras[0].world_from_camera.translation - f.cameras[1].world_from_camera.translation)
          .norm();
  const double wanted = 0.98 * truth;
  gst_element_set_state(f.element, GST_STATE_NULL);
  g_object_set(f.element, "location", (f.folder / "rig.json").c_str(), "baseline",
               ("cam0:cam1:" + std::to_string(1000 * wanted) + "mm:0.01mm").c_str(), "export",
               ("mrcal:" + f.folder / "models" + ",opencv:" + f.folder / "stereo.yml").c_str(),
               nullptr);
  f.run();
  const GstStructure* result = f.final_result();
  fail_unless(result != nullptr);
  double scale = 0;
  double sigma = 0;
  fail_unless(gst_structure_get_double(result, "board-scale", &scale));
  fail_unless(gst_structure_get_double(result, "board-scale-sigma", &sigma));
  fail_unless(std::abs(scale - 0.98) < 5 * sigma && sigma < 0.003, "%f +- %f", scale, sigma);
  fail_unless(std::strstr(gst_structure_get_string(result, "remarks"), "smaller") != nullptr);
  const auto distance = [](const Rig& rig) {
    return (to_se3(rig.cameras[0].rig_from_camera).translation -
            to_se3(rig.cameras[1].rig_from_camera).translation)
        .norm();
  };
  const auto rig = read_rig(f.folder / "rig.json");
  fail_unless(rig.has_value() && std::abs(distance(*rig) - wanted) < 5e-5);
  const auto models = read_rig(f.folder / "models");
  fail_unless(models.has_value() && std::abs(distance(*models) - distance(*rig)) < 1e-9);
  fail_unless(g_file_test((f.folder / "stereo.yml").c_str(), G_FILE_TEST_EXISTS));
  fail_unless(f.bus.named("calib-rig-moved").empty());
  fail_unless(f.bus.texts(GST_MESSAGE_WARNING).empty());
}
GST_END_TEST;

// What cannot be meant is an error at the start.
GST_START_TEST(test_wrong_distances_and_exports_are_refused) {
  struct Case {
    const char* property;
    const char* text;
    const char* told;
  };
  constexpr Case kCases[] = {
      {"baseline", "cam0:cam1", "cam0:cam1"},
      {"baseline", "cam0:top:1m", "no distance between 'cam0' and 'top'"},
      {"export", "pdf:a.pdf", "pdf:a.pdf"},
      {"export", "mrcal", "mrcal"},
  };
  for (const auto& [property, text, told] : kCases) {
    RigFixture f(rig_views::stereo());
    gst_element_set_state(f.element, GST_STATE_NULL);
    g_object_set(f.element, property, text, nullptr);
    fail_unless(gst_element_set_state(f.element, GST_STATE_PAUSED) == GST_STATE_CHANGE_FAILURE);
    fail_unless(f.bus.says(GST_MESSAGE_ERROR, told));
  }
}
GST_END_TEST;

// A progress tells who has seen what with whom, before there is any result.
GST_START_TEST(test_progress_tells_links_and_the_weakest) {
  RigFixture f(rig_views::stereo());
  f.start();
  f.push_all();
  const auto progress = f.bus.named("calib-rig-progress");
  fail_unless(progress.size() > 5);
  const GstStructure* last = progress.back();
  fail_unless_equals_string(gst_structure_get_string(last, "weakest"), "cam0 cam1");
  const GValue* links = gst_structure_get_value(last, "links");
  fail_unless(GST_VALUE_HOLDS_ARRAY(links));
  fail_unless_equals_int(gst_value_array_get_size(links), 1);
  f.end_all();
}
GST_END_TEST;

// The calibration of a calibrate upstream will do.
GST_START_TEST(test_intrinsics_come_with_the_event) {
  RigFixture f(rig_views::stereo(), false);
  f.start();
  for (std::size_t c = 0; c < 2; ++c) {
    const auto json = print_calibration(f.cameras[c].calibration);
    gst_harness_push_event(f.harnesses[c], gst::new_calibration_event({"x", *json}));
  }
  f.push_all();
  f.end_all();
  fail_unless(f.final_result() != nullptr);
}
GST_END_TEST;

// One camera ends, or restarts: the others go on, and the last one's end is the session's.
GST_START_TEST(test_the_end_of_one_camera_is_not_that_of_the_rig) {
  RigFixture f(rig_views::stereo());
  f.start();
  f.push_all();
  gst_harness_push_event(f.harnesses[0], gst_event_new_eos());
  fail_unless(f.final_result() == nullptr);
  g_autoptr(GstBuffer) passed = f.push(1, {}, 50 * GST_SECOND);
  fail_unless(passed != nullptr);
  gst_harness_push_event(f.harnesses[1], gst_event_new_eos());
  fail_unless(f.final_result() != nullptr);
}
GST_END_TEST;

// Frames pass as they came, on a pad whose neighbour gets none at all.
GST_START_TEST(test_no_pad_waits_for_another) {
  RigFixture f(rig_views::ring());
  f.start();
  for (int n = 0; n < 50; ++n) {
    GstBuffer* buffer = gst_buffer_new_allocate(nullptr, 1280 * 960, nullptr);
    GST_BUFFER_PTS(buffer) = static_cast<guint64>(n) * GST_SECOND / 30;
    g_autoptr(GstBuffer) out = gst_harness_push_and_pull(f.harnesses[0], buffer);
    fail_unless(out == buffer);
  }
}
GST_END_TEST;

// Rendered, found, paired and solved: two cameras that do not exist, in one pipeline.
GST_START_TEST(test_rendered_cameras_stand_where_they_are) {
  check::TemporaryFolder folder;
  const auto cameras = rig_views::stereo();
  Rig truth;
  for (const SeenByCamera& camera : cameras) {
    truth.cameras.push_back({camera.calibration, to_pose(camera.world_from_camera), {}, {}});
  }
  truth.world = "cam0";
  const std::string studio = folder / "studio.json";
  fail_unless(write_rig(studio, truth).has_value());
  std::string rig_launch = "calibrig name=rig location=" + (folder / "rig.json");
  std::string camera_launch;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    const std::string number = std::to_string(c);
    const std::string file = folder / ("cam" + number + ".json").c_str();
    fail_unless(write_calibration(file, cameras[c].calibration).has_value());
    rig_launch += " sink_" + number + "::intrinsics=" + file;
    camera_launch += " calibtestsrc num-buffers=20 rig=" + studio + " camera=cam" + number +
                     " ! calibdetect ! rig.sink_" + number;
  }
  const std::string launch = rig_launch + camera_launch;
  g_autoptr(GstElement) pipeline = gst_parse_launch(launch.c_str(), nullptr);
  g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  // A minute under a sanitizer. A check that gives up leaves the pipeline behind, and the next one
  // waits for its threads in gst_task_cleanup_all().
  g_autoptr(GstMessage) end = gst_bus_timed_pop_filtered(
      bus, 600 * GST_SECOND, static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR));
  fail_unless(end != nullptr);
  g_autoptr(GError) error = nullptr;
  if (GST_MESSAGE_TYPE(end) == GST_MESSAGE_ERROR) gst_message_parse_error(end, &error, nullptr);
  fail_if(error != nullptr, "%s", error != nullptr ? error->message : "");
  gst_bus_set_flushing(bus, TRUE);
  gst_element_set_state(pipeline, GST_STATE_NULL);
  const auto rig = read_rig(folder / "rig.json");
  fail_unless(rig.has_value());
  const double worst = rig_views::worst_error(*rig, cameras);
  fail_unless(worst < 5, "%f sigmas", worst);
  fail_unless(rig->rms.value() < 0.1, "%f px", rig->rms.value());
}
GST_END_TEST;

// Nobody is linked behind one camera, or behind any: the rig is found and the pipeline ends.
GST_START_TEST(test_sources_need_not_be_linked) {
  const std::string launch =
      "calibrig name=rig calibtestsrc num-buffers=12 ! calibdetect ! rig.sink_0 "
      "calibtestsrc num-buffers=12 ! calibdetect ! rig.sink_1 ";
  g_autoptr(GstElement) pipeline =
      gst_parse_launch((launch + (__i__ == 0 ? "rig.src_0 ! fakesink" : "")).c_str(), nullptr);
  g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  g_autoptr(GstMessage) end = gst_bus_timed_pop_filtered(
      bus, 60 * GST_SECOND, static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR));
  fail_unless(end != nullptr && GST_MESSAGE_TYPE(end) == GST_MESSAGE_EOS);
  gst_bus_set_flushing(bus, TRUE);
  gst_element_set_state(pipeline, GST_STATE_NULL);
}
GST_END_TEST;

// State cycles, flushes and pads that come and go while frames flow.
GST_START_TEST(test_states_flushes_and_pads) {
  RigFixture f(rig_views::stereo());
  f.start();
  f.push_all();
  for (GstHarness* h : f.harnesses) {
    gst_harness_push_event(h, gst_event_new_flush_start());
    gst_harness_push_event(h, gst_event_new_flush_stop(TRUE));
    GstSegment segment;
    gst_segment_init(&segment, GST_FORMAT_TIME);
    gst_harness_push_event(h, gst_event_new_segment(&segment));
  }
  g_autoptr(GstBuffer) after = f.push(0, {}, 0);
  fail_unless(after != nullptr);
  g_autoptr(GstPad) third = gst_element_request_pad_simple(f.element, "sink_%u");
  fail_unless_equals_string(GST_PAD_NAME(third), "sink_2");
  gst_element_release_request_pad(f.element, third);
  gst_element_set_state(f.element, GST_STATE_NULL);
  gst_element_set_state(f.element, GST_STATE_PLAYING);
  fail_unless(f.bus.texts(GST_MESSAGE_ERROR).empty());
}
GST_END_TEST;

static Suite* calibrig_suite(void) {
  Suite* s = suite_create("calibrig");
  TCase* tc = tcase_create("general");
  suite_add_tcase(s, tc);
  tcase_set_timeout(tc, 120);
  tcase_add_test(tc, test_two_cameras_stand_where_they_are);
  tcase_add_loop_test(tc, test_cameras_that_look_at_each_other, 0, 2);
  tcase_add_test(tc, test_estimates_intrinsics);
  tcase_add_test(tc, test_four_cameras_of_different_lenses_and_sizes);
  tcase_add_test(tc, test_a_known_distance_sets_the_scale);
  tcase_add_test(tc, test_wrong_distances_and_exports_are_refused);
  tcase_add_test(tc, test_progress_tells_links_and_the_weakest);
  tcase_add_test(tc, test_intrinsics_come_with_the_event);
  tcase_add_test(tc, test_the_end_of_one_camera_is_not_that_of_the_rig);
  tcase_add_test(tc, test_no_pad_waits_for_another);
  tcase_add_test(tc, test_rendered_cameras_stand_where_they_are);
  tcase_add_loop_test(tc, test_sources_need_not_be_linked, 0, 2);
  tcase_add_test(tc, test_states_flushes_and_pads);
  return s;
}

GST_CHECK_MAIN(calibrig);
