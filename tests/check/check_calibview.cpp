// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibview: a picture of a rig that goes around it, follows the mouse and its file.

#include <cmath>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "calvin/core/file.hpp"
#include "calvin/io/rig_io.hpp"
#include "calvin_config.h"
#include "view_fixture.hpp"

#include <gst/check/gstcheck.h>
#include <gst/video/navigation.h>

using namespace calvin;
using check::rig_of;
using check::ViewFixture;

#if CALVIN_HAVE_CAIRO

GST_START_TEST(test_stands_still_or_goes_around) {
  ViewFixture still;
  gst_harness_play(still.h);
  const auto shown = still.pull();
  fail_unless_equals_int(shown.size(), 4 * 320 * 240);
  fail_unless(shown == still.pull());
  ViewFixture around("orbit=30");
  gst_harness_play(around.h);
  GstClockTime before = 0;
  GstClockTime pts = 0;
  const auto begin = around.pull(&before);
  fail_unless(begin == shown && begin != around.pull(&pts));
  fail_unless_equals_uint64((pts - before) / GST_MSECOND, 33);
}
GST_END_TEST;

GST_START_TEST(test_is_drawn_in_every_format) {
  ViewFixture f;
  gst_harness_play(f.h);
  const auto shown = f.pull();
  int bright = 0;
  for (std::size_t i = 1; i < shown.size(); i += 4) bright += shown[i] > 100 ? 1 : 0;
  for (const char* format : {"I420", "NV12", "GRAY8", "RGB", "v210"}) {
    ViewFixture other;
    gst_harness_set_sink_caps_str(
        other.h,
        (std::string("video/x-raw,width=320,height=240,framerate=30/1,format=") + format).c_str());
    gst_harness_play(other.h);
    const auto pixels = other.pull();
    if (std::strcmp(format, "GRAY8") != 0) continue;
    int grey = 0;
    for (const std::uint8_t pixel : pixels) grey += pixel > 100 ? 1 : 0;
    fail_unless(grey > bright / 2 && grey < 2 * bright, "%d %d", grey, bright);
  }
  // Colours come before grey, in whatever order they are named.
  ViewFixture choice;
  gst_harness_set_sink_caps_str(choice.h,
                                "video/x-raw,width=320,height=240,framerate=30/1,format=GRAY8;"
                                "video/x-raw,width=320,height=240,framerate=30/1,format=RGB");
  gst_harness_play(choice.h);
  fail_unless_equals_int(choice.pull().size(), 3 * 320 * 240);
}
GST_END_TEST;

GST_START_TEST(test_follows_the_file) {
  ViewFixture f;
  gst_harness_play(f.h);
  const auto before = f.pull();
  // Half a file is none: the old rig stays.
  const std::string text = print_rig(rig_of(0.5)).value();
  g_file_set_contents(f.location.c_str(), text.c_str(), 100, nullptr);
  for (int n = 0; n < 45; ++n) fail_unless(f.pull() == before);
  RigCamera third = rig_of(0.3).cameras[1];
  third.calibration.camera = "third";
  Rig more = rig_of(0.1);
  more.cameras.push_back(third);
  (void)write_rig(f.location, more);
  fail_unless(f.changes_from(before));
}
GST_END_TEST;

// Of a folder every file: those of mrcal are one for each camera.
GST_START_TEST(test_follows_the_files_of_a_folder) {
  for (const char* format : {"mrcal", "colmap"}) {
    check::TemporaryFolder folder;
    const std::string models = folder / "models";
    fail_unless(write_rig(models, rig_of(0.1), format).has_value());
    ViewFixture f("orbit=0 rig=" + models);
    gst_harness_play(f.h);
    const auto before = f.pull();
    // Looked at twice a second, and nothing has changed.
    for (int n = 0; n < 45; ++n) fail_unless(f.pull() == before);
    // The second camera has moved, of which the last file tells, and no other is touched.
    const std::string others = folder / "others";
    fail_unless(write_rig(others, rig_of(0.5), format).has_value());
    const std::string moved = files_of_rig(models).back();
    g_autofree char* text = nullptr;
    gsize length = 0;
    g_file_get_contents(files_of_rig(others).back().c_str(), &text, &length, nullptr);
    fail_unless(write_file(moved, std::string(text, length)).has_value());
    fail_unless(f.changes_from(before), "%s", format);
    // A camera more.
    for (int n = 0; n < 30; ++n) f.pull();
    const auto wider = f.pull();
    Rig more = rig_of(0.5);
    more.cameras.push_back(rig_of(0.3).cameras[1]);
    more.cameras.back().calibration.camera = "third";
    fail_unless(write_rig(models, more, format).has_value());
    fail_unless(f.changes_from(wider), "%s", format);
  }
}
GST_END_TEST;

GST_START_TEST(test_the_mouse_turns_and_comes_closer) {
  ViewFixture f;
  gst_harness_play(f.h);
  const auto send = [&](GstEvent* event) { gst_harness_push_upstream_event(f.h, event); };
  const auto none = static_cast<GstNavigationModifierType>(0);
  const auto before = f.pull();
  send(gst_navigation_event_new_mouse_move(50, 50, none));
  fail_if(f.pull() != before, "no button is held");
  send(gst_navigation_event_new_mouse_button_press(1, 50, 50, none));
  send(gst_navigation_event_new_mouse_move(120, 60, none));
  send(gst_navigation_event_new_mouse_button_release(1, 120, 60, none));
  fail_unless(f.changes_from(before));
  for (int n = 0; n < 20; ++n) f.pull();
  const auto turned = f.pull();
  send(gst_navigation_event_new_mouse_move(10, 10, none));
  fail_if(f.pull() != turned, "the button was let go");
  send(gst_navigation_event_new_mouse_scroll(10, 10, 0, 1, none));
  fail_unless(f.changes_from(turned));
}
GST_END_TEST;

GST_START_TEST(test_a_mouse_that_is_nowhere_turns_nothing) {
  ViewFixture f;
  gst_harness_play(f.h);
  const auto none = static_cast<GstNavigationModifierType>(0);
  const auto before = f.pull();
  const auto move_to = [&](double x, double y) {
    gst_harness_push_upstream_event(f.h, gst_navigation_event_new_mouse_move(x, y, none));
  };
  gst_harness_push_upstream_event(f.h,
                                  gst_navigation_event_new_mouse_button_press(1, 50, 50, none));
  move_to(HUGE_VAL, 50);
  move_to(50, std::nan(""));
  move_to(50, 50);
  for (int n = 0; n < 20; ++n) fail_unless(f.pull() == before);
  move_to(120, 60);
  fail_unless(f.changes_from(before));
}
GST_END_TEST;

GST_START_TEST(test_states_and_live) {
  check::TemporaryFolder folder;
  const std::string location = folder / "rig.json";
  (void)write_rig(location, rig_of(0.1));
  for (const char* live : {"false", "true"}) {
    g_autoptr(GstElement) pipeline = gst_parse_launch(
        ("calibview num-buffers=3 rig=" + location + " is-live=" + live + " ! fakesink").c_str(),
        nullptr);
    g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
    for (int n = 0; n < 3; ++n) {
      gst_element_set_state(pipeline, GST_STATE_PLAYING);
      g_autoptr(GstMessage) end = gst_bus_timed_pop_filtered(
          bus, 60 * GST_SECOND, static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR));
      fail_unless(end != nullptr && GST_MESSAGE_TYPE(end) == GST_MESSAGE_EOS);
      gst_element_set_state(pipeline, GST_STATE_READY);
    }
    gst_bus_set_flushing(bus, TRUE);
    gst_element_set_state(pipeline, GST_STATE_NULL);
  }
}
GST_END_TEST;

#endif

// What is no rig is an error; one that is not there yet may come, from a calibrig that runs.
GST_START_TEST(test_no_rig_says_what_to_set) {
  const auto texts = check::errors_at_start("calibview", "rig", "{}");
  fail_unless(!texts.empty() && texts[0].find("Give a file that calvin-rig") != std::string::npos);
  for (const char* rig : {"", "/nowhere/rig.json"}) {
    GstElement* element = gst_element_factory_make("calibview", nullptr);
    gst_object_ref_sink(element);
    {
      check::Bus bus(element);
      g_object_set(element, "rig", rig, nullptr);
      fail_if(gst_element_set_state(element, GST_STATE_PAUSED) == GST_STATE_CHANGE_FAILURE);
      const auto warnings = bus.texts(GST_MESSAGE_WARNING);
      fail_unless_equals_int(warnings.size(), 1);
      fail_unless(warnings[0].find(*rig == 0 ? "rig=FILE" : "/nowhere") != std::string::npos);
      gst_element_set_state(element, GST_STATE_NULL);
      bus.detach();
    }
    gst_object_unref(element);
  }
}
GST_END_TEST;

static Suite* calibview_suite(void) {
  Suite* s = suite_create("calibview");
  TCase* tc = tcase_create("general");
  suite_add_tcase(s, tc);
  tcase_set_timeout(tc, 60);
#if CALVIN_HAVE_CAIRO
  tcase_add_test(tc, test_stands_still_or_goes_around);
  tcase_add_test(tc, test_is_drawn_in_every_format);
  tcase_add_test(tc, test_follows_the_file);
  tcase_add_test(tc, test_follows_the_files_of_a_folder);
  tcase_add_test(tc, test_the_mouse_turns_and_comes_closer);
  tcase_add_test(tc, test_a_mouse_that_is_nowhere_turns_nothing);
  tcase_add_test(tc, test_states_and_live);
#endif
  tcase_add_test(tc, test_no_rig_says_what_to_set);
  return s;
}

GST_CHECK_MAIN(calibview);
