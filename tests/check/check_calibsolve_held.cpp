// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibsolve while its worker is held at a place of the test's choice: what an application does
// meanwhile returns at once, and nothing of what it has ended is written, posted or announced.

#include <algorithm>
#include <atomic>
#include <functional>
#include <memory>
#include <mutex>

#include "held_fixture.hpp"

#include <gst/check/gstcheck.h>

using namespace calvin;
using check::Gate;
using check::HeldFixture;
using namespace check::held;

// What ends a session. Views of frames of another size wait: at EOS, where no others came, they are
// solved anew.
static const struct {
  const char* name;
  void (*end)(HeldFixture&);
  bool views_wait = false;
} kEnds[] = {
    {"reset", [](HeldFixture& f) { g_signal_emit_by_name(f.element, "reset"); }},
    {"new caps", [](HeldFixture& f) { f.halve(); }, true},
    {"new run",
     [](HeldFixture& f) {
       gst_element_set_state(f.element, GST_STATE_READY);
       gst_element_set_state(f.element, GST_STATE_PLAYING);
       gst_harness_push_event(f.h, gst_event_new_stream_start("again"));
       gst_harness_set_src_caps(f.h, check::caps_of("GRAY8", f.scene.size));
     }},
};

// Whether all that was solved of a session is the final result of EOS, where its views have waited.
static bool is_solved_at_end(HeldFixture& f, bool views_wait) {
  const auto results = f.bus.named("calib-result");
  return results.size() == (views_wait ? 1U : 0U) &&
         (results.empty() ||
          g_str_equal(gst_structure_get_string(results[0], "state"), "final") != FALSE);
}

// ---- A solve that is held -----------------------------------------------------------------------

GST_START_TEST(test_a_held_solve_of_a_session_that_ends_is_thrown_away) {
  check::TemporaryFolder folder;
  HeldFixture f("location=" + folder / "cam.json");
  solved.close();
  f.push_views(3);
  fail_unless(solved.reached());
  kEnds[__i__].end(f);
  solved.open();
  f.eos();
  const char* name = kEnds[__i__].name;
  fail_unless(is_solved_at_end(f, kEnds[__i__].views_wait), "%s: a result is posted", name);
  if (kEnds[__i__].views_wait) return;
  fail_unless(f.calibration().empty(), "%s: there is a calibration", name);
  fail_unless_equals_int(f.views_announced(), -1);
  fail_if(std::filesystem::exists(folder / "cam.json"), "%s: a file is written", name);
  fail_unless(f.bus.says(GST_MESSAGE_ERROR, "no view of the board was taken"), "%s", name);
}
GST_END_TEST;

// One less than these are not what an earlier solve has: those are of 3, 4, 6, 8 and 11 views.
static constexpr int kViews = 13;

// Whether the file holds every view but the one of that frame.
static bool is_left_out(const std::string& path, guint64 frame) {
  const auto calibration = read_calibration(path);
  return calibration->views.size() == kViews - 1 &&
         std::none_of(
             calibration->views.begin(), calibration->views.end(),
             [frame](const ViewRecord& view) { return view.timestamp == frame * GST_SECOND / 30; });
}

GST_START_TEST(test_a_held_solve_with_a_view_that_is_removed_is_thrown_away) {
  check::TemporaryFolder folder;
  HeldFixture f("location=" + folder / "cam.json");
  solved.close();
  f.push_views(kViews);
  fail_unless(solved.reached());
  gboolean removed = FALSE;
  g_signal_emit_by_name(f.element, "remove-view", 5U, &removed);
  fail_unless(removed);
  solved.open();
  // No EOS: the file follows by itself.
  for (int i = 0; i < 1000 && f.views_of_results().empty(); ++i) g_usleep(10000);
  fail_unless(f.views_of_results() == std::vector<int>{kViews - 1});
  fail_unless(is_left_out(folder / "cam.json", 5));
  gst_harness_push_event(f.h, gst_event_new_eos());
  fail_unless_equals_int(f.views_announced(), kViews - 1);
  for (const int views : f.views_of_results()) fail_unless_equals_int(views, kViews - 1);
}
GST_END_TEST;

GST_START_TEST(test_the_failure_of_a_held_solve_is_forgotten_with_its_session) {
  check::TemporaryFolder folder;
  HeldFixture f("location=" + folder / "cam.json");
  // In brackets: the macros of these names compare a function's address with void*.
  (gst_debug_add_log_function)(hold_where_unsolved, nullptr, nullptr);
  gst_debug_set_threshold_for_name("calibsolve", GST_LEVEL_INFO);
  unsolved.close();
  for (int i = 0; i < 3; ++i) gst_buffer_unref(f.push_observation(f.seen(3, i), i));
  fail_unless(unsolved.reached());
  kEnds[__i__].end(f);
  unsolved.open();
  f.eos();
  const bool views_wait = kEnds[__i__].views_wait;
  fail_unless(f.bus.says(GST_MESSAGE_ERROR, "no view of the board was taken") != views_wait, "%s",
              kEnds[__i__].name);
  gst_debug_unset_threshold_for_name("calibsolve");
  (gst_debug_remove_log_function)(hold_where_unsolved);
}
GST_END_TEST;

// ---- A write that is held -----------------------------------------------------------------------

// As on a card that takes seconds. What the next session finds counts, however good the last was.
GST_START_TEST(test_a_held_write_does_not_count_for_the_next_session) {
  check::TemporaryFolder folder;
  HeldFixture f("min-views=5 location=" + folder / "cam.json");
  f.push_views(24);
  g_signal_emit_by_name(f.element, "solve");
  for (int i = 0; i < 1000 && f.result("final") == nullptr; ++i) g_usleep(10000);
  fail_unless(f.result("final") != nullptr);
  written.close();
  g_signal_emit_by_name(f.element, "solve");
  fail_unless(written.reached());
  const auto before = f.bus.named("calib-result").size();
  kEnds[__i__].end(f);
  written.open();
  fail_unless(written.reached(2));  // file and folder
  std::filesystem::remove(folder / "cam.json");
  fail_unless(f.calibration().empty());
  f.push_views(5);
  const char* name = kEnds[__i__].name;
  for (int i = 0; i < 1000 && f.bus.named("calib-result").size() == before; ++i) g_usleep(10000);
  fail_unless_equals_int(f.views_of_results().at(before), 5);
  gst_buffer_unref(f.push(5));
  fail_unless(f.views_announced() < 24, "%s: the event is the old one", name);
  const auto file = read_calibration(folder / "cam.json");
  fail_unless(file.has_value() && file->views.size() < 24, "%s: no file", name);
  f.eos();
  fail_unless_equals_int(read_calibration(folder / "cam.json")->views.size(), 6);
}
GST_END_TEST;

// The solution names a view of a session that has none any more.
GST_START_TEST(test_a_held_write_with_an_outlier_is_forgotten_with_its_session) {
  check::TemporaryFolder folder;
  HeldFixture f("min-views=16 location=" + folder / "cam.json");
  for (int n = 0; n < 15; ++n) gst_buffer_unref(f.push(n));
  written.close();
  gst_buffer_unref(f.push(15, 0.7));
  fail_unless(written.reached());
  const auto told = f.bus.named("calib-view").size();
  kEnds[__i__].end(f);
  written.open();
  f.eos();
  fail_unless(is_solved_at_end(f, kEnds[__i__].views_wait));
  // The final result names it once more.
  if (!kEnds[__i__].views_wait) fail_unless_equals_int(f.bus.named("calib-view").size(), told);
}
GST_END_TEST;

// Who asked for a final result asked for one of the views that were there.
GST_START_TEST(test_a_final_result_that_is_owed_is_not_of_the_next_session) {
  HeldFixture f;
  solved.close();
  f.push_views(3);
  fail_unless(solved.reached());
  g_signal_emit_by_name(f.element, "solve");
  kEnds[__i__].end(f);
  solved.open();
  f.push_views(3);
  for (int i = 0; i < 1000 && f.bus.named("calib-result").empty(); ++i) g_usleep(10000);
  fail_unless(f.result("intermediate") != nullptr, "%s", kEnds[__i__].name);
  fail_unless(f.result("final") == nullptr, "%s", kEnds[__i__].name);
}
GST_END_TEST;

GST_START_TEST(test_a_view_that_is_removed_during_a_write_leaves_the_file) {
  check::TemporaryFolder folder;
  HeldFixture f("location=" + folder / "cam.json");
  written.close();
  f.push_views(kViews);
  fail_unless(written.reached());
  gboolean removed = FALSE;
  g_signal_emit_by_name(f.element, "remove-view", 0U, &removed);
  fail_unless(removed);
  written.open();
  for (int i = 0; i < 1000 && f.views_of_results().empty(); ++i) g_usleep(10000);
  fail_unless(f.views_of_results() == std::vector<int>{kViews - 1});
  fail_unless(is_left_out(folder / "cam.json", 0));
}
GST_END_TEST;

// ---- A handler of a report waits for the application --------------------------------------------

// The handler waits as for a lock that the application has while it does this.
static const struct {
  const char* name;
  void (*act)(HeldFixture&);
} kActs[] = {
    {"reset", [](HeldFixture& f) { g_signal_emit_by_name(f.element, "reset"); }},
    {"remove-view",
     [](HeldFixture& f) {
       gboolean removed = FALSE;
       g_signal_emit_by_name(f.element, "remove-view", 0U, &removed);
       g_signal_emit_by_name(f.element, "remove-view", 0U, &removed);
     }},
    {"flush", [](HeldFixture& f) { gst_harness_push_event(f.h, gst_event_new_flush_start()); }},
    {"READY", [](HeldFixture& f) { gst_element_set_state(f.element, GST_STATE_READY); }},
    {"solve", [](HeldFixture& f) { g_signal_emit_by_name(f.element, "solve"); }},
    {"caps", [](HeldFixture& f) { f.halve(); }},
    {"setting", [](HeldFixture& f) { g_object_set(f.element, "model", "brown4", nullptr); }},
    {"reading", [](HeldFixture& f) { fail_if(f.calibration().empty()); }},
};

GST_START_TEST(test_nothing_waits_for_a_handler) {
  for (Gate* gate : {&progress, &announced}) {
    HeldFixture f;
    gate->close();
    f.push_views(3);
    fail_unless(gate->reached());
    kActs[__i__].act(f);
    gate->open();
    fail_if(gate->forced(), "%s waits for a handler", kActs[__i__].name);
  }
}
GST_END_TEST;

// The element itself goes while a handler of its is at work.
GST_START_TEST(test_the_last_reference_does_not_wait_for_a_handler) {
  auto f = std::make_unique<HeldFixture>();
  announced.close();
  f->push_views(3);
  fail_unless(announced.reached());
  f.reset();
  fail_unless_equals_int(living, 1);
  announced.open();
}
GST_END_TEST;

// ---- A report that has begun is the last --------------------------------------------------------

GST_START_TEST(test_behind_a_held_message_nothing_of_the_session_is_posted) {
  HeldFixture f;
  progress.close();
  f.push_views(3);
  fail_unless(progress.reached());
  kEnds[__i__].end(f);
  progress.open();
  f.eos();
  fail_unless(is_solved_at_end(f, kEnds[__i__].views_wait), "%s", kEnds[__i__].name);
}
GST_END_TEST;

// A flush ends the reports, and the final result that is owed comes after it.
GST_START_TEST(test_behind_a_held_message_a_flush_ends_what_is_told) {
  HeldFixture f;
  f.push_views(2);
  progress.close();
  gst_buffer_unref(f.push(2));
  fail_unless(progress.reached());
  gst_harness_push_event(f.h, gst_event_new_flush_start());
  progress.open();
  f.flush_stop();
  f.eos();
  fail_unless(f.result("intermediate") == nullptr);
  fail_unless(f.result("final") != nullptr);
}
GST_END_TEST;

static std::mutex of_application;
static std::atomic<int> changes;

static void take_lock(GObject* /*element*/, GParamSpec* /*spec*/, gpointer /*unused*/) {
  const std::lock_guard guard(of_application);
  ++changes;
}

// What a command has changed is told where no lock of whoever gave it is held.
GST_START_TEST(test_a_command_tells_what_it_changed_from_another_thread) {
  HeldFixture f;
  f.push_views(3);
  for (int i = 0; i < 1000 && f.result("intermediate") == nullptr; ++i) g_usleep(10000);
  for (int i = 0; i < 1000 && f.calibration().empty(); ++i) g_usleep(10000);
  changes = 0;
  g_signal_connect(f.element, "notify::calibration", G_CALLBACK(take_lock), nullptr);
  {
    const std::lock_guard guard(of_application);
    g_signal_emit_by_name(f.element, "reset");
  }
  const auto views_told = [&f] {
    int views = -1;
    const auto told = f.bus.named("calib-progress");
    if (!told.empty()) gst_structure_get_int(told.back(), "views", &views);
    return views;
  };
  for (int i = 0; i < 1000 && (views_told() != 0 || changes == 0); ++i) g_usleep(10000);
  fail_unless_equals_int(views_told(), 0);
  fail_unless(changes > 0);
  fail_unless(f.calibration().empty());
}
GST_END_TEST;

GST_START_TEST(test_a_final_result_that_a_removal_overtakes_is_still_owed) {
  HeldFixture f;
  f.push_views(12);
  // The last one on the way.
  const auto views = [&] { return f.views_of_results(); };
  for (int i = 0; i < 1000 && (views().empty() || views().back() < 11); ++i) g_usleep(10000);
  solved.close();
  g_signal_emit_by_name(f.element, "solve");
  fail_unless(solved.reached());
  progress.close();
  solved.open();
  fail_unless(progress.reached());
  gboolean removed = FALSE;
  g_signal_emit_by_name(f.element, "remove-view", 0U, &removed);
  progress.open();
  for (int i = 0; i < 1000 && f.result("final") == nullptr; ++i) g_usleep(10000);
  const GstStructure* r = f.result("final");
  fail_unless(r != nullptr);
  fail_unless_equals_int(views().back(), 11);
}
GST_END_TEST;

static Suite* calibsolve_held_suite() {
  Suite* suite = suite_create("calibsolve_held");
  TCase* tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_checked_fixture(tc, set_up, tear_down);
  const int ends = G_N_ELEMENTS(kEnds);
  tcase_add_loop_test(tc, test_a_held_solve_of_a_session_that_ends_is_thrown_away, 0, ends);
  tcase_add_test(tc, test_a_held_solve_with_a_view_that_is_removed_is_thrown_away);
  tcase_add_loop_test(tc, test_the_failure_of_a_held_solve_is_forgotten_with_its_session, 0, ends);
  tcase_add_loop_test(tc, test_a_held_write_does_not_count_for_the_next_session, 0, ends);
  tcase_add_loop_test(tc, test_a_held_write_with_an_outlier_is_forgotten_with_its_session, 0, ends);
  tcase_add_loop_test(tc, test_a_final_result_that_is_owed_is_not_of_the_next_session, 0, ends);
  tcase_add_test(tc, test_a_view_that_is_removed_during_a_write_leaves_the_file);
  tcase_add_loop_test(tc, test_nothing_waits_for_a_handler, 0, G_N_ELEMENTS(kActs));
  tcase_add_test(tc, test_the_last_reference_does_not_wait_for_a_handler);
  tcase_add_loop_test(tc, test_behind_a_held_message_nothing_of_the_session_is_posted, 0, ends);
  tcase_add_test(tc, test_behind_a_held_message_a_flush_ends_what_is_told);
  tcase_add_test(tc, test_a_command_tells_what_it_changed_from_another_thread);
  tcase_add_test(tc, test_a_final_result_that_a_removal_overtakes_is_still_owed);
  return suite;
}

GST_CHECK_MAIN(calibsolve_held)
