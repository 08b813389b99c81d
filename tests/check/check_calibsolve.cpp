// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibsolve: from observation metas to messages, files and the sticky event, and what it says
// when there is nothing to solve.

#include <algorithm>

#include "calvin/io/calibration_io.hpp"
#include "calvin_config.h"
#include "common/calibration_event.hpp"
#include "common/values.hpp"
#include "solve_fixture.hpp"

#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>

using namespace calvin;
using check::get;
using Fixture = check::SolveFixture;

GST_START_TEST(test_solves_at_eos_and_says_so) {
  Fixture f;
  f.push_views(25);
  f.eos();
  const GstStructure* r = f.result("final");
  fail_unless(r != nullptr);
  fail_unless_equals_string(gst_structure_get_string(r, "camera"), "left");
  fail_unless_equals_string(gst_structure_get_string(r, "model"), "brown5");
  const GstStructure* sigma = nullptr;
  gst_structure_get(r, "sigma", GST_TYPE_STRUCTURE, &sigma, nullptr);
  fail_unless(sigma != nullptr);
  const auto names = parameter_names("brown5");
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string name(names[i]);
    const double error = get(r, name.c_str()) - f.scene.camera.parameters()[i];
    const double s = get(sigma, name.c_str());
    fail_unless(std::abs(error) < 5 * s, "%s is off by %f, sigma %f", name.c_str(), error, s);
  }
  fail_unless(get(r, "rms") > 0.1 && get(r, "rms") < 0.2);
  fail_unless(get(r, "expected-error") > 0.05 && get(r, "expected-error") < 3, "%f",
              get(r, "expected-error"));
  int views = 0;
  gst_structure_get_int(r, "views", &views);
  fail_unless_equals_int(views, 25);
  const auto read = parse_calibration(gst_structure_get_string(r, "json"));
  fail_unless(read.has_value());
  fail_unless_equals_float(read->find("fx")->value, get(r, "fx"));
  fail_unless(f.result("intermediate") != nullptr);
  fail_unless(gst_structure_get_string(f.result("intermediate"), "json") == nullptr);
  fail_unless(f.bus.named("calib-progress").size() >= 25);
  fail_unless_equals_int(f.bus.named("calib-view").size(), 25);
  fail_unless(f.bus.texts(GST_MESSAGE_ERROR).empty());
  gst_structure_free(const_cast<GstStructure*>(sigma));
}
GST_END_TEST;

// Two views are four equations for the four numbers of a pinhole, where they are tilted apart.
GST_START_TEST(test_two_views_are_enough_where_they_differ) {
  for (const bool differ : {true, false}) {
    Fixture f("min-views=2 fix=k2,p1,p2,k3");
    gst_buffer_unref(f.push(0));
    gst_buffer_unref(f.push_observation(differ ? f.seen(5) : f.seen(0, 1), 5));
    f.eos();
    const GstStructure* r = f.result("final");
    if (differ) {
      fail_unless(r != nullptr);
      int views = 0;
      gst_structure_get_int(r, "views", &views);
      fail_unless_equals_int(views, 2);
      fail_unless(std::abs(get(r, "fx") / f.scene.camera.fx() - 1) < 0.05, "%f", get(r, "fx"));
    } else {
      fail_unless(r == nullptr);
      const auto warnings = f.bus.texts(GST_MESSAGE_WARNING);
      fail_unless_equals_int(warnings.size(), 1);
      fail_unless(warnings[0].find("same place") != std::string::npos, "%s", warnings[0].c_str());
      fail_unless(warnings[0].find("tilt") != std::string::npos, "%s", warnings[0].c_str());
    }
  }
}
GST_END_TEST;

GST_START_TEST(test_writes_its_files) {
  check::TemporaryFolder folder;
  Fixture f("location=" + folder / "cam.json" + " export=ros:" + folder / "ros.yaml" +
            ",opencv-xml:" + folder / "cv.xml" + " camera=right");
  f.push_views(12);
  f.eos();
  for (const char* name : {"cam.json", "ros.yaml", "cv.xml"}) {
    const auto read = read_calibration(folder / name);
    if (!CALVIN_HAVE_FORMATS && name != std::string("cam.json")) {
      // Such a build writes what it cannot read.
      fail_unless(read.error().code == ErrorCode::kUnsupported, "%s", name);
      continue;
    }
    fail_unless(read.has_value(), "%s", name);
    fail_unless_equals_int(read->image_size.width, 640);
    fail_unless(std::abs(read->find("fx")->value - f.scene.camera.fx()) < 5, "%s", name);
  }
  const auto native = read_calibration(folder / "cam.json");
  fail_unless_equals_string(native->camera.c_str(), "right");
  fail_unless_equals_int(native->views.size(), 12);
  fail_unless(!native->created.empty());
}
GST_END_TEST;

GST_START_TEST(test_the_file_is_there_before_eos) {
  check::TemporaryFolder folder;
  Fixture f("location=" + folder / "cam.json");
  f.push_views(12);
  // No EOS: a pipeline that is killed. The worker needs its time, nothing else happens.
  for (int i = 0; i < 500 && !read_calibration(folder / "cam.json"); ++i) g_usleep(10000);
  fail_unless(read_calibration(folder / "cam.json").has_value());
}
GST_END_TEST;

GST_START_TEST(test_the_event_precedes_eos_and_is_sticky) {
  Fixture f;
  f.push_views(10);
  f.eos();
  g_autoptr(GstPad) src = gst_element_get_static_pad(f.h->element, "src");
  g_autoptr(GstEvent) sticky = gst_pad_get_sticky_event(src, GST_EVENT_CUSTOM_DOWNSTREAM_STICKY, 0);
  fail_unless(sticky != nullptr);
  const auto event = gst::parse_calibration_event(sticky);
  fail_unless(event.has_value());
  fail_unless_equals_string(event->camera.c_str(), "left");
  fail_unless(parse_calibration(event->json).has_value());
}
GST_END_TEST;

GST_START_TEST(test_nothing_solved_is_an_error_only_where_a_file_was_asked_for) {
  check::TemporaryFolder folder;
  for (const int views : {0, 1, 2}) {
    Fixture silent;
    silent.push_views(views);
    silent.eos();
    fail_unless(silent.bus.texts(GST_MESSAGE_ERROR).empty());
    fail_unless(silent.bus.says(GST_MESSAGE_WARNING, "No calibration"), "%d views", views);

    Fixture f("location=" + folder / "none.json");
    f.push_views(views);
    f.eos();
    const char* why = views == 0   ? "no view of the board"
                      : views == 1 ? "only one view"
                                   : "only 2 views";
    fail_unless(f.bus.says(GST_MESSAGE_ERROR, why), "%d views", views);
    fail_if(std::filesystem::exists(folder / "none.json"));
  }
}
GST_END_TEST;

GST_START_TEST(test_the_same_view_again_and_again_is_an_error_with_a_reason) {
  check::TemporaryFolder folder;
  Fixture f("location=" + folder / "none.json");
  for (int i = 0; i < 10; ++i) gst_buffer_unref(f.push_observation(f.seen(3), i));
  f.eos();
  fail_unless(f.bus.says(GST_MESSAGE_ERROR, "No calibration: "));
  fail_unless(f.result("final") == nullptr);
}
GST_END_TEST;

GST_START_TEST(test_an_unwritable_location_warns_early_and_fails_late) {
  Fixture f("location=/nowhere/at/all/cam.json");
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "/nowhere/at/all"));
  f.push_views(10);
  f.eos();
  fail_unless(f.result("final") != nullptr);
  fail_unless(f.bus.says(GST_MESSAGE_ERROR, "/nowhere/at/all"));
}
GST_END_TEST;

GST_START_TEST(test_wrong_settings_are_errors_at_the_start) {
  static const struct {
    const char* property;
    const char* value;
    const char* says;
  } kWrong[] = {{"export", "pdf:a.pdf", "ros:camera.yaml"},
                {"export", "ros", "ros:camera.yaml"},
                {"export", "ros:", "ros:camera.yaml"},
                {"model", "brown17", "brown5"},
                {"fix", "k9", "k9"},
                {"max-views", "2", "min-views"}};
  for (const auto& wrong : kWrong) {
    const auto texts = check::errors_at_start("calibsolve", wrong.property, wrong.value);
    fail_unless(texts.size() == 1 && texts[0].find(wrong.says) != std::string::npos, "%s=%s",
                wrong.property, wrong.value);
  }
}
GST_END_TEST;

GST_START_TEST(test_manual_mode_takes_what_it_is_told_to) {
  Fixture f("capture-mode=manual");
  f.push_views(5);
  for (int n = 0; n < 8; ++n) {
    g_signal_emit_by_name(f.h->element, "capture-view");
    gst_buffer_unref(f.push(n));
  }
  g_autoptr(GstStructure) stats = nullptr;
  g_object_get(f.h->element, "stats", &stats, nullptr);
  int views = 0;
  gst_structure_get_int(stats, "views", &views);
  fail_unless_equals_int(views, 8);
  // One that was asked for in vain is answered, once; what nobody asked for is not rejected.
  const auto rejections = [&f] {
    const auto all = f.bus.named("calib-view");
    return std::ranges::count_if(all, [](const GstStructure* view) {
      return g_strcmp0(gst_structure_get_string(view, "reason"), "too-similar") == 0;
    });
  };
  fail_unless_equals_int(rejections(), 1);
  for (int n = 8; n < 12; ++n) gst_buffer_unref(f.push(n));
  fail_unless_equals_int(rejections(), 1);
  g_signal_emit_by_name(f.h->element, "capture-view");
  for (int n = 0; n < 3; ++n) gst_buffer_unref(f.push(7));
  fail_unless_equals_int(rejections(), 2);
  gboolean removed = FALSE;
  g_signal_emit_by_name(f.h->element, "remove-view", 7U, &removed);
  fail_unless(removed);
  g_signal_emit_by_name(f.h->element, "remove-view", 7U, &removed);
  fail_if(removed);
  g_signal_emit_by_name(f.h->element, "reset");
  g_autofree char* json = nullptr;
  g_object_get(f.h->element, "calibration", &json, nullptr);
  fail_unless(json == nullptr);
}
GST_END_TEST;

GST_START_TEST(test_max_views_and_target_error_end_the_session) {
  for (const char* limit : {"max-views=10", "target-error=1"}) {
    Fixture f(limit);
    for (int n = 0; n < 1000 && f.result("final") == nullptr; ++n) {
      gst_buffer_unref(f.push(n));
      g_usleep(30000);
    }
    const GstStructure* r = f.result("final");
    fail_unless(r != nullptr, "%s", limit);
    f.eos();
    fail_unless(f.result("final") == r, "%s: a second final result", limit);
  }
}
GST_END_TEST;

GST_START_TEST(test_views_survive_a_flush_and_not_a_new_size) {
  Fixture f;
  f.push_views(6);
  gst_harness_push_event(f.h, gst_event_new_flush_start());
  gst_harness_push_event(f.h, gst_event_new_flush_stop(TRUE));
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  gst_harness_push_event(f.h, gst_event_new_segment(&segment));
  g_autoptr(GstBuffer) out = f.push(6);
  fail_unless_equals_int(gst::read_guidance(out)->views, 7);
  gst_harness_set_src_caps(f.h, check::caps_of("GRAY8", {320, 240}));
  g_autoptr(GstBuffer) other = f.push(7);  // of the old size: not for this session
  fail_unless_equals_int(gst::read_guidance(other)->views, 0);
}
GST_END_TEST;

GST_START_TEST(test_a_late_observation_in_an_event_counts) {
  Fixture f;
  f.push_views(3);
  gst_harness_push_event(
      f.h, gst_event_new_custom(GST_EVENT_CUSTOM_DOWNSTREAM,
                                gst::observations_to_structure(std::vector{f.seen(8)})));
  g_autoptr(GstBuffer) out = f.push(9);
  fail_unless_equals_int(gst::read_guidance(out)->views, 5);
}
GST_END_TEST;

// A final solve that a flush cut short is owed, not lost.
GST_START_TEST(test_a_flush_does_not_lose_the_final_result) {
  check::TemporaryFolder folder;
  Fixture f("max-views=40 location=" + folder / "cam.json");
  f.push_views(40);
  gst_harness_push_event(f.h, gst_event_new_flush_start());
  gst_harness_push_event(f.h, gst_event_new_flush_stop(TRUE));
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  gst_harness_push_event(f.h, gst_event_new_segment(&segment));
  f.eos();
  fail_unless(f.result("final") != nullptr);
  fail_unless(f.bus.texts(GST_MESSAGE_ERROR).empty());
  fail_unless(read_calibration(folder / "cam.json").has_value());
}
GST_END_TEST;

GST_START_TEST(test_a_solve_that_was_asked_for_is_not_replaced_by_the_next) {
  Fixture f;
  f.push_views(20);
  g_signal_emit_by_name(f.element, "solve");
  for (int n = 20; n < 40; ++n) gst_buffer_unref(f.push(n));
  for (int i = 0; i < 1000 && f.result("final") == nullptr; ++i) g_usleep(10000);
  fail_unless(f.result("final") != nullptr);
}
GST_END_TEST;

GST_START_TEST(test_a_solve_of_a_session_that_was_reset_is_thrown_away) {
  Fixture f;
  f.push_views(60);
  g_signal_emit_by_name(f.element, "reset");
  const auto before = f.bus.named("calib-result").size();
  g_usleep(300000);
  fail_unless_equals_int(f.bus.named("calib-result").size(), before);
  g_autofree char* json = nullptr;
  g_object_get(f.element, "calibration", &json, nullptr);
  fail_unless(json == nullptr);
}
GST_END_TEST;

GST_START_TEST(test_solve_with_too_few_views_says_so) {
  Fixture f;
  f.push_views(2);
  g_signal_emit_by_name(f.element, "solve");
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "only 2 views"));
  fail_unless(f.result("final") == nullptr);
}
GST_END_TEST;

// A view of another camera, which only the solve can tell; in the first session, or in a second one
// where nothing is left of the views of the first.
GST_START_TEST(test_an_outlier_is_named_with_the_time_of_its_frame) {
  Fixture f;
  constexpr int kWrong = 5;
  if (__i__ == 1) {
    for (int n = 40; n < 50; ++n) gst_buffer_unref(f.push(n));
    g_signal_emit_by_name(f.element, "reset");
  }
  for (int n = 0; n < 16; ++n) gst_buffer_unref(f.push(n, n == kWrong ? 0.7 : 1));
  f.eos();
  int named = 0;
  for (const GstStructure* s : f.bus.named("calib-view")) {
    if (g_strcmp0(gst_structure_get_string(s, "reason"), "outlier") != 0) continue;
    guint64 timestamp = 0;
    gboolean accepted = TRUE;
    fail_unless(gst_structure_get_uint64(s, "timestamp", &timestamp));
    fail_unless(gst_structure_get_boolean(s, "accepted", &accepted) && !accepted);
    named += timestamp == kWrong * GST_SECOND / 30 ? 1 : 0;
  }
  fail_unless(named >= 1, "the outlier is not named");
  int views = 0;
  fail_unless(gst_structure_get_int(f.result("final"), "views", &views));
  fail_unless_equals_int(views, 15);
}
GST_END_TEST;

GST_START_TEST(test_a_removed_view_makes_room_for_another) {
  Fixture f("max-views=10");
  f.push_views(10);
  gboolean removed = FALSE;
  g_signal_emit_by_name(f.element, "remove-view", 3U, &removed);
  fail_unless(removed);
  g_autoptr(GstBuffer) out = f.push(11);
  fail_unless_equals_int(gst::read_guidance(out)->views, 10);
}
GST_END_TEST;

// Metas that somebody else wrote: nothing but silence is expected, and no crash.
GST_START_TEST(test_hostile_metas_are_ignored) {
  Fixture f;
  GstBuffer* buffer = gst_buffer_new_allocate(nullptr, 640 * 480, nullptr);
  Observation o = f.seen(0);
  o.board = "nonsense";
  Observation nan = f.seen(1);
  nan.uv[3].u = std::nan("");
  Observation twice = f.seen(2);
  twice.ids[1] = twice.ids[0];
  Observation beyond = f.seen(3);
  beyond.ids[0] = 1000;
  gst::attach_observations(buffer, std::vector{o, nan, twice, beyond});
  g_autoptr(GstBuffer) out = gst_harness_push_and_pull(f.h, buffer);
  fail_unless_equals_int(gst::read_guidance(out)->views, 0);
}
GST_END_TEST;

static Suite* calibsolve_suite() {
  Suite* suite = suite_create("calibsolve");
  TCase* tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_checked_fixture(tc, gst::register_metas, nullptr);
  tcase_add_test(tc, test_solves_at_eos_and_says_so);
  tcase_add_test(tc, test_two_views_are_enough_where_they_differ);
  tcase_add_test(tc, test_writes_its_files);
  tcase_add_test(tc, test_the_file_is_there_before_eos);
  tcase_add_test(tc, test_the_event_precedes_eos_and_is_sticky);
  tcase_add_test(tc, test_nothing_solved_is_an_error_only_where_a_file_was_asked_for);
  tcase_add_test(tc, test_the_same_view_again_and_again_is_an_error_with_a_reason);
  tcase_add_test(tc, test_an_unwritable_location_warns_early_and_fails_late);
  tcase_add_test(tc, test_wrong_settings_are_errors_at_the_start);
  tcase_add_test(tc, test_manual_mode_takes_what_it_is_told_to);
  tcase_add_test(tc, test_max_views_and_target_error_end_the_session);
  tcase_add_test(tc, test_views_survive_a_flush_and_not_a_new_size);
  tcase_add_test(tc, test_a_late_observation_in_an_event_counts);
  tcase_add_test(tc, test_a_flush_does_not_lose_the_final_result);
  tcase_add_test(tc, test_a_solve_that_was_asked_for_is_not_replaced_by_the_next);
  tcase_add_test(tc, test_a_solve_of_a_session_that_was_reset_is_thrown_away);
  tcase_add_test(tc, test_solve_with_too_few_views_says_so);
  tcase_add_loop_test(tc, test_an_outlier_is_named_with_the_time_of_its_frame, 0, 2);
  tcase_add_test(tc, test_a_removed_view_makes_room_for_another);
  tcase_add_test(tc, test_hostile_metas_are_ignored);
  return suite;
}

GST_CHECK_MAIN(calibsolve)
