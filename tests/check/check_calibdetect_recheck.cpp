// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibdetect's recheck: whether a calibration still fits the camera, said with every board.

#include <cmath>
#include <cstring>
#include <string>

#include "calvin/io/calibration_io.hpp"
#include "common/values.hpp"
#include "detect_fixture.hpp"
#include "support.hpp"

#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>

using namespace calvin;

// The camera's own calibration, with the focal length times `factor`.
static std::string calibration_of(const check::Scene& scene, double factor) {
  Calibration calibration = scene.camera.to_calibration();
  calibration.parameters[0].value *= factor;
  calibration.parameters[1].value *= factor;
  return print_calibration(calibration).value();
}

static double number(const GstStructure* s, const char* field) {
  double value = NAN;
  fail_unless(gst_structure_get_double(s, field, &value), "no %s", field);
  return value;
}

GST_START_TEST(test_recheck_tells_a_camera_from_another) {
  for (const double factor : {1.0, 1.02}) {
    check::DetectFixture f("calibdetect mode=sync camera=left");
    g_object_set(f.element, "recheck", calibration_of(f.scene, factor).c_str(), nullptr);
    constexpr int kFrames = 12;
    for (int n = 0; n < kFrames; ++n) {
      gst_harness_push(f.h, check::frame_of(f.scene.picture(n), "GRAY8", n));
    }
    const auto checks = f.bus.named("calib-check");
    fail_unless_equals_int(checks.size(), kFrames);
    const GstStructure* last = checks.back();
    fail_unless_equals_string(gst_structure_get_string(last, "camera"), "left");
    fail_unless_equals_string(gst_structure_get_string(last, "board"), "checkerboard:9x6:25mm");
    fail_if(gst_structure_has_field(last, "expected-error"), "the calibration has none");
    // 2 % of the focal length: 8 px in the corners of a picture whose half diagonal is 400 px.
    const double moved = number(last, "moved");
    const double sigma = number(last, "moved-sigma");
    fail_unless(sigma > 0 && sigma < 1, "sigma %f", sigma);
    if (factor == 1) {
      fail_unless(moved == 0, "moved %f", moved);
      fail_if(gst_structure_has_field(last, "hint"), "nothing is to be done");
      fail_unless(number(last, "rms") < 0.15, "rms %f", number(last, "rms"));
      const Pose truth = to_pose(f.scene.pose(kFrames - 1));
      const auto translation = gst::get_doubles(last, "translation");
      const auto rotation = gst::get_doubles(last, "rotation");
      for (std::size_t i = 0; i < 3; ++i) {
        fail_unless(std::abs(translation.at(i) - truth.translation[i]) < 2e-3);
        fail_unless(std::abs(rotation.at(i) - truth.rotation[i]) < 1e-2);
      }
    } else {
      fail_unless(moved > 4 && moved < 12, "moved %f", moved);
      fail_unless(std::strstr(gst_structure_get_string(last, "hint"), "has moved") != nullptr);
    }
  }
}
GST_END_TEST;

GST_START_TEST(test_recheck_that_cannot_be_read) {
  for (const char* text : {"/no/such/file.json", "{", "fx=1"}) {
    const auto texts = check::errors_at_start("calibdetect", "recheck", text);
    fail_unless(texts.size() == 1 && texts[0].find("recheck") != std::string::npos, "for '%s'",
                text);
  }
  check::DetectFixture f;
  g_object_set(f.element, "recheck", calibration_of(f.scene, 1).c_str(), nullptr);
  gst_harness_push(f.h, check::frame_of(f.scene.picture(1), "GRAY8", 0));
  g_object_set(f.element, "recheck", "/no/such/file.json", nullptr);
  int n = 1;
  while (!f.bus.says(GST_MESSAGE_WARNING, "/no/such/file.json")) {
    gst_harness_push(f.h, check::frame_of(f.scene.picture(1), "GRAY8", n++));
  }
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "The calibration that recheck had goes on."));
  fail_unless_equals_int(f.bus.named("calib-check").size(), n);
}
GST_END_TEST;

GST_START_TEST(test_recheck_of_a_calibration_of_another_aspect) {
  check::DetectFixture f;
  g_object_set(f.element, "recheck",
               "fx=500,fy=500,cx=639.5,cy=359.5,width=1280,height=720,model=pinhole", nullptr);
  for (int n = 0; n < 3; ++n) {
    gst_harness_push(f.h, check::frame_of(f.scene.picture(n), "GRAY8", n));
  }
  fail_unless(f.bus.named("calib-check").empty());
  fail_unless_equals_int(f.bus.texts(GST_MESSAGE_WARNING).size(), 1);
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "aspect"));
}
GST_END_TEST;

static Suite* calibdetect_recheck_suite() {
  Suite* suite = suite_create("calibdetect_recheck");
  TCase* tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_checked_fixture(tc, gst::register_metas, nullptr);
  tcase_add_test(tc, test_recheck_tells_a_camera_from_another);
  tcase_add_test(tc, test_recheck_that_cannot_be_read);
  tcase_add_test(tc, test_recheck_of_a_calibration_of_another_aspect);
  return suite;
}

GST_CHECK_MAIN(calibdetect_recheck)
