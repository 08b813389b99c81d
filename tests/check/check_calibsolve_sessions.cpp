// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibsolve and files that hold something already: another session's calibration is not lost to
// the first result of a new one, and what this session has written follows it.

#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>

#include <fmt/format.h>

#include "calvin/core/file.hpp"
#include "calvin/io/calibration_io.hpp"
#include "solve_fixture.hpp"

#include <gst/check/gstcheck.h>

using namespace calvin;
using check::SolveFixture;

static constexpr const char* kMark = "another session";

// What another session left there: a calibration with that expected error, if any.
static void leave(const std::string& path, const SolveFixture& f, std::optional<double> error,
                  const char* camera = "left") {
  Calibration left = f.scene.camera.to_calibration();
  left.camera = camera;
  left.expected_error = error;
  left.created = kMark;
  fail_unless(write_calibration(path, left).has_value());
}
static bool is_left(const std::string& path) {
  const auto found = read_calibration(path);
  return found && found->created == kMark;
}

static void wait_for_results(SolveFixture& f, std::size_t count) {
  for (int i = 0; i < 1000 && f.bus.named("calib-result").size() < count; ++i) g_usleep(10000);
  fail_unless(f.bus.named("calib-result").size() >= count);
}
// One result after each view, so that every one of them has its turn at the file.
static void push_slowly(SolveFixture& f, int count, int first = 0) {
  const std::size_t before = f.bus.named("calib-result").size();
  for (int n = first; n < first + 3; ++n) gst_buffer_unref(f.push(n));
  wait_for_results(f, before + 1);
  for (int n = first + 3; n < first + count; ++n) {
    const std::size_t seen = f.bus.named("calib-result").size();
    g_object_set(f.element, "skew", (n - first) % 2 != 0, nullptr);  // solves again
    gst_buffer_unref(f.push(n));
    wait_for_results(f, seen + 1);
  }
}
// Of an INFO gst-launch-1.0 shows the text for debugging alone.
static int infos(SolveFixture& f) {
  int count = 0;
  for (GstMessage* message : f.bus.messages()) {
    if (GST_MESSAGE_TYPE(message) != GST_MESSAGE_INFO) continue;
    g_autoptr(GError) info = nullptr;
    g_autofree char* shown = nullptr;
    gst_message_parse_info(message, &info, &shown);
    fail_unless(std::string(shown).find(info->message) != std::string::npos, "%s", shown);
    ++count;
  }
  return count;
}

GST_START_TEST(test_a_good_calibration_stays_until_the_result_is_final) {
  check::TemporaryFolder folder;
  SolveFixture f("location=" + folder / "cam.json");
  leave(folder / "cam.json", f, 1e-6);
  push_slowly(f, 6);
  fail_unless(is_left(folder / "cam.json"));
  fail_unless_equals_int(infos(f), 1);  // the user is told, once
  // A new session says so again.
  g_signal_emit_by_name(f.element, "reset");
  push_slowly(f, 6);
  fail_unless(is_left(folder / "cam.json"));
  fail_unless_equals_int(infos(f), 2);
  f.eos();
  fail_unless(f.result("final") != nullptr);
  fail_unless(is_left(folder / "cam.json"));
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "overwrite=true"));
}
GST_END_TEST;

GST_START_TEST(test_the_signal_solve_replaces_what_is_as_good) {
  check::TemporaryFolder folder;
  SolveFixture f("location=" + folder / "cam.json");
  leave(folder / "cam.json", f, std::nullopt);
  push_slowly(f, 3);
  g_signal_emit_by_name(f.element, "solve");
  for (int i = 0; i < 1000 && f.result("final") == nullptr; ++i) g_usleep(10000);
  fail_unless_equals_int(read_calibration(folder / "cam.json")->views.size(), 3);
  // From here on it is this session's own: what is better takes its place.
  push_slowly(f, 12, 3);
  fail_unless(read_calibration(folder / "cam.json")->views.size() > 3);
  // One solve was asked for, and one result is final.
  int finals = 0;
  for (const GstStructure* s : f.bus.named("calib-result")) {
    finals += g_str_equal(gst_structure_get_string(s, "state"), "final") ? 1 : 0;
  }
  fail_unless_equals_int(finals, 1);
}
GST_END_TEST;

// Whoever calibrated better before has not lost it, and knows: the same camera by overwrite=true,
// and another one.
GST_START_TEST(test_a_worse_final_result_says_so_and_keeps_what_was_there) {
  check::TemporaryFolder folder;
  const std::string path = folder / "cam.json";
  const bool other_camera = __i__ == 1;
  SolveFixture f("location=" + path + (other_camera ? "" : " overwrite=true"));
  leave(path, f, 0.0125, other_camera ? "right" : "left");
  f.push_views(3);
  f.eos();
  fail_unless_equals_int(read_calibration(path)->views.size(), 3);
  fail_unless(is_left(path + "~"));
  const auto said = f.bus.texts(GST_MESSAGE_WARNING);
  fail_unless_equals_int(said.size(), 1);
  const std::string now =
      fmt::format("{:.3g} px", check::get(f.result("final"), "expected-error-anywhere"));
  for (const std::string& part :
       {"'" + path + "'", "'" + path + "~'", std::string("0.0125 px"), now}) {
    fail_if(said[0].find(part) == std::string::npos, "%s: %s", said[0].c_str(), part.c_str());
  }
  fail_unless((said[0].find("right") != std::string::npos) == other_camera);
}
GST_END_TEST;

// However well the lens was known, it is another one after a change of focus.
GST_START_TEST(test_views_that_contradict_a_better_file_replace_it) {
  check::TemporaryFolder folder;
  const std::string path = folder / "cam.json";
  const bool refocused = __i__ == 1;
  SolveFixture f("location=" + path);
  Calibration before = f.scene.camera.to_calibration();
  before.camera = "left";
  before.expected_error = 1e-3;
  before.created = kMark;
  if (refocused) {
    for (int i = 0; i < 2; ++i) before.parameters[i].value *= 1.01;
  }
  fail_unless(write_calibration(path, before).has_value());
  f.push_views(8);
  f.eos();
  fail_unless(is_left(path) == !refocused);
  fail_unless(is_left(path + "~") == refocused);
}
GST_END_TEST;

// What is no better goes without a word, and is kept too.
GST_START_TEST(test_what_was_replaced_is_kept) {
  check::TemporaryFolder folder;
  const std::string path = folder / "cam.json";
  for (const bool last : {false, true}) {
    SolveFixture f("location=" + path + " export=opencv-json:" + folder / "cv.json");
    leave(path, f, last ? std::nullopt : std::optional<double>(1e6));
    push_slowly(f, 6);
    f.eos();
    fail_unless(is_left(path + "~"));
    fail_unless_equals_int(read_calibration(path)->views.size(), 6);
    fail_unless(f.bus.texts(GST_MESSAGE_WARNING).empty());
  }
  // What was no calibration may be somebody's, too.
  std::filesystem::remove(path + "~");
  std::ofstream(path) << "what is this?";
  SolveFixture f("location=" + path);
  f.push_views(3);
  f.eos();
  fail_unless(std::filesystem::file_size(path + "~") == std::strlen("what is this?"));
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "no calibration"));
}
GST_END_TEST;

// Of the same camera and size, and worse than any result: nothing is lost, and nobody need wait.
GST_START_TEST(test_what_is_as_good_replaces_it_at_once) {
  check::TemporaryFolder folder;
  SolveFixture f("location=" + folder / "cam.json export=opencv-json:" + folder / "cv.json");
  leave(folder / "cam.json", f, 1e6);
  fail_unless(write_calibration(folder / "cv.json", f.scene.camera.to_calibration(), "opencv-json")
                  .has_value());
  const auto before = read_calibration(folder / "cv.json");
  push_slowly(f, 3);
  fail_unless_equals_int(read_calibration(folder / "cam.json")->views.size(), 3);
  fail_if(read_calibration(folder / "cv.json")->find("fx")->value == before->find("fx")->value);
  fail_unless_equals_int(infos(f), 0);
}
GST_END_TEST;

GST_START_TEST(test_what_cannot_be_compared_stays) {
  check::TemporaryFolder folder;
  const std::function<void(const std::string&, const SolveFixture&)> kLeft[] = {
      [](const std::string& path, const SolveFixture& f) { leave(path, f, 1e6, "right"); },
      [](const std::string& path, const SolveFixture& f) { leave(path, f, std::nullopt); },
      [](const std::string& path, const SolveFixture&) {
        SolveFixture half("", check::Scene{{320, 240}});
        leave(path, half, 1e6);
      },
  };
  for (const auto& make : kLeft) {
    SolveFixture f("location=" + folder / "cam.json");
    make(folder / "cam.json", f);
    push_slowly(f, 3);
    fail_unless(is_left(folder / "cam.json"));
  }
}
GST_END_TEST;

// What only another build or a later version can read is somebody's calibration all the same.
GST_START_TEST(test_what_cannot_be_read_here_stays_and_is_kept) {
  check::TemporaryFolder folder;
  SolveFixture f("export=ros:" + folder / "cam.yaml" + ",calvin:" + folder / "later.json");
  const Calibration left = f.scene.camera.to_calibration();
  fail_unless(write_calibration(folder / "cam.yaml", left, "ros").has_value());
  std::string later = print_calibration(left).value();
  const std::string version = "\"version\": 1";
  fail_unless(later.find(version) != std::string::npos, "%s", later.c_str());
  later.replace(later.find(version), version.size(), "\"version\": 99");
  fail_unless(write_file(folder / "later.json", later).has_value());
  const std::string before = read_file(folder / "cam.yaml").value();
  push_slowly(f, 3);
  fail_unless(read_file(folder / "cam.yaml").value() == before);
  fail_unless(read_file(folder / "later.json").value() == later);
  f.eos();
  fail_if(read_file(folder / "cam.yaml").value() == before);
  fail_if(read_file(folder / "later.json").value() == later);
  fail_unless(read_file(folder / "cam.yaml~").value() == before);
  fail_unless(read_file(folder / "later.json~").value() == later);
}
GST_END_TEST;

// A pipeline that is killed must leave what it found: where nothing stands in its way, it does.
GST_START_TEST(test_what_is_no_calibration_does_not_stay) {
  check::TemporaryFolder folder;
  for (const char* content : {"", "{", "what is this?"}) {
    std::ofstream(folder / "cam.json") << content;
    SolveFixture f("location=" + folder / "cam.json");
    push_slowly(f, 3);
    fail_unless_equals_int(read_calibration(folder / "cam.json")->views.size(), 3);
  }
  // Each file for itself.
  SolveFixture f("location=" + folder / "new.json export=opencv-yaml:" + folder / "old.yaml");
  leave(folder / "old.yaml", f, 1e-6);
  push_slowly(f, 3);
  fail_unless(is_left(folder / "old.yaml"));
  fail_unless_equals_int(read_calibration(folder / "new.json")->views.size(), 3);
}
GST_END_TEST;

// A new session begins with a reset, a new size or a new run of the same pipeline.
GST_START_TEST(test_the_session_before_is_another_one) {
  const std::function<void(SolveFixture&)> kBegins[] = {
      [](SolveFixture& f) { g_signal_emit_by_name(f.element, "reset"); },
      [](SolveFixture& f) {
        f.scene = check::Scene{{320, 240}};
        gst_harness_set_src_caps(f.h, check::caps_of("GRAY8", f.scene.size));
      },
      [](SolveFixture& f) {
        gst_element_set_state(f.element, GST_STATE_READY);
        gst_element_set_state(f.element, GST_STATE_PLAYING);
        gst_harness_push_event(f.h, gst_event_new_stream_start("again"));
        gst_harness_set_src_caps(f.h, check::caps_of("GRAY8", f.scene.size));
      },
  };
  check::TemporaryFolder folder;
  SolveFixture f("location=" + folder / "cam.json");
  f.push_views(20);
  g_signal_emit_by_name(f.element, "solve");
  for (int i = 0; i < 1000 && f.result("final") == nullptr; ++i) g_usleep(10000);
  kBegins[__i__](f);
  push_slowly(f, 3);
  fail_unless_equals_int(read_calibration(folder / "cam.json")->views.size(), 20);
  f.eos();
  // Three views tell less of the same camera, and nothing is known of the other size.
  const bool is_other_size = __i__ == 1;
  fail_unless_equals_int(read_calibration(folder / "cam.json")->views.size(),
                         is_other_size ? 3 : 20);
}
GST_END_TEST;

GST_START_TEST(test_a_removed_view_leaves_the_file) {
  check::TemporaryFolder folder;
  SolveFixture f("location=" + folder / "cam.json");
  f.push_views(20);
  g_signal_emit_by_name(f.element, "solve");
  for (int i = 0; i < 1000 && f.result("final") == nullptr; ++i) g_usleep(10000);
  const std::size_t before = f.bus.named("calib-result").size();
  gboolean removed = FALSE;
  g_signal_emit_by_name(f.element, "remove-view", 19U, &removed);
  fail_unless(removed);
  wait_for_results(f, before + 1);
  fail_unless_equals_int(read_calibration(folder / "cam.json")->views.size(), 19);
}
GST_END_TEST;

// As a colleague who copies a good calibration there while the session goes on.
GST_START_TEST(test_what_is_put_there_meanwhile_is_not_ours) {
  check::TemporaryFolder folder;
  const std::string path = folder / "cam.json";
  SolveFixture f("location=" + path);
  push_slowly(f, 3);
  fail_unless_equals_int(read_calibration(path)->views.size(), 3);
  leave(path, f, 1e-6);
  push_slowly(f, 12, 3);
  fail_unless(is_left(path));
  fail_unless_equals_int(infos(f), 1);
  f.eos();
  fail_unless(is_left(path));
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "stays"));
}
GST_END_TEST;

// GLib knows no date past the year 9999.
static bool clock_is_astray = false;
extern "C" {
GDateTime* stray_date() asm("g_date_time_new_now_utc");
GDateTime* stray_date() {
  return clock_is_astray ? nullptr : g_date_time_new_from_unix_utc(g_get_real_time() / 1000000);
}
}

// Whoever has a good file need not calibrate again, and is told so before being asked for more.
GST_START_TEST(test_the_calibration_of_before_is_judged_first) {
  const bool moved = __i__ == 1;
  check::TemporaryFolder folder;
  SolveFixture f("location=" + folder / "cam.json", {}, "capture-mode=auto ");
  Calibration before = f.scene.camera.to_calibration();
  before.camera = "left";
  if (moved) before.parameters[0].value *= 1.02;
  fail_unless(write_calibration(folder / "cam.json", before).has_value());
  // The element has read nothing yet: it starts anew.
  gst_element_set_state(f.element, GST_STATE_READY);
  gst_element_set_state(f.element, GST_STATE_PLAYING);
  gst_harness_push_event(f.h, gst_event_new_stream_start("again"));
  gst_harness_set_src_caps(f.h, check::caps_of("GRAY8", f.scene.size));
  // Under a sanitizer the worker needs seconds for what was captured.
  for (int n = 0; n < 1500 && f.bus.named("calib-check").empty(); ++n) {
    if (n < 60) {
      g_signal_emit_by_name(f.element, "capture-view");
      gst_buffer_unref(f.push(n));
    }
    g_usleep(20000);
  }
  const auto checks = f.bus.named("calib-check");
  fail_unless_equals_int(checks.size(), 1);
  fail_unless(check::get(checks[0], "moved-sigma") > 0);
  const std::string hint = gst_structure_get_string(checks[0], "hint");
  const char* const words = moved ? "does not hold any more" : "still holds";
  fail_unless(hint.find(words) != std::string::npos, "%s", hint.c_str());
  g_usleep(20000);
  g_autoptr(GstBuffer) out = f.push(100);
  // By now it may be judged by one more view.
  const std::string shown = gst::read_guidance(out)->hint;
  fail_unless(shown.find(words) != std::string::npos, "%s", shown.c_str());
  fail_unless_equals_int(f.bus.says(GST_MESSAGE_WARNING, words), moved);
}
GST_END_TEST;

GST_START_TEST(test_a_clock_that_is_astray_dates_nothing) {
  check::TemporaryFolder folder;
  for (const bool astray : {false, true}) {
    clock_is_astray = astray;
    SolveFixture f("location=" + folder / "cam.json");
    f.push_views(3);
    f.eos();
    clock_is_astray = false;
    fail_unless(read_calibration(folder / "cam.json")->created.empty() == astray);
  }
}
GST_END_TEST;

static Suite* calibsolve_sessions_suite() {
  Suite* suite = suite_create("calibsolve_sessions");
  TCase* tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_checked_fixture(tc, gst::register_metas, nullptr);
  tcase_add_test(tc, test_a_good_calibration_stays_until_the_result_is_final);
  tcase_add_test(tc, test_the_signal_solve_replaces_what_is_as_good);
  tcase_add_loop_test(tc, test_a_worse_final_result_says_so_and_keeps_what_was_there, 0, 2);
  tcase_add_loop_test(tc, test_views_that_contradict_a_better_file_replace_it, 0, 2);
  tcase_add_test(tc, test_what_was_replaced_is_kept);
  tcase_add_test(tc, test_what_is_as_good_replaces_it_at_once);
  tcase_add_test(tc, test_what_cannot_be_compared_stays);
  tcase_add_test(tc, test_what_cannot_be_read_here_stays_and_is_kept);
  tcase_add_test(tc, test_what_is_no_calibration_does_not_stay);
  tcase_add_loop_test(tc, test_the_session_before_is_another_one, 0, 3);
  tcase_add_test(tc, test_a_removed_view_leaves_the_file);
  tcase_add_test(tc, test_what_is_put_there_meanwhile_is_not_ours);
  tcase_add_loop_test(tc, test_the_calibration_of_before_is_judged_first, 0, 2);
  tcase_add_test(tc, test_a_clock_that_is_astray_dates_nothing);
  return suite;
}

GST_CHECK_MAIN(calibsolve_sessions)
