// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibrig where a board moves all the time: clocks that disagree are told of, and the frame of the
// rig is where the board was first.

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "calvin/io/rig_io.hpp"
#include "rig_fixture.hpp"

#include <gst/check/gstcheck.h>

using namespace calvin;

using check::RigFixture;

// The offset of the second camera, with its sigma, in the message and in the file.
GST_START_TEST(test_clocks_that_disagree) {
  constexpr gint64 kBehind = 6 * GST_MSECOND;
  RigFixture f(rig_views::swinging(8, 1e-9 * kBehind));
  const std::string location = f.folder / "rig.json";
  gst_element_set_state(f.element, GST_STATE_NULL);
  g_object_set(f.element, "location", location.c_str(), "tolerance", 15 * GST_MSECOND, nullptr);
  f.run();
  const GstStructure* result = f.final_result();
  fail_unless(result != nullptr);
  const GValue* offsets = gst_structure_get_value(result, "time-offsets");
  fail_unless(offsets != nullptr);
  fail_unless_equals_int(gst_value_array_get_size(offsets), 1);
  const GstStructure* one = gst_value_get_structure(gst_value_array_get_value(offsets, 0));
  fail_unless_equals_string(gst_structure_get_string(one, "camera"), "cam1");
  gint64 offset = 0;
  gint64 sigma = 0;
  gst_structure_get_int64(one, "offset", &offset);
  gst_structure_get_int64(one, "sigma", &sigma);
  fail_unless(sigma > 0 && sigma < static_cast<gint64>(GST_MSECOND), "%" G_GINT64_FORMAT, sigma);
  fail_unless(std::abs(offset - kBehind) < 4 * sigma,
              "%" G_GINT64_FORMAT " ns, +- %" G_GINT64_FORMAT, offset, sigma);
  const auto rig = read_rig(location);
  fail_unless(rig.has_value() && rig->cameras[1].time_offset.has_value());
  fail_unless(f.worst(*rig) < 5, "%f sigmas", f.worst(*rig));
}
GST_END_TEST;

GST_START_TEST(test_clocks_that_agree) {
  RigFixture f(rig_views::swinging(4, 0));
  f.run();
  const GstStructure* result = f.final_result();
  fail_unless(result != nullptr);
  const GValue* offsets = gst_structure_get_value(result, "time-offsets");
  fail_unless(offsets == nullptr || gst_value_array_get_size(offsets) == 0);
}
GST_END_TEST;

GST_START_TEST(test_frame_of_the_board) {
  RigFixture f(rig_views::stereo());
  gst_element_set_state(f.element, GST_STATE_NULL);
  g_object_set(f.element, "world", "board:x180", nullptr);
  f.run();
  const GstStructure* result = f.final_result();
  fail_unless(result != nullptr);
  const auto rig = parse_rig(gst_structure_get_string(result, "json"));
  fail_unless(rig.has_value());
  fail_unless_equals_string(rig->world.c_str(), "board");
  const SE3 found =
      to_se3(rig->cameras[0].rig_from_camera).inverse() * to_se3(rig->cameras[1].rig_from_camera);
  const SE3 truth = f.cameras[0].world_from_camera.inverse() * f.cameras[1].world_from_camera;
  fail_unless((found.translation - truth.translation).norm() < 1e-3);
  for (const RigCamera& camera : rig->cameras) {
    fail_unless(camera.rig_from_camera.translation[2] > 0.1, "z does not point up");
    fail_unless_equals_int(camera.covariance.size(), 36);
  }
}
GST_END_TEST;

// Said at once, where the text is none and where no camera is called so.
GST_START_TEST(test_frame_that_nobody_has) {
  const std::pair<const char*, const char*> frames[] = {{"board:x45", "board:x180"},
                                                        {"middle", "'cam0', 'cam1'"}};
  for (const auto& [world, told] : frames) {
    RigFixture f(rig_views::stereo());
    gst_element_set_state(f.element, GST_STATE_NULL);
    g_object_set(f.element, "world", world, "location", (f.folder / "rig.json").c_str(), nullptr);
    fail_unless_equals_int(gst_element_set_state(f.element, GST_STATE_PLAYING),
                           GST_STATE_CHANGE_FAILURE);
    const std::vector<std::string> errors = f.bus.texts(GST_MESSAGE_ERROR);
    fail_unless_equals_int(errors.size(), 1);
    fail_unless(errors[0].find(told) != std::string::npos, "%s", errors[0].c_str());
  }
}
GST_END_TEST;

static Suite* calibrig_clocks_suite() {
  Suite* suite = suite_create("calibrig_clocks");
  TCase* tcase = tcase_create("general");
  suite_add_tcase(suite, tcase);
  tcase_add_test(tcase, test_clocks_that_disagree);
  tcase_add_test(tcase, test_clocks_that_agree);
  tcase_add_test(tcase, test_frame_of_the_board);
  tcase_add_test(tcase, test_frame_that_nobody_has);
  return suite;
}

GST_CHECK_MAIN(calibrig_clocks)
