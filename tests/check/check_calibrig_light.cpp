// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibrig before a light that is carried through a room: lenses and places of the cameras come out
// as they are, and what cannot be solved is told.

#include <cstring>
#include <string>
#include <vector>

#include "calvin/io/rig_io.hpp"
#include "places_file.hpp"
#include "rig_fixture.hpp"

#include <gst/check/gstcheck.h>

using namespace calvin;

using check::RigFixture;

namespace {

// Where all cameras stand.
std::string places_of(const RigFixture& f) {
  std::vector<Calibration> cameras;
  std::vector<SE3> stand;
  for (const rig_views::SeenByCamera& camera : f.cameras) {
    cameras.push_back(camera.calibration);
    stand.push_back(camera.world_from_camera);
  }
  return check::write_places(f.folder, cameras, stand);
}

}  // namespace

// Reflections and gaps among what is seen; progress and result say what pairs have in common.
GST_START_TEST(test_a_light_tells_lenses_and_places) {
  RigFixture f(rig_views::lit_room(300), __i__ > 0);
  const std::string location = f.folder / "rig.json";
  gst_element_set_state(f.element, GST_STATE_NULL);
  const std::string places = places_of(f);
  g_object_set(f.element, "location", location.c_str(), "places", places.c_str(), nullptr);
  f.start();
  f.push_all();
  const auto progress = f.bus.named("calib-rig-progress");
  fail_unless(progress.size() > 20 && progress.size() < 600, "%zu", progress.size());
  int instants = 0;
  gst_structure_get_int(progress.back(), "instants", &instants);
  // A light where all cameras have seen one before is of no use.
  fail_unless(instants > 200 && instants <= 300, "%d", instants);
  f.end_all();
  const GstStructure* result = f.final_result();
  fail_unless(result != nullptr);
  fail_unless_equals_string(gst_structure_get_string(result, "unit"), "m");
  int rejected = 0;
  gst_structure_get_int(result, "rejected", &rejected);
  fail_unless(rejected > 50, "%d", rejected);
  fail_unless_equals_int(gst_value_array_get_size(gst_structure_get_value(result, "links")), 6);
  const auto rig = read_rig(location);
  fail_unless(rig.has_value() && rig->cameras.size() == 4);
  fail_unless(f.worst(*rig) < 4.5, "%f sigmas", f.worst(*rig));
  fail_unless(f.bus.texts(GST_MESSAGE_WARNING).empty());
}
GST_END_TEST;

// Without places lengths have no unit, and boards before the same cameras do not count.
GST_START_TEST(test_without_places_there_is_no_unit) {
  RigFixture f(rig_views::lit_room(200), false);
  g_object_set(f.element, "model", "pinhole", "fix", "aspect,center", nullptr);
  gst_util_set_object_arg(G_OBJECT(f.element), "method", "svoboda");
  f.run();
  const GstStructure* result = f.final_result();
  fail_unless(result != nullptr);
  fail_unless_equals_string(gst_structure_get_string(result, "unit"), "none");
  fail_unless(std::strstr(gst_structure_get_string(result, "remarks"), "have no unit") != nullptr);
  const auto rig = parse_rig(gst_structure_get_string(result, "json"));
  fail_unless(rig.has_value() && !rig->is_metric);
  fail_unless_equals_string(rig->cameras[0].calibration.model.c_str(), "pinhole");
}
GST_END_TEST;

// A wand gives the unit, and every place its error, by how well the wand is known.
GST_START_TEST(test_a_wand_gives_the_unit) {
  RigFixture f(rig_views::lit_room_of_wand(100), false);
  gst_element_set_state(f.element, GST_STATE_NULL);
  g_object_set(f.element, "wand-sigma", 0.0001, nullptr);
  f.run();
  const GstStructure* result = f.final_result();
  fail_unless(result != nullptr);
  fail_unless_equals_string(gst_structure_get_string(result, "unit"), "m");
  const auto rig = parse_rig(gst_structure_get_string(result, "json"));
  fail_unless(rig.has_value() && rig->is_metric && rig->cameras.size() == 4);
  fail_unless_equals_string(rig->world.c_str(), "cam0");
  fail_unless_equals_string(rig->cameras[0].calibration.board.c_str(), "wand:150mm+350mm");
  fail_unless(f.worst(*rig) < 4.5, "%f sigmas", f.worst(*rig));
  const auto warnings = f.bus.texts(GST_MESSAGE_WARNING);
  fail_unless(warnings.empty(), "%s", warnings[0].c_str());
}
GST_END_TEST;

// What is missing is said at the end.
GST_START_TEST(test_the_end_without_a_rig_says_what_is_missing) {
  struct Case {
    const char* property;
    const char* value;
    int instants;
    std::size_t cameras;
    const char* word;
  };
  constexpr Case kCases[] = {
      {"method", "auto", 200, 2, "link a third one"},
      {"method", "auto", 10, 4, "move it for a minute"},
      {"method", "boards", 50, 4, "has seen no board"},
      {"mode", "floor", 50, 4, "take mode=joint"},
  };
  const Case& c = kCases[__i__];
  auto cameras = rig_views::lit_room(c.instants);
  cameras.resize(c.cameras);
  RigFixture f(cameras, false);
  gst_util_set_object_arg(G_OBJECT(f.element), c.property, c.value);
  g_object_set(f.element, "location", (f.folder / "rig.json").c_str(), nullptr);
  f.run();
  const auto texts = f.bus.texts(GST_MESSAGE_ERROR);
  fail_unless_equals_int(texts.size(), 1);
  fail_unless(texts[0].find(c.word) != std::string::npos, "%s", texts[0].c_str());
  fail_unless(f.final_result() == nullptr);
}
GST_END_TEST;

// Settings that no solve takes are an error at the start.
GST_START_TEST(test_settings_of_no_use_are_refused) {
  const auto says = [](const char* property, const char* value, const char* word) {
    const auto texts = check::errors_at_start("calibrig", property, value);
    fail_unless_equals_int(texts.size(), 1);
    fail_unless(texts[0].find(word) != std::string::npos, "%s", texts[0].c_str());
  };
  says("places", "/nowhere/places.txt", "/nowhere/places.txt");
  says("model", "fisheye", "give the calibrations of cameras");
  says("fix", "k9", "'k9' cannot be fixed");
  fail_unless(check::errors_at_start("calibrig", "fix", "none").empty());
}
GST_END_TEST;

static Suite* calibrig_light_suite(void) {
  Suite* s = suite_create("calibrig_light");
  TCase* tc = tcase_create("general");
  suite_add_tcase(s, tc);
  tcase_set_timeout(tc, 280);
  tcase_add_loop_test(tc, test_a_light_tells_lenses_and_places, 0, 2);
  tcase_add_test(tc, test_without_places_there_is_no_unit);
  tcase_add_test(tc, test_a_wand_gives_the_unit);
  tcase_add_loop_test(tc, test_the_end_without_a_rig_says_what_is_missing, 0, 4);
  tcase_add_test(tc, test_settings_of_no_use_are_refused);
  return s;
}

GST_CHECK_MAIN(calibrig_light);
