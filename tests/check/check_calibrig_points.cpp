// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Manual points of cameras of a rig: by events, clicks, signals and files, in one world, in which
// the cameras are found.

#include <cmath>
#include <fstream>

#include "support.hpp"

#include <gst/check/gstcheck.h>
#include <gst/video/navigation.h>

#include "calvin/geometry/se3.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/io/rig_io.hpp"

using namespace calvin;

namespace {

// Two cameras before one checkerboard that lies still; calibrig in the mode floor.
struct PointsRig {
  PointsRig() {
    for (int c = 0; c < 2; ++c) {
      poses.push_back(scene.pose(c));
      pictures.push_back(scene.picture(c));
      truths.push_back(scene.truth(c));
    }
    camera = folder / "camera.json";
    fail_unless(write_calibration(camera, scene.camera.to_calibration()).has_value());
  }
  ~PointsRig() {
    if (bus) bus->detach();
    for (GstHarness* h : harnesses) gst_harness_teardown(h);
    if (element != nullptr) gst_object_unref(element);
  }
  // `points`: the property of each pad, or empty.
  void start(const std::vector<std::string>& points) {
    element = check::make_element("calibrig mode=floor");
    gst_object_ref_sink(element);
    bus.emplace(element);
    for (std::size_t c = 0; c < 2; ++c) {
      const std::string number = std::to_string(c);
      harnesses.push_back(gst_harness_new_with_element(element, ("sink_" + number).c_str(),
                                                       ("src_" + number).c_str()));
      // A harness starts its element, and settings are for the next start.
      gst_element_set_state(element, GST_STATE_NULL);
      const auto set = [&](const char* property, const std::string& value) {
        const std::string name = "sink_" + number + "::" + property;
        gst_child_proxy_set(GST_CHILD_PROXY(element), name.c_str(), value.c_str(), nullptr);
      };
      set("intrinsics", camera);
      if (!points.empty()) set("points", points[c]);
    }
    gst_element_set_state(element, GST_STATE_PLAYING);
    for (GstHarness* h : harnesses) {
      gst_harness_set_src_caps(h, check::caps_of("I420", scene.size));
    }
  }
  void frame(std::size_t c) {
    gst_buffer_unref(
        gst_harness_push_and_pull(harnesses[c], check::frame_of(pictures[c], "I420", frame_++)));
  }
  void click(std::size_t c, Pixel at, int button = 1) {
    gst_harness_push_upstream_event(
        harnesses[c], gst_event_new_navigation(gst_structure_new(
                          "application/x-gst-navigation", "event", G_TYPE_STRING,
                          "mouse-button-press", "button", G_TYPE_INT, button, "pointer_x",
                          G_TYPE_DOUBLE, at.u, "pointer_y", G_TYPE_DOUBLE, at.v, nullptr)));
  }
  Pixel beside(std::size_t c, std::size_t i) const {
    const double angle = 2.4 * static_cast<double>(i);
    const Pixel at = truths[c].uv[i];
    return {at.u + 1.5 * std::cos(angle), at.v + 1.5 * std::sin(angle)};
  }
  Eigen::Vector3d place(std::size_t c, std::size_t i) const {
    return scene.board.points()[static_cast<std::size_t>(truths[c].ids[i])];
  }
  const GstStructure* last() {
    const auto all = bus->named("calib-point");
    fail_unless(!all.empty(), "nothing was said of the point");
    return all.back();
  }
  // The final rig; every camera within these distances of where it is, m and rad.
  void ends_right(double place, double turn) {
    for (GstHarness* h : harnesses) gst_harness_push_event(h, gst_event_new_eos());
    const GstStructure* final = nullptr;
    for (const GstStructure* s : bus->named("calib-rig-result")) {
      if (g_strcmp0(gst_structure_get_string(s, "state"), "final") == 0) final = s;
    }
    fail_unless(final != nullptr, "no final rig");
    fail_unless_equals_string(gst_structure_get_string(final, "world"), "board");
    const Rig rig = parse_rig(gst_structure_get_string(final, "json")).value();
    fail_unless_equals_int(static_cast<int>(rig.cameras.size()), 2);
    for (std::size_t c = 0; c < 2; ++c) {
      const SE3 found = to_se3(rig.cameras[c].rig_from_camera);
      const SE3 truth = poses[c].inverse();
      const double away = (found.translation - truth.translation).norm();
      const double turned = (found.rotation - truth.rotation).norm();
      fail_unless(away < place && turned < turn, "camera %d: %g m, %g rad", static_cast<int>(c),
                  away, turned);
    }
  }

  check::Scene scene;
  check::TemporaryFolder folder;
  std::string camera;
  std::vector<SE3> poses;
  std::vector<GrayImage> pictures;
  std::vector<Observation> truths;
  GstElement* element = nullptr;
  std::optional<check::Bus> bus;
  std::vector<GstHarness*> harnesses;

 private:
  int frame_ = 0;
};

bool flag(const GstStructure* s, const char* field) {
  gboolean value = FALSE;
  fail_unless(gst_structure_get_boolean(s, field, &value));
  return value;
}

}  // namespace

// Each camera is clicked at other corners of one board; the event of the other's pad names it.
GST_START_TEST(test_events_and_signals_place_the_cameras) {
  PointsRig f;
  f.start({});
  f.frame(0);
  f.frame(1);
  const std::size_t corners[2][6] = {{0, 8, 45, 53, 22, 31}, {0, 8, 45, 53, 12, 40}};
  for (std::size_t c = 0; c < 2; ++c) {
    for (const std::size_t i : corners[c]) {
      const Pixel at = f.beside(c, i);
      const Eigen::Vector3d p = f.place(c, i);
      if (i == 8) {
        gboolean known = FALSE;
        g_signal_emit_by_name(f.element, "add-point", c == 0 ? "cam0" : "cam1", at.u, at.v, p.x(),
                              p.y(), p.z(), &known);
        fail_unless(known);
      } else {
        g_autofree char* text = g_strdup_printf(
            "calvin-point, uv=<%.9f, %.9f>, world=<%.9f, %.9f, "
            "%.9f>%s;",
            at.u, at.v, p.x(), p.y(), p.z(), i == 0 && c == 1 ? ", camera=(string)cam1" : "");
        GstEvent* event = gst_event_new_custom(GST_EVENT_CUSTOM_UPSTREAM,
                                               gst_structure_from_string(text, nullptr));
        fail_unless(gst_harness_push_upstream_event(f.harnesses[i == 0 ? 0 : c], event));
      }
      f.frame(c);
      fail_unless(flag(f.last(), "accepted") && flag(f.last(), "snapped"), "%s",
                  gst_structure_get_string(f.last(), "hint"));
      fail_unless_equals_string(gst_structure_get_string(f.last(), "camera"),
                                c == 0 ? "cam0" : "cam1");
      double u = 0;
      double v = 0;
      gst_structure_get(f.last(), "u", G_TYPE_DOUBLE, &u, "v", G_TYPE_DOUBLE, &v, nullptr);
      fail_unless(std::hypot(u - f.truths[c].uv[i].u, v - f.truths[c].uv[i].v) < 0.1);
    }
  }
  gboolean known = TRUE;
  g_signal_emit_by_name(f.element, "add-point", "cam7", 1.0, 1.0, 0.0, 0.0, 0.0, &known);
  fail_unless(!known && f.bus->says(GST_MESSAGE_WARNING, "No camera 'cam7'"));
  f.ends_right(0.002, 0.005);
}
GST_END_TEST;

// Clicks, in the order of the board of the pads.
GST_START_TEST(test_clicks_place_the_cameras) {
  PointsRig f;
  f.start({"checkerboard:9x6:25mm", "checkerboard:9x6:25mm"});
  for (std::size_t c = 0; c < 2; ++c) {
    f.frame(c);
    for (std::size_t i = 0; i < 20; ++i) {
      f.click(c, f.beside(c, i));
      f.frame(c);
      fail_unless(flag(f.last(), "accepted"));
    }
    int points = 0;
    f.click(c, {}, 3);
    gst_structure_get_int(f.last(), "points", &points);
    fail_unless_equals_int(points, 19);
    gboolean removed = FALSE;
    g_signal_emit_by_name(f.element, "remove-point", c == 0 ? "cam0" : "cam1", 0, &removed);
    fail_unless(removed);
    g_signal_emit_by_name(f.element, "remove-point", c == 0 ? "cam0" : "cam1", 30, &removed);
    fail_unless(!removed);
  }
  f.ends_right(0.003, 0.01);
}
GST_END_TEST;

// A file of points with their pixels for one camera, and a board that was found by the other.
GST_START_TEST(test_files_and_boards_that_were_found) {
  PointsRig f;
  std::vector<std::string> files;
  for (int c = 0; c < 2; ++c) {
    files.push_back(f.folder / (c == 0 ? "left.txt" : "right.txt"));
    std::ofstream file(files.back());
    file.precision(12);
    file << "# unit: m\nid X Y Z u v sigma\n";
    for (std::size_t i = 0; i < f.truths[c].ids.size(); i += 2) {
      const Eigen::Vector3d p = f.place(c, i);
      file << i << " " << p.x() << " " << p.y() << " " << p.z() << " " << f.truths[c].uv[i].u << " "
           << f.truths[c].uv[i].v << " 0.1\n";
    }
  }
  f.start(files);
  fail_unless_equals_int(static_cast<int>(f.bus->named("calib-point").size()), 2);
  f.frame(0);
  f.frame(1);
  f.ends_right(1e-5, 1e-4);

  PointsRig mixed;
  mixed.start({"", "checkerboard:9x6:25mm"});
  Observation seen = mixed.truths[0];
  seen.sigma.assign(seen.ids.size(), 0.1);
  seen.camera = "cam0";
  for (int n = 0; n < 3; ++n) {
    GstBuffer* buffer = check::frame_of(mixed.pictures[0], "I420", n);
    seen.timestamp = GST_BUFFER_PTS(buffer);
    gst::attach_observations(buffer, std::vector{seen});
    gst_buffer_unref(gst_harness_push_and_pull(mixed.harnesses[0], buffer));
  }
  for (std::size_t i = 0; i < 54; ++i) mixed.click(1, mixed.beside(1, i));
  mixed.frame(1);
  mixed.ends_right(0.002, 0.005);
}
GST_END_TEST;

GST_START_TEST(test_points_that_lack_are_told) {
  PointsRig f;
  f.start({"checkerboard:9x6:25mm", "checkerboard:9x6:25mm"});
  for (std::size_t c = 0; c < 2; ++c) {
    f.frame(c);
    for (std::size_t i = 0; i < (c == 0 ? 12 : 3); ++i) f.click(c, f.truths[c].uv[i]);
    f.frame(c);
  }
  for (GstHarness* h : f.harnesses) gst_harness_push_event(h, gst_event_new_eos());
  fail_unless(
      f.bus->says(GST_MESSAGE_WARNING, "The manual points of the camera 'cam1' are not enough"));
  GstElement* wrong = check::make_element("calibrig");
  GstPad* pad = gst_element_request_pad_simple(wrong, "sink_0");
  g_object_set(pad, "points", "/no/such/file", nullptr);
  gst_object_unref(pad);
  const auto errors = check::errors_at_start(wrong);
  fail_unless(!errors.empty() && errors.front().find("cam0") != std::string::npos);
}
GST_END_TEST;

static Suite* calibrig_points_suite() {
  Suite* suite = suite_create("calibrig_points");
  TCase* tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_set_timeout(tc, 60);
  tcase_add_checked_fixture(tc, gst::register_metas, nullptr);
  tcase_add_test(tc, test_events_and_signals_place_the_cameras);
  tcase_add_test(tc, test_clicks_place_the_cameras);
  tcase_add_test(tc, test_files_and_boards_that_were_found);
  tcase_add_test(tc, test_points_that_lack_are_told);
  return suite;
}

GST_CHECK_MAIN(calibrig_points)
