// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The journal of calibsolve: views are in it before anybody hears of them, and the next run has
// them.

#include <fstream>

#include "calvin/core/file.hpp"
#include "calvin/io/observations.hpp"
#include "file_size_limit.hpp"
#include "solve_fixture.hpp"

#include <gst/check/gstcheck.h>

using namespace calvin;
using check::SolveFixture;

static std::string journal_in(const check::TemporaryFolder& folder) {
  return "journal=" + (folder / "views.jsonl");
}
static std::size_t held(const check::TemporaryFolder& folder) {
  const auto file = read_observations(folder / "views.jsonl");
  return file ? file->observations.size() : 0;
}
static int views(SolveFixture& f) {
  g_autoptr(GstStructure) stats = nullptr;
  g_object_get(f.element, "stats", &stats, nullptr);
  int count = -1;
  gst_structure_get_int(stats, "views", &count);
  return count;
}
static bool has_info(SolveFixture& f, const char* part) {
  for (GstMessage* message : f.bus.messages()) {
    if (GST_MESSAGE_TYPE(message) != GST_MESSAGE_INFO) continue;
    g_autofree char* text = nullptr;
    gst_message_parse_info(message, nullptr, &text);
    if (std::string(text).find(part) != std::string::npos) return true;
  }
  return false;
}

GST_START_TEST(test_a_view_is_in_the_journal_before_it_is_announced) {
  check::TemporaryFolder folder;
  SolveFixture f(journal_in(folder));
  g_autoptr(GstBus) bus = gst_element_get_bus(f.element);
  struct Told {
    std::string path;
    std::size_t views = 0;
    bool late = false;
  } told{folder / "views.jsonl"};
  // Runs where the message is posted.
  gst_bus_set_sync_handler(
      bus,
      [](GstBus*, GstMessage* message, gpointer data) {
        const GstStructure* s = gst_message_get_structure(message);
        auto& t = *static_cast<Told*>(data);
        gboolean accepted = FALSE;
        if (s != nullptr && gst_structure_has_name(s, "calib-view") &&
            gst_structure_get_boolean(s, "accepted", &accepted) && accepted) {
          ++t.views;
          const auto file = read_observations(t.path);
          t.late |= !file || file->observations.size() != t.views;
        }
        return GST_BUS_PASS;
      },
      &told, nullptr);
  f.push_views(5);
  gst_bus_set_sync_handler(bus, nullptr, nullptr, nullptr);
  fail_unless_equals_int(told.views, 5);
  fail_if(told.late);
}
GST_END_TEST;

GST_START_TEST(test_the_next_run_goes_on) {
  check::TemporaryFolder folder;
  {
    SolveFixture f(journal_in(folder));
    f.push_views(5);
  }
  SolveFixture f(journal_in(folder) + " location=" + folder / "cam.json");
  fail_unless_equals_int(views(f), 5);
  fail_unless(has_info(f, "5 views"));
  fail_unless(!f.bus.named("calib-progress").empty());
  fail_unless_equals_int(check::get(f.bus.named("calib-progress").front(), "coverage") > 0, 1);
  // Not even one new view is needed for a result.
  f.eos();
  fail_unless(f.result("final") != nullptr);
  fail_unless(std::filesystem::exists(folder / "cam.json"));
  fail_unless_equals_int(held(folder), 5);
}
GST_END_TEST;

GST_START_TEST(test_the_same_element_goes_on_too) {
  check::TemporaryFolder folder;
  SolveFixture f(journal_in(folder));
  for (int turn = 1; turn <= 3; ++turn) {
    gst_buffer_unref(f.push(turn));
    fail_unless_equals_int(views(f), turn);
    gst_element_set_state(f.element, GST_STATE_READY);
    gst_element_set_state(f.element, GST_STATE_PLAYING);
    gst_harness_set_src_caps(f.h, check::caps_of("GRAY8", f.scene.size));
  }
  fail_unless_equals_int(held(folder), 3);
  fail_unless(f.bus.texts(GST_MESSAGE_ERROR).empty());
}
GST_END_TEST;

GST_START_TEST(test_commands_reach_the_journal) {
  check::TemporaryFolder folder;
  SolveFixture f(journal_in(folder));
  f.push_views(5);
  gboolean removed = FALSE;
  g_signal_emit_by_name(f.element, "remove-view", 2, &removed);
  fail_unless(removed);
  fail_unless_equals_int(held(folder), 4);
  g_signal_emit_by_name(f.element, "remove-view", 4, &removed);
  fail_if(removed);
  g_signal_emit_by_name(f.element, "reset");
  fail_unless_equals_int(held(folder), 0);
  gst_buffer_unref(f.push(7));
  fail_unless_equals_int(held(folder), 1);
}
GST_END_TEST;

// Whoever begins anew while nothing runs means the next run.
GST_START_TEST(test_commands_between_runs_count) {
  check::TemporaryFolder folder;
  SolveFixture f(journal_in(folder));
  f.push_views(5);
  gst_element_set_state(f.element, GST_STATE_READY);
  if (__i__ == 0) {
    g_signal_emit_by_name(f.element, "reset");
  } else {
    gboolean removed = FALSE;
    g_signal_emit_by_name(f.element, "remove-view", 1, &removed);
    fail_unless(removed);
  }
  gst_element_set_state(f.element, GST_STATE_PLAYING);
  gst_harness_set_src_caps(f.h, check::caps_of("GRAY8", f.scene.size));
  fail_unless_equals_int(views(f), __i__ == 0 ? 0 : 4);
  fail_unless_equals_int(held(folder), __i__ == 0 ? 0 : 4);
  // Another journal is none of its business.
  gst_element_set_state(f.element, GST_STATE_READY);
  g_signal_emit_by_name(f.element, "reset");
  std::filesystem::copy_file(folder / "views.jsonl", folder / "other.jsonl");
  const std::size_t copied = held(folder);
  g_object_set(f.element, "journal", (folder / "other.jsonl").c_str(), nullptr);
  gst_element_set_state(f.element, GST_STATE_PLAYING);
  gst_harness_set_src_caps(f.h, check::caps_of("GRAY8", f.scene.size));
  fail_unless_equals_int(views(f), copied);
}
GST_END_TEST;

GST_START_TEST(test_other_frames_wait_for_their_views) {
  check::TemporaryFolder folder;
  SolveFixture f(journal_in(folder));
  f.push_views(4);
  gst_harness_set_src_caps(f.h, check::caps_of("GRAY8", {320, 240}));
  fail_unless_equals_int(views(f), 0);
  fail_unless(has_info(f, "4 views of frames of another size"));
  gst_harness_set_src_caps(f.h, check::caps_of("GRAY8", {640, 480}));
  fail_unless_equals_int(views(f), 4);
  fail_unless_equals_int(held(folder), 4);
}
GST_END_TEST;

GST_START_TEST(test_a_journal_that_cannot_be_kept_is_an_error) {
  check::TemporaryFolder folder;
  const auto errors = [](const std::string& properties) {
    return check::errors_at_start(check::make_element("calibsolve " + properties));
  };
  { std::ofstream(folder / "letter.txt") << "Dear reader\n"; }
  const auto letter = errors("journal=" + folder / "letter.txt");
  fail_unless_equals_int(letter.size(), 1);
  fail_unless(letter[0].find("letter.txt") != std::string::npos, "%s", letter[0].c_str());
  fail_unless_equals_int(read_file(folder / "letter.txt")->size(), 12);
  fail_unless_equals_int(errors("journal=" + folder / "").size(), 1);
  fail_unless_equals_int(errors("journal=" + folder / "none/views.jsonl").size(), 1);
  fail_unless_equals_int(errors("journal=" + folder / "a location=" + folder / "./a").size(), 1);
  SolveFixture f(journal_in(folder));
  const auto second = errors(journal_in(folder));
  fail_unless_equals_int(second.size(), 1);
  fail_unless(second[0].find("another one") != std::string::npos, "%s", second[0].c_str());
  f.push_views(1);
  fail_unless_equals_int(held(folder), 1);
}
GST_END_TEST;

GST_START_TEST(test_another_board_is_an_error) {
  check::TemporaryFolder folder;
  {
    SolveFixture f(journal_in(folder));
    f.push_views(3);
  }
  const auto errors = check::errors_at_start(
      check::make_element("calibsolve board=checkerboard:8x5:30mm " + journal_in(folder)));
  fail_unless_equals_int(errors.size(), 1);
  fail_unless(errors[0].find("checkerboard:8x5:30mm") != std::string::npos, "%s",
              errors[0].c_str());
  SolveFixture f(journal_in(folder));
  Observation other = f.seen(3);
  other.board = "checkerboard:9x6:30mm";
  gst_buffer_unref(f.push_observation(other, 3));
  fail_unless(f.bus.says(GST_MESSAGE_ERROR, "checkerboard:9x6:30mm"));
  fail_unless_equals_int(held(folder), 3);
}
GST_END_TEST;

GST_START_TEST(test_a_full_disk_is_a_warning_and_nothing_is_lost) {
  check::TemporaryFolder folder;
  SolveFixture f(journal_in(folder));
  f.push_views(2);
  {
    const FileSizeLimit limit(*read_file(folder / "views.jsonl").map(&std::string::size) + 10);
    gst_buffer_unref(f.push(2));
    gst_buffer_unref(f.push(3));
  }
  fail_unless_equals_int(f.bus.texts(GST_MESSAGE_WARNING).size(), 1);
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "views.jsonl"));
  fail_unless_equals_int(views(f), 4);
  fail_unless_equals_int(held(folder), 2);
  gst_buffer_unref(f.push(4));
  fail_unless_equals_int(held(folder), 5);
}
GST_END_TEST;

GST_START_TEST(test_what_cannot_be_a_view_is_counted) {
  check::TemporaryFolder folder;
  {
    SolveFixture f(journal_in(folder));
    f.push_views(3);
    Observation beyond = f.seen(3);
    beyond.uv[0].u = 1e5;
    std::ofstream(folder / "views.jsonl", std::ios::app)
        << print_observation(beyond, beyond.board).value();
  }
  SolveFixture f(journal_in(folder));
  fail_unless_equals_int(views(f), 3);
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "1 of the lines"));
}
GST_END_TEST;

static Suite* calibsolve_journal_suite() {
  Suite* suite = suite_create("calibsolve_journal");
  TCase* tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_checked_fixture(tc, gst::register_metas, nullptr);
  tcase_add_test(tc, test_a_view_is_in_the_journal_before_it_is_announced);
  tcase_add_test(tc, test_the_next_run_goes_on);
  tcase_add_test(tc, test_the_same_element_goes_on_too);
  tcase_add_test(tc, test_commands_reach_the_journal);
  tcase_add_loop_test(tc, test_commands_between_runs_count, 0, 2);
  tcase_add_test(tc, test_other_frames_wait_for_their_views);
  tcase_add_test(tc, test_a_journal_that_cannot_be_kept_is_an_error);
  tcase_add_test(tc, test_another_board_is_an_error);
  tcase_add_test(tc, test_a_full_disk_is_a_warning_and_nothing_is_lost);
  tcase_add_test(tc, test_what_cannot_be_a_view_is_counted);
  return suite;
}

GST_CHECK_MAIN(calibsolve_journal)
