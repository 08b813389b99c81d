// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibsolve on a disk that takes a write and does not end it: results go to the bus all the same,
// and the files have the newest one once the disk answers.

#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <filesystem>
#include <thread>

#include "calvin/io/calibration_io.hpp"
#include "gate.hpp"
#include "solve_fixture.hpp"

#include <gst/check/gstcheck.h>

using namespace calvin;
using check::Gate;
using check::SolveFixture;

static Gate disk;
static std::atomic<bool> full;  // and takes nothing

// Stands before the C library's own.
extern "C" {
GST_EXPORT int fsync(int fd) {
  disk.pass();
  if (!full) return static_cast<int>(syscall(SYS_fsync, fd));
  errno = ENOSPC;
  return -1;
}
}

static void set_up() {
  gst::register_metas();
  full = false;
  disk.open();
}

static void tear_down() { fail_if(disk.forced(), "the test waited for what waited for it"); }

template <typename Condition>
static bool comes(Condition condition) {
  for (int i = 0; i < 1000 && !condition(); ++i) g_usleep(10000);
  return condition();
}

static int views_in(const GstStructure* result) {
  int views = -1;
  if (result != nullptr) gst_structure_get_int(result, "views", &views);
  return views;
}

static int views_of(const std::string& path) {
  const auto calibration = read_calibration(path);
  return calibration ? static_cast<int>(calibration->views.size()) : -1;
}

// From here on the write of the first result hangs.
static void hang_in_a_write(SolveFixture& f) {
  disk.close();
  f.push_views(3);
  fail_unless(disk.reached());
}

// Another camera's calibration, which only a final result replaces.
static void write_another_one(const SolveFixture& f, const std::string& path) {
  Calibration other = f.scene.camera.to_calibration();
  other.camera = "right";
  other.expected_error = 1e-9;
  fail_unless(write_calibration(path, other).has_value());
}

GST_START_TEST(test_a_write_that_does_not_end_keeps_no_result_back) {
  check::TemporaryFolder folder;
  const std::string path = folder / "cam.json";
  SolveFixture f("location=" + path);
  hang_in_a_write(f);
  fail_unless(comes([&] { return views_in(f.result("intermediate")) == 3; }));
  // Nor the next ones.
  for (int n = 3; n < 6; ++n) gst_buffer_unref(f.push(n));
  fail_unless(comes([&] { return views_in(f.result("intermediate")) > 3; }));
  g_signal_emit_by_name(f.element, "solve");
  fail_unless(comes([&] { return views_in(f.result("final")) == 6; }));
  fail_if(std::filesystem::exists(path));
  fail_unless(comes([&] { return !f.bus.texts(GST_MESSAGE_WARNING).empty(); }));
  disk.open();
  fail_unless(comes([&] { return views_of(path) == 6; }));
  f.eos();
  const auto warnings = f.bus.texts(GST_MESSAGE_WARNING);
  fail_unless_equals_int(warnings.size(), 1);
  fail_unless(warnings[0].find("The write of '" + path + "' has not ended") == 0, "%s",
              warnings[0].c_str());
  fail_unless(f.bus.texts(GST_MESSAGE_ERROR).empty());
}
GST_END_TEST;

// Whoever hears of a result finds it in the file.
GST_START_TEST(test_a_result_waits_for_a_write_that_ends) {
  check::TemporaryFolder folder;
  const std::string path = folder / "cam.json";
  SolveFixture f("location=" + path);
  hang_in_a_write(f);
  g_usleep(100000);
  fail_unless(f.bus.named("calib-result").empty());
  disk.open();
  fail_unless(comes([&] { return f.result("intermediate") != nullptr; }));
  fail_unless_equals_int(views_of(path), 3);
  fail_unless(f.bus.texts(GST_MESSAGE_WARNING).empty());
}
GST_END_TEST;

GST_START_TEST(test_the_end_waits_for_the_write) {
  check::TemporaryFolder folder;
  const std::string path = folder / "cam.json";
  SolveFixture f("location=" + path);
  hang_in_a_write(f);
  gst_buffer_unref(f.push(3));
  std::thread answer([] {
    g_usleep(2 * G_USEC_PER_SEC);
    disk.open();
  });
  f.eos();
  fail_unless_equals_int(views_of(path), 4);
  answer.join();
}
GST_END_TEST;

// What a final result may replace, it still may when a later one is written in its stead.
GST_START_TEST(test_a_final_result_that_waits_for_the_disk_stays_final) {
  check::TemporaryFolder folder;
  const std::string path = folder / "cam.json";
  SolveFixture f("location=" + path + " export=ros:" + folder / "cam.yaml");
  write_another_one(f, path);
  hang_in_a_write(f);  // of cam.yaml
  g_signal_emit_by_name(f.element, "solve");
  fail_unless(comes([&] { return f.result("final") != nullptr; }));
  for (int n = 3; n < 8; ++n) gst_buffer_unref(f.push(n));
  fail_unless(comes([&] { return views_in(f.result("intermediate")) > 3; }));
  fail_unless_equals_int(views_of(path), 0);
  disk.open();
  fail_unless(comes([&] { return views_of(path) > 0; }));
}
GST_END_TEST;

GST_START_TEST(test_a_flush_forgets_no_write) {
  check::TemporaryFolder folder;
  const std::string path = folder / "cam.json";
  SolveFixture f("location=" + path);
  hang_in_a_write(f);
  for (int n = 3; n < 5; ++n) gst_buffer_unref(f.push(n));
  g_signal_emit_by_name(f.element, "solve");
  fail_unless(comes([&] { return views_in(f.result("final")) == 5; }));
  gst_harness_push_event(f.h, gst_event_new_flush_start());
  gst_harness_push_event(f.h, gst_event_new_flush_stop(TRUE));
  disk.open();
  fail_unless(comes([&] { return views_of(path) == 5; }));
}
GST_END_TEST;

// A removed view takes with it that a result with it was final.
GST_START_TEST(test_after_a_view_is_removed_nothing_is_final) {
  check::TemporaryFolder folder;
  const std::string path = folder / "cam.json";
  SolveFixture f("location=" + path + " export=ros:" + folder / "cam.yaml");
  write_another_one(f, path);
  hang_in_a_write(f);  // of cam.yaml
  for (int n = 3; n < 5; ++n) gst_buffer_unref(f.push(n));
  g_signal_emit_by_name(f.element, "solve");
  fail_unless(comes([&] { return views_in(f.result("final")) == 5; }));
  gboolean removed = FALSE;
  g_signal_emit_by_name(f.element, "remove-view", 0, &removed);
  fail_unless(removed);
  fail_unless(comes([&] { return views_in(f.result("intermediate")) == 4; }));
  disk.open();
  g_usleep(500000);
  fail_unless_equals_int(views_of(path), 0);
}
GST_END_TEST;

GST_START_TEST(test_the_file_that_is_late_is_named_whatever_is_wanted_now) {
  check::TemporaryFolder folder;
  const std::string path = folder / "cam.json";
  const std::string other = folder / "other.json";
  SolveFixture f("location=" + path);
  hang_in_a_write(f);
  fail_unless(comes([&] { return f.bus.texts(GST_MESSAGE_WARNING).size() == 1; }));
  g_object_set(f.element, "location", other.c_str(), nullptr);
  gst_buffer_unref(f.push(3));
  fail_unless(comes([&] { return f.bus.texts(GST_MESSAGE_WARNING).size() == 2; }));
  for (const std::string& warning : f.bus.texts(GST_MESSAGE_WARNING)) {
    fail_unless(warning.find("The write of '" + path + "'") == 0, "%s", warning.c_str());
  }
  disk.open();
  fail_unless(comes([&] { return views_of(other) == 4; }));
}
GST_END_TEST;

GST_START_TEST(test_without_files_no_result_waits) {
  check::TemporaryFolder folder;
  SolveFixture f("location=" + folder / "cam.json");
  hang_in_a_write(f);
  fail_unless(comes([&] { return f.bus.texts(GST_MESSAGE_WARNING).size() == 1; }));
  g_object_set(f.element, "location", nullptr, nullptr);
  gst_buffer_unref(f.push(3));
  fail_unless(comes([&] { return views_in(f.result("intermediate")) == 4; }));
  fail_unless_equals_int(f.bus.texts(GST_MESSAGE_WARNING).size(), 1);
  disk.open();
}
GST_END_TEST;

// A write that waits is one of the session that asked for it.
GST_START_TEST(test_a_reset_forgets_the_write_that_waits) {
  check::TemporaryFolder folder;
  const std::string path = folder / "cam.json";
  SolveFixture f("location=" + path);
  hang_in_a_write(f);
  for (int n = 3; n < 5; ++n) gst_buffer_unref(f.push(n));
  g_signal_emit_by_name(f.element, "solve");
  fail_unless(comes([&] { return views_in(f.result("final")) == 5; }));
  g_signal_emit_by_name(f.element, "reset");
  disk.open();
  f.eos();
  fail_unless_equals_int(views_of(path), 3);
}
GST_END_TEST;

// Of a write that is under way the file at hand is ended, and no other one is begun.
GST_START_TEST(test_a_reset_stops_the_files_that_follow) {
  check::TemporaryFolder folder;
  SolveFixture f("location=" + folder / "cam.json export=ros:" + folder / "cam.yaml");
  hang_in_a_write(f);  // of cam.json
  g_signal_emit_by_name(f.element, "reset");
  disk.open();
  f.eos();
  fail_if(std::filesystem::exists(folder / "cam.yaml"));
}
GST_END_TEST;

// What a write has to say and may not say during a flush is said after it.
GST_START_TEST(test_a_flush_loses_no_word_of_a_write) {
  check::TemporaryFolder folder;
  const std::string path = folder / "cam.json";
  SolveFixture f("location=" + path + " export=ros:" + folder / "cam.yaml");
  const bool held = __i__ == 1;
  if (held) write_another_one(f, path);
  hang_in_a_write(f);
  gst_harness_push_event(f.h, gst_event_new_flush_start());
  full = !held;
  disk.open();
  // The write ends, and has to say it while nobody may.
  if (held) fail_unless(comes([&] { return std::filesystem::exists(folder / "cam.yaml"); }));
  g_usleep(200000);
  gst_harness_push_event(f.h, gst_event_new_flush_stop(TRUE));
  const auto kind = held ? GST_MESSAGE_INFO : GST_MESSAGE_WARNING;
  fail_unless(comes([&] {
    const auto& all = f.bus.messages();
    return std::any_of(all.begin(), all.end(),
                       [kind](GstMessage* m) { return GST_MESSAGE_TYPE(m) == kind; });
  }));
}
GST_END_TEST;

static Suite* calibsolve_late_suite() {
  Suite* suite = suite_create("calibsolve_late");
  TCase* tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_checked_fixture(tc, set_up, tear_down);
  tcase_add_test(tc, test_a_write_that_does_not_end_keeps_no_result_back);
  tcase_add_test(tc, test_a_result_waits_for_a_write_that_ends);
  tcase_add_test(tc, test_the_end_waits_for_the_write);
  tcase_add_test(tc, test_a_final_result_that_waits_for_the_disk_stays_final);
  tcase_add_test(tc, test_a_flush_forgets_no_write);
  tcase_add_test(tc, test_after_a_view_is_removed_nothing_is_final);
  tcase_add_test(tc, test_the_file_that_is_late_is_named_whatever_is_wanted_now);
  tcase_add_test(tc, test_without_files_no_result_waits);
  tcase_add_test(tc, test_a_reset_forgets_the_write_that_waits);
  tcase_add_test(tc, test_a_reset_stops_the_files_that_follow);
  tcase_add_loop_test(tc, test_a_flush_loses_no_word_of_a_write, 0, 2);
  return suite;
}

GST_CHECK_MAIN(calibsolve_late)
