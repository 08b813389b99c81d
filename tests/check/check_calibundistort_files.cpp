// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibundistort: calibrations that cannot be read, and files that come, change and go.

#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include "common/calibration_setting.hpp"
#include "undistort_fixture.hpp"

#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>

using namespace calvin;
using namespace calvin::check;

static const char* const kBroken[] = {"{\"format\": ", "<?xml version=\"1.0\"?><a/>",
                                      "fx=-1,fy=1,cx=1,cy=1,width=640,height=480",
                                      "fx=nan,fy=1,cx=1,cy=1", "%YAML:1.0\n---\n"};

// A parameter of what a setting holds.
static double value_of(const CameraSetting& setting, const char* name) {
  return std::get<Calibration>(setting).find(name)->value;
}

GST_START_TEST(test_an_unreadable_calibration_is_an_error_at_the_start) {
  GstElement* element = gst_element_factory_make("calibundistort", nullptr);
  gst_object_ref_sink(element);
  {
    check::Bus bus(element);
    g_object_set(element, "calibration", kBroken[__i__], nullptr);
    fail_unless(gst_element_set_state(element, GST_STATE_PAUSED) == GST_STATE_CHANGE_FAILURE);
    fail_unless_equals_int(bus.texts(GST_MESSAGE_ERROR).size(), 1);
    // It is fit for use again as soon as it has a good one.
    g_object_set(element, "calibration", kBarrel, nullptr);
    fail_if(gst_element_set_state(element, GST_STATE_PAUSED) == GST_STATE_CHANGE_FAILURE);
    gst_element_set_state(element, GST_STATE_NULL);
    bus.detach();
  }
  gst_object_unref(element);
}
GST_END_TEST;

GST_START_TEST(test_an_unreadable_calibration_while_running_is_a_warning) {
  Fixture f("calibundistort");
  g_object_set(f.element, "calibration", kBarrel, nullptr);
  f.set_caps("GRAY8", kSize);
  gst_buffer_unref(f.push(kSize, 0));
  g_object_set(f.element, "calibration", kBroken[__i__], nullptr);
  g_autoptr(GstBuffer) second = f.push(kSize, 1);
  fail_unless(gray_of(second, kSize) == expected_gray(kBarrel, kSize));
  fail_unless_equals_int(f.bus.texts(GST_MESSAGE_WARNING).size(), 1);
  fail_unless(f.bus.texts(GST_MESSAGE_ERROR).empty());
}
GST_END_TEST;

GST_START_TEST(test_a_calibration_that_is_set_again_is_read_again) {
  Fixture f("calibundistort");
  f.set_caps("GRAY8", kSize);
  int n = 0;
  for (const char* name : {"calibration", "calibration", "settings"}) {
    g_object_set(f.element, name, kBroken[0], nullptr);
    gst_buffer_unref(f.push(kSize, n++));
    gst_buffer_unref(f.push(kSize, n++));
  }
  fail_unless_equals_int(f.bus.texts(GST_MESSAGE_WARNING).size(), 3);
}
GST_END_TEST;

// Pushes frames, one every 20 ms, until one looks as `want`; false after ten seconds.
static bool comes_to(Fixture& f, const std::vector<guint8>& want, int& n) {
  for (int i = 0; i < 500; ++i) {
    g_autoptr(GstBuffer) out = f.push(kSize, n++);
    if (gray_of(out, kSize) == want) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return false;
}

// As of a program that copies a file with its times.
GST_START_TEST(test_a_file_of_equal_size_and_time_is_another_one) {
  check::TemporaryFolder folder;
  const std::string path = folder / "cam.json";
  const auto write = [&path](const char* fx) {
    std::ofstream(path) << "{\"format\":\"calvin-calibration\",\"version\":1,"
                           "\"image_size\":[320,240],\"model\":\"pinhole\",\"parameters\":{\"fx\":"
                        << fx << ",\"fy\":250,\"cx\":159.5,\"cy\":119.5}}";
    std::filesystem::last_write_time(path, {});
  };
  gst::CalibrationSetting setting;
  gst::CalibrationSetting::Clock::time_point now;
  write("250");
  setting.set(path);
  fail_unless(setting.poll(now).has_value());
  fail_if(setting.poll(now += std::chrono::seconds(1)).has_value());
  write("251");
  const auto second = setting.poll(now += std::chrono::seconds(1));
  fail_unless(second && value_of(**second, "fx") == 251);
}
GST_END_TEST;

GST_START_TEST(test_a_file_is_taken_in_when_it_appears_and_when_it_is_replaced) {
  check::TemporaryFolder folder;
  const std::string path = folder / "cam.json";
  Fixture f("calibundistort", __i__ == 1);
  g_object_set(f.element, "calibration", path.c_str(), nullptr);
  f.set_caps("GRAY8", kSize);
  int n = 0;
  GstBuffer* in = Fixture::noise("GRAY8", kSize, n++);
  g_autoptr(GstBuffer) out = gst_harness_push_and_pull(f.h, in);
  fail_unless(in == out);
  while (!f.bus.says(GST_MESSAGE_WARNING, "cam.json")) gst_buffer_unref(f.push(kSize, n++));

  fail_unless(write_calibration(path, calibration_of(kBarrel)).has_value());
  fail_unless(comes_to(f, expected_gray(kBarrel, kSize), n));
  fail_unless(write_calibration(path, calibration_of(kPincushion)).has_value());
  fail_unless(comes_to(f, expected_gray(kPincushion, kSize), n));

  // A broken replacement is heard of and changes nothing.
  const auto before = f.bus.texts(GST_MESSAGE_WARNING).size();
  std::ofstream(path) << "{\"format\": \"calvin-cal";
  for (int i = 0; i < 500 && f.bus.texts(GST_MESSAGE_WARNING).size() == before; ++i) {
    g_autoptr(GstBuffer) frame = f.push(kSize, n++);
    fail_unless(gray_of(frame, kSize) == expected_gray(kPincushion, kSize));
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  fail_unless_equals_int(f.bus.texts(GST_MESSAGE_WARNING).size(), before + 1);

  // So is one that goes, and it is taken in when it is back.
  std::filesystem::remove(path);
  while (!f.bus.says(GST_MESSAGE_WARNING, "stays in force")) {
    g_autoptr(GstBuffer) frame = f.push(kSize, n++);
    fail_unless(gray_of(frame, kSize) == expected_gray(kPincushion, kSize));
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  fail_unless_equals_int(f.bus.texts(GST_MESSAGE_WARNING).size(), before + 2);
  fail_unless(write_calibration(path, calibration_of(kBarrel)).has_value());
  fail_unless(comes_to(f, expected_gray(kBarrel, kSize), n));
}
GST_END_TEST;

// Numbers that make a picture of one colour are heard of once, be they set or sent.
GST_START_TEST(test_a_calibration_that_is_valid_nearly_nowhere_is_said) {
  static const char* const kPoor[] = {"fx=480,fy=478,cx=325,cy=236,k1=-1e6,width=640,height=480",
                                      "fx=1e-3,fy=1e-3,cx=325,cy=236,width=640,height=480"};
  for (const bool sent : {false, true}) {
    Fixture f("calibundistort");
    f.set_caps("GRAY8", kSize);
    int n = 0;
    const auto take = [&](const char* text) {
      if (sent) {
        gst_harness_push_event(f.h, event_of(text));
      } else {
        g_object_set(f.element, "calibration", text, nullptr);
      }
      for (int i = 0; i < 3; ++i) gst_buffer_unref(f.push(kSize, n++));
    };
    const auto said = [&] {
      int count = 0;
      for (const auto& text : f.bus.texts(GST_MESSAGE_WARNING)) {
        count += text.find("% of its picture") != std::string::npos ? 1 : 0;
      }
      return count;
    };
    take(kBarrel);
    fail_unless_equals_int(said(), 0);
    take(kPoor[__i__]);
    fail_unless_equals_int(said(), 1);
    take(kBarrel);
    take("fx=193,fy=193,cx=320,cy=240,model=fisheye,width=640,height=480");
    fail_unless_equals_int(said(), 1);
    take(kPoor[1 - __i__]);
    fail_unless_equals_int(said(), 2);
  }
}
GST_END_TEST;

// Names of files are bytes; what is shown of them is UTF-8.
GST_START_TEST(test_a_name_need_not_be_utf8) {
  check::TemporaryFolder folder;
  const std::string path = folder / "caf\xe9.json";
  Fixture f("calibundistort");
  g_object_set(f.element, "calibration", path.c_str(), nullptr);
  f.set_caps("GRAY8", kSize);
  int n = 0;
  while (!f.bus.says(GST_MESSAGE_WARNING, "caf")) gst_buffer_unref(f.push(kSize, n++));
  for (const std::string& text : f.bus.texts(GST_MESSAGE_WARNING)) {
    fail_unless(g_utf8_validate(text.c_str(), -1, nullptr), "%s", text.c_str());
  }
  fail_unless(write_calibration(path, calibration_of(kBarrel)).has_value());
  fail_unless(comes_to(f, expected_gray(kBarrel, kSize), n));
}
GST_END_TEST;

// A clock that goes when the test says so, and a file written by a writer that renames nothing.
GST_START_TEST(test_a_half_written_file_is_waited_for) {
  check::TemporaryFolder folder;
  const std::string path = folder / "cam.json";
  const std::string whole = print_calibration(calibration_of(kPincushion)).value();
  fail_unless(write_calibration(path, calibration_of(kBarrel)).has_value());
  gst::CalibrationSetting::Clock::time_point now;
  gst::CalibrationSetting setting;
  setting.set(path);
  const auto next = [&] {
    now += std::chrono::milliseconds(600);
    return setting.poll(now);
  };
  fail_unless(value_of(next()->value(), "k1") == -0.28);
  fail_if(next().has_value());

  std::ofstream(path) << whole.substr(0, whole.size() / 2);
  fail_if(next().has_value());
  std::ofstream(path) << whole;
  fail_unless(value_of(next()->value(), "k1") == 0.1);
  fail_if(next().has_value());

  // It stays as it is: then it is broken, and that is said once.
  std::ofstream(path) << whole.substr(0, whole.size() / 3);
  fail_if(next().has_value());
  fail_if(next().value().has_value());
  fail_if(next().has_value());
  // Gone, which is said once, and back again.
  std::filesystem::remove(path);
  fail_if(next().has_value());
  fail_unless(next().value().error().code == ErrorCode::kNotFound);
  fail_if(next().has_value());
  fail_unless(write_calibration(path, calibration_of(kBarrel)).has_value());
  fail_unless(value_of(next()->value(), "k1") == -0.28);
}
GST_END_TEST;

static Suite* calibundistort_files_suite() {
  Suite* suite = suite_create("calibundistort_files");
  TCase* tc = tcase_create("general");
  const int broken = static_cast<int>(std::size(kBroken));
  tcase_add_test(tc, test_a_file_of_equal_size_and_time_is_another_one);
  tcase_add_loop_test(tc, test_an_unreadable_calibration_is_an_error_at_the_start, 0, broken);
  tcase_add_loop_test(tc, test_an_unreadable_calibration_while_running_is_a_warning, 0, broken);
  tcase_add_test(tc, test_a_calibration_that_is_set_again_is_read_again);
  tcase_add_loop_test(tc, test_a_file_is_taken_in_when_it_appears_and_when_it_is_replaced, 0, 2);
  tcase_add_loop_test(tc, test_a_calibration_that_is_valid_nearly_nowhere_is_said, 0, 2);
  tcase_add_test(tc, test_a_name_need_not_be_utf8);
  tcase_add_test(tc, test_a_half_written_file_is_waited_for);
  suite_add_tcase(suite, tc);
  return suite;
}

GST_CHECK_MAIN(calibundistort_files)
