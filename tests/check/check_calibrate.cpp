// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibrate: the bin has what its children have, in any order of setting it up.

#include <dirent.h>
#include <sys/resource.h>

#include <cstdlib>

#include "pipeline.hpp"

#include <gst/check/gstcheck.h>

using namespace calvin;

static GstElement* own(GstElement* element) { return GST_ELEMENT(gst_object_ref_sink(element)); }

GST_START_TEST(test_settings_reach_the_children) {
  g_autoptr(GstElement) bin =
      own(check::make_element("calibrate board=checkerboard:7x5:1cm camera=left model=fisheye "
                              "capture-mode=manual max-rate=5 min-views=7 target-error=0.5"));
  g_autoptr(GstElement) detect = gst_bin_get_by_name(GST_BIN(bin), "detect");
  g_autoptr(GstElement) solve = gst_bin_get_by_name(GST_BIN(bin), "solve");
  g_autofree char* board = nullptr;
  g_autofree char* seen_as = nullptr;
  g_autofree char* solved_as = nullptr;
  g_autofree char* model = nullptr;
  double rate = 0;
  int views = 0;
  g_object_get(detect, "board", &board, "camera", &seen_as, "max-rate", &rate, nullptr);
  g_object_get(solve, "camera", &solved_as, "model", &model, "min-views", &views, nullptr);
  fail_unless_equals_string(board, "checkerboard:7x5:1cm");
  fail_unless_equals_string(seen_as, "left");
  fail_unless_equals_string(solved_as, "left");
  fail_unless_equals_string(model, "fisheye");
  fail_unless_equals_float(rate, 5);
  fail_unless_equals_int(views, 7);
  g_object_get(bin, "min-views", &views, nullptr);
  fail_unless_equals_int(views, 7);
  gst_child_proxy_set(GST_CHILD_PROXY(bin), "solve::min-views", 9, nullptr);
  g_object_get(bin, "min-views", &views, nullptr);
  fail_unless_equals_int(views, 9);
}
GST_END_TEST;

GST_START_TEST(test_every_default_is_the_childs) {
  g_autoptr(GstElement) bin = own(gst_element_factory_make("calibrate", nullptr));
  guint n = 0;
  g_autofree GParamSpec** specs = g_object_class_list_properties(G_OBJECT_GET_CLASS(bin), &n);
  for (guint i = 0; i < n; ++i) {
    if (specs[i]->owner_type != G_OBJECT_TYPE(bin) || specs[i]->value_type == GST_TYPE_STRUCTURE) {
      continue;
    }
    GValue value = G_VALUE_INIT;
    g_value_init(&value, specs[i]->value_type);
    g_object_get_property(G_OBJECT(bin), specs[i]->name, &value);
    fail_unless(g_param_value_defaults(specs[i], &value), "%s", specs[i]->name);
    g_value_unset(&value);
  }
}
GST_END_TEST;

GST_START_TEST(test_changes_of_a_child_are_notified) {
  g_autoptr(GstElement) bin = own(gst_element_factory_make("calibrate", nullptr));
  g_autoptr(GstElement) solve = gst_bin_get_by_name(GST_BIN(bin), "solve");
  int notified = 0;
  g_signal_connect(bin, "notify::calibration",
                   G_CALLBACK(+[](GObject*, GParamSpec*, int* count) { ++*count; }), &notified);
  g_object_notify(G_OBJECT(solve), "calibration");
  fail_unless_equals_int(notified, 1);
}
GST_END_TEST;

GST_START_TEST(test_the_overlay_can_be_left_out_and_put_back) {
  g_autoptr(GstElement) bin = own(gst_element_factory_make("calibrate", nullptr));
  for (const bool wanted : {false, false, true, false, true}) {
    g_object_set(bin, "overlay", wanted, nullptr);
    g_autoptr(GstElement) overlay = gst_bin_get_by_name(GST_BIN(bin), "overlay");
    fail_unless((overlay != nullptr) == wanted);
    g_autoptr(GstPad) src = gst_element_get_static_pad(bin, "src");
    g_autoptr(GstPad) target = gst_ghost_pad_get_target(GST_GHOST_PAD(src));
    g_autoptr(GstObject) parent = gst_object_get_parent(GST_OBJECT(target));
    fail_unless_equals_string(GST_OBJECT_NAME(parent), wanted ? "overlay" : "solve");
  }
}
GST_END_TEST;

// What is set of the overlay holds whether it is there or not.
GST_START_TEST(test_an_overlay_that_is_left_out_keeps_its_settings) {
  g_autoptr(GstElement) bin = own(gst_element_factory_make("calibrate", nullptr));
  const auto mirror = [&bin] {
    gboolean value = FALSE;
    g_object_get(bin, "mirror", &value, nullptr);
    return value != FALSE;
  };
  fail_if(mirror());
  g_object_set(bin, "mirror", TRUE, "overlay", FALSE, nullptr);
  fail_unless(mirror());
  g_object_set(bin, "ghost", FALSE, nullptr);
  g_object_set(bin, "overlay", TRUE, nullptr);
  fail_unless(mirror());
  g_autoptr(GstElement) overlay = gst_bin_get_by_name(GST_BIN(bin), "overlay");
  gboolean ghost = TRUE;
  g_object_get(overlay, "ghost", &ghost, nullptr);
  fail_if(ghost);
}
GST_END_TEST;

// Whoever takes a child out, or puts another in its place: the bin keeps nothing that is gone.
GST_START_TEST(test_children_may_be_taken_out) {
  for (const char* name : {"detect", "solve", "overlay"}) {
    g_autoptr(GstElement) bin = own(gst_element_factory_make("calibrate", nullptr));
    g_autoptr(GstElement) child = gst_bin_get_by_name(GST_BIN(bin), name);
    fail_unless(gst_bin_remove(GST_BIN(bin), child));
    g_clear_object(&child);
    gboolean removed = TRUE;
    g_object_set(bin, "board", "checkerboard:7x5:1cm", "min-views", 5, nullptr);
    for (const char* signal : {"reset", "solve", "capture-view"}) {
      g_signal_emit_by_name(bin, signal);
    }
    g_signal_emit_by_name(bin, "remove-view", 0U, &removed);
    fail_if(removed);
    g_autofree char* board = nullptr;
    g_autofree char* json = nullptr;
    g_object_get(bin, "board", &board, "calibration", &json, nullptr);
    // The detector and the solver know the board: whichever is left does.
    fail_unless_equals_string(board, "checkerboard:7x5:1cm");
    for (const bool wanted : {false, true}) g_object_set(bin, "overlay", wanted, nullptr);
    g_autoptr(GstElement) overlay = gst_bin_get_by_name(GST_BIN(bin), "overlay");
    fail_unless(overlay != nullptr);
  }
}
GST_END_TEST;

GST_START_TEST(test_a_child_in_the_place_of_another_gets_the_settings) {
  g_autoptr(GstElement) bin = own(gst_element_factory_make("calibrate", nullptr));
  g_autoptr(GstElement) old = gst_bin_get_by_name(GST_BIN(bin), "solve");
  fail_unless(gst_bin_remove(GST_BIN(bin), old));
  GstElement* solve = gst_element_factory_make("calibsolve", "solve");
  fail_unless(gst_bin_add(GST_BIN(bin), solve));
  g_object_set(bin, "min-views", 9, nullptr);
  int views = 0;
  g_object_get(solve, "min-views", &views, nullptr);
  fail_unless_equals_int(views, 9);
}
GST_END_TEST;

// And what it notifies of is notified of by the bin; no longer what the other one does.
GST_START_TEST(test_a_child_in_the_place_of_another_is_listened_to) {
  static const struct {
    const char* factory;
    const char* name;
    const char* property;
  } kChildren[] = {{"calibdetect", "detect", "board"}, {"calibsolve", "solve", "calibration"}};
  const auto& [factory, name, property] = kChildren[__i__];
  g_autoptr(GstElement) bin = own(gst_element_factory_make("calibrate", nullptr));
  int notified = 0;
  const std::string signal = std::string("notify::") + property;
  g_signal_connect(bin, signal.c_str(),
                   G_CALLBACK(+[](GObject*, GParamSpec*, int* count) { ++*count; }), &notified);
  g_autoptr(GstElement) old = gst_bin_get_by_name(GST_BIN(bin), name);
  g_object_notify(G_OBJECT(old), property);
  fail_unless_equals_int(notified, 1);
  fail_unless(gst_bin_remove(GST_BIN(bin), old));
  g_object_notify(G_OBJECT(old), property);
  fail_unless_equals_int(notified, 1);
  GstElement* child = gst_element_factory_make(factory, name);
  fail_unless(gst_bin_add(GST_BIN(bin), child));
  g_object_notify(G_OBJECT(child), property);
  fail_unless_equals_int(notified, 2);
  // Whatever else is put in has no say.
  GstElement* other = gst_element_factory_make(factory, "other");
  fail_unless(gst_bin_add(GST_BIN(bin), other));
  g_object_notify(G_OBJECT(other), property);
  fail_unless_equals_int(notified, 2);
}
GST_END_TEST;

// A property of two children is one of the bin.
GST_START_TEST(test_a_change_is_notified_once) {
  g_autoptr(GstElement) bin = own(gst_element_factory_make("calibrate", nullptr));
  for (const char* property : {"camera", "location", "board", "overlay"}) {
    int notified = 0;
    const std::string signal = std::string("notify::") + property;
    g_signal_connect(bin, signal.c_str(),
                     G_CALLBACK(+[](GObject*, GParamSpec*, int* count) { ++*count; }), &notified);
    gst_util_set_object_arg(G_OBJECT(bin), property, "false");
    fail_unless(notified == 1, "%s is notified %d times", property, notified);
  }
}
GST_END_TEST;

// One pipeline through its life: signals, state cycles, a restart, removal of nothing.
GST_START_TEST(test_signals_and_state_cycles) {
  g_autoptr(GstElement) pipeline = gst_parse_launch(
      "calibtestsrc num-buffers=12 ! calibrate name=c ! fakesink sync=false", nullptr);
  g_autoptr(GstElement) bin = gst_bin_get_by_name(GST_BIN(pipeline), "c");
  g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
  for (int round = 0; round < 2; ++round) {
    gst_element_set_state(pipeline, GST_STATE_PLAYING);
    g_autoptr(GstMessage) end = gst_bus_timed_pop_filtered(
        bus, 60 * GST_SECOND, static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR));
    fail_unless(end != nullptr && GST_MESSAGE_TYPE(end) == GST_MESSAGE_EOS);
    g_autofree char* json = nullptr;
    g_object_get(bin, "calibration", &json, nullptr);
    fail_unless(json != nullptr);
    gboolean removed = TRUE;
    g_signal_emit_by_name(bin, "remove-view", 100U, &removed);
    fail_if(removed);
    g_signal_emit_by_name(bin, "remove-view", 0U, &removed);
    fail_unless(removed);
    g_signal_emit_by_name(bin, "capture-view");
    g_signal_emit_by_name(bin, "solve");
    g_signal_emit_by_name(bin, "reset");
    gst_element_set_state(pipeline, GST_STATE_READY);
  }
  gst_bus_set_flushing(bus, TRUE);
  gst_element_set_state(pipeline, GST_STATE_NULL);
}
GST_END_TEST;

GST_START_TEST(test_the_end_without_a_calibration_tells_the_board_that_was_seen) {
  g_autoptr(GstElement) pipeline = gst_parse_launch(
      "calibtestsrc num-buffers=12 ! calibrate overlay=false board=checkerboard:8x6:25mm ! "
      "fakesink",
      nullptr);
  g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  g_autoptr(GstMessage) warning =
      gst_bus_timed_pop_filtered(bus, 60 * GST_SECOND, GST_MESSAGE_WARNING);
  fail_unless(warning != nullptr);
  g_autoptr(GError) error = nullptr;
  gst_message_parse_warning(warning, &error, nullptr);
  fail_unless(strstr(error->message, "no view of the board was taken") != nullptr &&
                  strstr(error->message, "This is a 9x6 board, I look for 8x6.") != nullptr,
              "%s", error->message);
  gst_bus_set_flushing(bus, TRUE);
  gst_element_set_state(pipeline, GST_STATE_NULL);
}
GST_END_TEST;

// Threads of this process of a lower priority than the one that asks.
static int low_threads() {
  const int own = getpriority(PRIO_PROCESS, 0);
  int n = 0;
  DIR* tasks = opendir("/proc/self/task");
  fail_unless(tasks != nullptr);
  while (const dirent* task = readdir(tasks)) {
    const int id = std::atoi(task->d_name);
    if (id > 0 && getpriority(PRIO_PROCESS, static_cast<id_t>(id)) > own) ++n;
  }
  closedir(tasks);
  return n;
}

// A live stream comes before the search and the solution. Where nothing is live it waits for them,
// and they must not wait for other programs.
GST_START_TEST(test_only_a_live_stream_comes_before_detector_and_solver) {
  const bool live = __i__ == 1;
  check::Pipeline pipeline(std::string("calibtestsrc is-live=") + (live ? "true" : "false") +
                           " ! video/x-raw,width=320,height=240 ! calibrate capture-mode=all "
                           "overlay=false board=checkerboard:9x6:25mm ! fakesink");
  pipeline.set_state(GST_STATE_PLAYING);
  pipeline.wait_for("calib-result");
  // The updater of calibsolve may have had something to do, too.
  const int low = low_threads();
  fail_unless(live ? low >= 2 : low == 0, "%d threads are low", low);
}
GST_END_TEST;

static Suite* calibrate_suite() {
  Suite* suite = suite_create("calibrate");
  TCase* tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_checked_fixture(tc, gst::register_metas, nullptr);
  tcase_add_test(tc, test_settings_reach_the_children);
  tcase_add_test(tc, test_every_default_is_the_childs);
  tcase_add_test(tc, test_changes_of_a_child_are_notified);
  tcase_add_test(tc, test_the_overlay_can_be_left_out_and_put_back);
  tcase_add_test(tc, test_an_overlay_that_is_left_out_keeps_its_settings);
  tcase_add_test(tc, test_children_may_be_taken_out);
  tcase_add_test(tc, test_a_child_in_the_place_of_another_gets_the_settings);
  tcase_add_loop_test(tc, test_a_child_in_the_place_of_another_is_listened_to, 0, 2);
  tcase_add_test(tc, test_a_change_is_notified_once);
  tcase_add_test(tc, test_signals_and_state_cycles);
  tcase_add_test(tc, test_the_end_without_a_calibration_tells_the_board_that_was_seen);
  tcase_add_loop_test(tc, test_only_a_live_stream_comes_before_detector_and_solver, 0, 2);
  return suite;
}

GST_CHECK_MAIN(calibrate)
