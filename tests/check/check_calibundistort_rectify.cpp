// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibundistort: frames of a stereo pair, rectified.

#include <string>
#include <utility>

#include "calvin/core/file.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/io/rig_io.hpp"
#include "common/rig_event.hpp"
#include "rectified_pair.hpp"
#include "undistort_fixture.hpp"

#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>

using namespace calvin;
using namespace calvin::check;

static Rig pair_of(const char* first, const char* second) {
  return scenes::rig_of(camera_of(first), camera_of(second),
                        {exp_so3({0.02, -0.04, 0.01}), {0.1, 0.002, 0.003}});
}

static Rig pair() { return pair_of(kBarrel, kPincushion); }

static std::string text_of(const Rig& rig) { return print_rig(rig).value(); }

// What the library makes of the grey noise of one side.
static std::vector<guint8> rectified_gray(const Rig& rig, StereoSide side,
                                          const ViewOptions& view = {}) {
  return gray_through(scenes::rectifier(rig, side, view).value());
}

static const struct {
  std::string words;
  StereoSide side;
} kSides[] = {{"calibundistort rectify=left", StereoSide::kLeft},
              {"calibundistort rectify=right", StereoSide::kRight}};

// The text of the rig, its file, the event of a calibrig; and with an alpha.
GST_START_TEST(test_frames_are_what_the_library_rectifies) {
  const auto& [words, side] = kSides[__i__];
  const TemporaryFolder folder;
  const std::string file = folder / "rig.json";
  fail_unless(write_rig(file, pair()).has_value());
  ViewOptions view;
  for (const std::string& calibration : {text_of(pair()), file, std::string()}) {
    const bool is_file = calibration == file;
    Fixture f((words + (is_file ? " calibration=" + file : std::string())).c_str());
    if (!is_file) g_object_set(f.element, "calibration", calibration.c_str(), nullptr);
    g_object_set(f.element, "alpha", view.alpha, nullptr);
    f.set_caps("GRAY8", kSize);
    if (calibration.empty()) {
      gst_harness_push_event(f.h, gst::new_rig_event(text_of(pair())));
    }
    g_autoptr(GstBuffer) out = f.push(kSize);
    fail_unless(gray_of(out, kSize) == rectified_gray(pair(), side, view), "'%s'",
                calibration.c_str());
    fail_unless(f.bus.texts(GST_MESSAGE_WARNING).empty());
    view.alpha += 0.5;
  }
}
GST_END_TEST;

GST_START_TEST(test_both_sides_announce_the_same_pinhole) {
  std::vector<Calibration> of;
  for (const auto& [words, side] : kSides) {
    Fixture f(words.c_str());
    g_object_set(f.element, "calibration", text_of(pair()).c_str(), nullptr);
    f.set_caps("GRAY8", kSize);
    gst_buffer_unref(f.push(kSize));
    const auto announced = parse_calibration(output_calibration(f));
    fail_unless(announced.has_value());
    fail_unless_equals_string(announced->model.c_str(), "pinhole");
    fail_unless_equals_string(announced->camera.c_str(),
                              side == StereoSide::kLeft ? "first" : "second");
    of.push_back(*announced);
  }
  fail_unless(Camera::make(of[0])->parameters() == Camera::make(of[1])->parameters());
}
GST_END_TEST;

GST_START_TEST(test_the_event_goes_on_and_a_newer_one_counts) {
  Fixture f("calibundistort rectify=left");
  f.set_caps("GRAY8", kSize);
  g_autoptr(GstBuffer) before = f.push(kSize);
  g_autoptr(GstBuffer) noise = Fixture::noise("GRAY8", kSize, 0);
  fail_unless(gray_of(before, kSize) == gray_of(noise, kSize));
  for (const Rig& rig : {pair(), pair_of(kBarrel, kBarrel)}) {
    gst_harness_push_event(f.h, gst::new_rig_event(text_of(rig)));
    g_autoptr(GstBuffer) out = f.push(kSize);
    fail_unless(gray_of(out, kSize) == rectified_gray(rig, StereoSide::kLeft));
  }
  int rigs = 0;
  while (GstEvent* event = gst_harness_try_pull_event(f.h)) {
    rigs += gst::parse_rig_event(event) ? 1 : 0;
    gst_event_unref(event);
  }
  fail_unless_equals_int(rigs, 2);
  gst_harness_push_event(f.h, gst::new_rig_event("{\"no\": \"rig\"}"));
  g_autoptr(GstBuffer) out = f.push(kSize);
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "cannot be used as a rig"));
  fail_unless(gray_of(out, kSize) == rectified_gray(pair_of(kBarrel, kBarrel), StereoSide::kLeft));
}
GST_END_TEST;

GST_START_TEST(test_a_side_is_chosen_while_frames_flow) {
  Fixture f("calibundistort");
  g_object_set(f.element, "calibration", text_of(pair()).c_str(), nullptr);
  f.set_caps("GRAY8", kSize);
  g_autoptr(GstBuffer) plain = f.push(kSize);
  g_autoptr(GstBuffer) noise = Fixture::noise("GRAY8", kSize, 0);
  fail_unless(gray_of(plain, kSize) == gray_of(noise, kSize));
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "rectify=left"));
  for (const StereoSide side : {StereoSide::kRight, StereoSide::kLeft}) {
    gst_util_set_object_arg(G_OBJECT(f.element), "rectify",
                            side == StereoSide::kLeft ? "left" : "right");
    g_autoptr(GstBuffer) out = f.push(kSize);
    fail_unless(gray_of(out, kSize) == rectified_gray(pair(), side));
  }
  gst_util_set_object_arg(G_OBJECT(f.element), "rectify", "none");
  g_object_set(f.element, "calibration", kBarrel, nullptr);
  g_autoptr(GstBuffer) out = f.push(kSize);
  fail_unless(gray_of(out, kSize) == expected_gray(kBarrel, kSize));
}
GST_END_TEST;

// One file that is the pair, and the calibration of its first camera: rectify says which.
static constexpr char kOpenCvPair[] = R"({"image_width": 640, "image_height": 480,
"M1": {"rows": 3, "cols": 3, "data": [480, 0, 325, 0, 478, 236, 0, 0, 1]},
"D1": {"rows": 1, "cols": 4, "data": [-0.28, 0.09, 0.0005, -0.0007]},
"M2": {"rows": 3, "cols": 3, "data": [485, 0, 318, 0, 484, 242, 0, 0, 1]},
"D2": {"rows": 1, "cols": 4, "data": [-0.27, 0.08, 0, 0]},
"R": {"rows": 3, "cols": 3, "data": [1, 0, 0, 0, 1, 0, 0, 0, 1]},
"T": {"rows": 3, "cols": 1, "data": [-0.1, 0.002, 0]}})";
static constexpr char kBouguetPair[] =
    "fc_left = [ 480 ; 478 ];\ncc_left = [ 325 ; 236 ];\n"
    "kc_left = [ -0.28 ; 0.09 ; 0.0005 ; -0.0007 ];\n"
    "fc_right = [ 485 ; 484 ];\ncc_right = [ 318 ; 242 ];\nkc_right = [ -0.27 ; 0.08 ; 0 ; 0 ];\n"
    "om = [ 0 ; 0 ; 0 ];\nT = [ -100 ; 2 ; 0 ];\nnx = 640;\nny = 480;\n";

GST_START_TEST(test_a_file_of_a_pair_is_also_one_of_its_first_camera) {
  const char* text = __i__ == 0 ? kOpenCvPair : kBouguetPair;
  const Rig rig = parse_rig(text).value();
  const TemporaryFolder folder;
  const std::string file = folder / "stereo";
  fail_unless(write_file(file, text).has_value());
  Fixture f(("calibundistort calibration=" + file).c_str());
  f.set_caps("GRAY8", kSize);
  g_autoptr(GstBuffer) plain = f.push(kSize);
  fail_unless(gray_of(plain, kSize) == expected_gray(kBarrel, kSize));
  for (const auto& [side, word] :
       {std::pair(StereoSide::kLeft, "left"), std::pair(StereoSide::kRight, "right")}) {
    gst_util_set_object_arg(G_OBJECT(f.element), "rectify", word);
    g_autoptr(GstBuffer) out = f.push(kSize);
    fail_unless(gray_of(out, kSize) == rectified_gray(rig, side), "%s", word);
  }
  fail_unless(f.bus.texts(GST_MESSAGE_WARNING).empty());
}
GST_END_TEST;

static Rig three() {
  Rig rig = pair();
  rig.cameras.push_back(rig.cameras.back());
  rig.cameras.back().calibration.camera = "third";
  return rig;
}

// What cannot be rectified passes, and is told once.
static const struct {
  const char* launch;
  Rig (*rig)();  // nullptr: a single calibration
  const char* word;
} kRefusals[] = {
    {"calibundistort rectify=left", nullptr, "wants a pair"},
    {"calibundistort rectify=left", three, "has 3"},
    {"calibundistort", pair, "is a rig"},
    {"calibundistort rectify=left projection=panini", pair, "projection=rectilinear"},
};

GST_START_TEST(test_what_cannot_be_rectified_passes_with_a_warning) {
  const auto& refusal = kRefusals[__i__];
  Fixture f(refusal.launch);
  const std::string text = refusal.rig == nullptr ? kBarrel : text_of(refusal.rig());
  g_object_set(f.element, "calibration", text.c_str(), nullptr);
  f.set_caps("GRAY8", kSize);
  for (int n = 0; n < 3; ++n) {
    g_autoptr(GstBuffer) out = f.push(kSize);
    g_autoptr(GstBuffer) noise = Fixture::noise("GRAY8", kSize, 0);
    fail_unless(gray_of(out, kSize) == gray_of(noise, kSize));
  }
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, refusal.word), "%s", refusal.word);
  fail_unless_equals_int(static_cast<int>(f.bus.texts(GST_MESSAGE_WARNING).size()), 1);
}
GST_END_TEST;

static Suite* calibundistort_rectify_suite() {
  Suite* suite = suite_create("calibundistort_rectify");
  TCase* tc = tcase_create("general");
  tcase_add_loop_test(tc, test_frames_are_what_the_library_rectifies, 0,
                      static_cast<int>(std::size(kSides)));
  tcase_add_test(tc, test_both_sides_announce_the_same_pinhole);
  tcase_add_test(tc, test_the_event_goes_on_and_a_newer_one_counts);
  tcase_add_test(tc, test_a_side_is_chosen_while_frames_flow);
  tcase_add_loop_test(tc, test_a_file_of_a_pair_is_also_one_of_its_first_camera, 0, 2);
  tcase_add_loop_test(tc, test_what_cannot_be_rectified_passes_with_a_warning, 0,
                      static_cast<int>(std::size(kRefusals)));
  suite_add_tcase(suite, tc);
  return suite;
}

GST_CHECK_MAIN(calibundistort_rectify)
