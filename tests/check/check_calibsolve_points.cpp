// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Manual points through calibsolve and calibrate: clicks, events and signals, snapped to the
// rendered corner, and what is solved of them.

#include "solve_fixture.hpp"

#include <cmath>
#include <fstream>

#include <gst/check/gstcheck.h>
#include <gst/video/navigation.h>

#include "calvin/geometry/se3.hpp"
#include "calvin/io/calibration_io.hpp"

using namespace calvin;

namespace {

// As a sink sends it upstream.
GstEvent* click(Pixel at, int button = 1) {
  return gst_event_new_navigation(
      gst_structure_new("application/x-gst-navigation", "event", G_TYPE_STRING,
                        "mouse-button-press", "button", G_TYPE_INT, button, "pointer_x",
                        G_TYPE_DOUBLE, at.u, "pointer_y", G_TYPE_DOUBLE, at.v, nullptr));
}

GstEvent* backspace() {
  return gst_event_new_navigation(gst_structure_new("application/x-gst-navigation", "event",
                                                    G_TYPE_STRING, "key-press", "key",
                                                    G_TYPE_STRING, "BackSpace", nullptr));
}

GstEvent* point(const std::vector<double>& uv, const std::vector<double>& world,
                bool is_whole = false) {
  const char* type = is_whole ? "int" : "double";
  std::string text = "calvin-point";
  const auto add = [&](const char* field, const std::vector<double>& values) {
    if (values.empty()) return;
    std::string list;
    for (const double value : values) {
      list += std::string(list.empty() ? "" : ", ") + "(" + type + ")" +
              (is_whole ? std::to_string(std::lround(value)) : std::to_string(value));
    }
    text += std::string(", ") + field + "=<" + list + ">";
  };
  add("uv", uv);
  add("world", world);
  GstStructure* s = gst_structure_from_string((text + ";").c_str(), nullptr);
  fail_unless(s != nullptr, "%s", text.c_str());
  return gst_event_new_custom(GST_EVENT_CUSTOM_UPSTREAM, s);
}

// A rendered checkerboard before a camera that is known, which nobody looks for.
struct PointsFixture {
  explicit PointsFixture(const std::string& properties, const char* format = "GRAY8",
                         const char* factory = "calibsolve", bool is_known = true)
      : format_(format) {
    const std::string camera = folder / "camera.json";
    fail_unless(write_calibration(camera, scene.camera.to_calibration()).has_value());
    const std::string known = is_known ? " fix=all initial=" + camera : "";
    element = check::make_element(factory + known + " " + properties);
    bus.emplace(element);
    h = check::harness_of(element);
    gst_harness_set_src_caps(h, check::caps_of(format, scene.size));
  }
  ~PointsFixture() {
    bus->detach();
    gst_harness_teardown(h);
  }
  void send(GstEvent* event) { fail_unless(gst_harness_push_upstream_event(h, event)); }
  void frame() {
    gst_buffer_unref(gst_harness_push_and_pull(h, check::frame_of(picture, format_, frame_++)));
  }
  const GstStructure* last() {
    const auto all = bus->named("calib-point");
    fail_unless(!all.empty(), "nothing was said of the point");
    return all.back();
  }
  // The final result.
  Calibration solved() {
    gst_harness_push_event(h, gst_event_new_eos());
    for (const GstStructure* s : bus->named("calib-result")) {
      if (g_strcmp0(gst_structure_get_string(s, "state"), "final") != 0) continue;
      return parse_calibration(gst_structure_get_string(s, "json")).value();
    }
    for (const std::string& text : bus->texts(GST_MESSAGE_WARNING))
      g_printerr("%s\n", text.c_str());
    fail("no final result");
    return {};
  }

  check::Scene scene;
  GrayImage picture = scene.picture(1);
  check::TemporaryFolder folder;
  GstElement* element = nullptr;
  std::optional<check::Bus> bus;
  GstHarness* h = nullptr;

 private:
  const char* format_;
  int frame_ = 0;
};

bool flag(const GstStructure* s, const char* field) {
  gboolean value = FALSE;
  fail_unless(gst_structure_get_boolean(s, field, &value));
  return value;
}

int number(const GstStructure* s, const char* field) {
  int value = -1;
  fail_unless(gst_structure_get_int(s, field, &value));
  return value;
}

void near_pose(const Calibration& found, const SE3& truth, double translation, double rotation) {
  fail_unless_equals_int(static_cast<int>(found.views.size()), 1);
  const SE3 pose = to_se3(found.views.front().camera_from_board);
  const double moved = (pose.translation - truth.translation).norm();
  const double turned = (pose.rotation - truth.rotation).norm();
  fail_unless(moved < translation && turned < rotation, "%g m, %g rad off", moved, turned);
}

}  // namespace

// Corners and dots are clicked 1 to 2 px beside, in the order of the board, in pictures of several
// formats.
GST_START_TEST(test_clicks_are_snapped) {
  using Case = std::pair<const char*, std::string>;
  const std::string squares = "checkerboard:9x6:25mm";
  for (const auto& [format, board] :
       {Case{"GRAY8", squares}, Case{"YUY2", squares}, Case{"RGB", squares}, Case{"I420", squares},
        Case{"NV12", "circles:7x5:30mm"}}) {
    // Of a camera that nobody knows: or the others were found after the first four.
    PointsFixture f("points=" + board, format, "calibsolve", false);
    f.scene.board = parse_board(board).value();
    f.picture = f.scene.picture(1);
    const Observation truth = f.scene.truth(1);
    f.frame();
    for (std::size_t i = 0; i < truth.ids.size(); ++i) {
      const double angle = 2.4 * static_cast<double>(i);
      const double off = 1 + static_cast<double>(i % 5) / 4;
      const Pixel at = truth.uv[i];
      f.send(click({at.u + off * std::cos(angle), at.v + off * std::sin(angle)}));
      f.frame();
      const GstStructure* s = f.last();
      fail_unless(flag(s, "accepted") && flag(s, "snapped"), "%s",
                  gst_structure_get_string(s, "hint"));
      fail_unless_equals_int(number(s, "id"), truth.ids[i]);
      const double distance = std::hypot(check::get(s, "u") - at.u, check::get(s, "v") - at.v);
      // The middle of what is seen of a disc is not quite its centre.
      const bool is_disc = board != squares;
      fail_unless(distance < (is_disc ? 0.2 : 0.1), "%s: %g px off", format, distance);
      fail_unless(check::get(s, "sigma") < (is_disc ? 0.2 : 0.1));
    }
    fail_unless_equals_int(number(f.last(), "points"), static_cast<int>(truth.ids.size()));
    fail_unless(f.bus->named("calib-result").empty(), "one plane alone is no camera");
  }
}
GST_END_TEST;

// Pairs of a pixel and a place, by event and by signal; away from corners as they were clicked.
GST_START_TEST(test_events_and_signals_bring_their_places) {
  PointsFixture f("");
  const Observation truth = f.scene.truth(1);
  const std::vector<Eigen::Vector3d> places = f.scene.board.points();
  const auto place = [&](std::size_t i) {
    const Eigen::Vector3d p = places[static_cast<std::size_t>(truth.ids[i])];
    return std::vector{p.x(), p.y(), p.z()};
  };
  f.frame();
  f.send(point({truth.uv[0].u + 1, truth.uv[0].v}, place(0)));
  g_signal_emit_by_name(f.element, "add-point", truth.uv[8].u, truth.uv[8].v - 1.5, place(8)[0],
                        place(8)[1], place(8)[2]);
  fail_unless(f.bus->named("calib-point").empty(), "they wait for a frame");
  f.frame();
  fail_unless_equals_int(static_cast<int>(f.bus->named("calib-point").size()), 2);
  fail_unless(flag(f.last(), "snapped"));
  fail_unless_equals_float(check::get(f.last(), "x"), 0.2);

  f.send(point({3, 4}, {5, 0, 1}, true));
  f.frame();
  fail_unless(flag(f.last(), "accepted") && !flag(f.last(), "snapped"));
  fail_unless_equals_float(check::get(f.last(), "u"), 3);
  fail_unless_equals_float(check::get(f.last(), "sigma"), 1);
  gboolean removed = FALSE;
  g_signal_emit_by_name(f.element, "remove-point", 2, &removed);
  fail_unless(removed);
  g_signal_emit_by_name(f.element, "remove-point", 2, &removed);
  fail_unless(!removed);

  const auto refused = [&](GstEvent* event, const char* reason) {
    f.send(event);
    f.frame();
    fail_unless(!flag(f.last(), "accepted"));
    fail_unless_equals_string(gst_structure_get_string(f.last(), "reason"), reason);
    fail_unless(gst_structure_has_field(f.last(), "hint"));
  };
  refused(point({700, 10}, place(1)), "outside");
  refused(point({}, place(1)), "outside");
  refused(point({10}, place(1)), "outside");
  refused(point({10, 10}, {}), "no-place");
  refused(point({10, 10}, {1, 2}), "no-place");
  refused(point({truth.uv[0].u, truth.uv[0].v}, place(1)), "twice");
  // Measured: as it is.
  GstEvent* measured = point({truth.uv[45].u + 0.4, truth.uv[45].v}, place(45));
  gst_structure_set(gst_event_writable_structure(measured), "sigma", G_TYPE_DOUBLE, 0.5, nullptr);
  f.send(measured);
  f.frame();
  fail_unless(flag(f.last(), "accepted") && !flag(f.last(), "snapped"));
  fail_unless(std::abs(check::get(f.last(), "u") - truth.uv[45].u - 0.4) < 1e-5);
  f.send(point({truth.uv[53].u, truth.uv[53].v}, place(53)));
  f.frame();
  fail_unless_equals_int(number(f.last(), "points"), 4);
  near_pose(f.solved(), f.scene.pose(1), 0.005, 0.03);
}
GST_END_TEST;

// Points of a file in space, at once with their pixels.
GST_START_TEST(test_points_of_a_file) {
  PointsFixture f("");
  const SE3 pose = {exp_so3({0.4, -0.5, 0.1}), {-0.1, -0.05, 0.9}};
  const std::string path = f.folder / "cube.txt";
  {
    std::ofstream file(path);
    file << "# unit: mm\nX Y Z u v\n";
    for (int i = 0; i < 8; ++i) {
      const Eigen::Vector3d p(i % 2 * 0.2, i / 2 % 2 * 0.2, i / 4 * 0.2);
      const Pixel at = f.scene.camera.project(pose * p).value();
      file << 1000 * p.x() << " " << 1000 * p.y() << " " << 1000 * p.z() << " " << at.u << " "
           << at.v << "\n";
    }
  }
  f.frame();
  g_object_set(f.element, "points", path.c_str(), nullptr);
  for (int i = 0; i < 500 && f.bus->named("calib-point").empty(); ++i) {
    f.frame();
    g_usleep(10000);
  }
  fail_unless_equals_int(number(f.last(), "points"), 8);
  near_pose(f.solved(), pose, 0.001, 0.002);
}
GST_END_TEST;

// Four clicks before a known camera, and the others are found where it has them, a few in each
// frame; what was taken out stays out.
GST_START_TEST(test_the_rest_of_a_file_is_found) {
  const check::TemporaryFolder folder;
  const std::string path = folder / "plate.txt";
  {
    std::ofstream file(path);
    file << "# unit: m\nid X Y Z\n";
    const auto points = parse_board(kDefaultBoard)->points();
    // The four that are clicked come first.
    for (const int i : {0, 8, 45, 53}) {
      file << (i == 0    ? 0
               : i == 8  ? 1
               : i == 45 ? 2
                         : 3)
           << " " << points[i].x() << " " << points[i].y() << " 0\n";
    }
    for (int i = 1; i < 53; ++i) {
      if (i != 8 && i != 45)
        file << 10 + i << " " << points[i].x() << " " << points[i].y() << " 0\n";
    }
  }
  PointsFixture f("mode=sync board=points:" + path, "NV12", "calibrate");
  const Observation truth = f.scene.truth(1);
  f.frame();
  for (const std::size_t i : {0U, 8U, 45U, 53U}) {
    f.send(click({truth.uv[i].u + 1, truth.uv[i].v - 1}));
    f.frame();
  }
  for (int n = 0; n < 8; ++n) f.frame();
  fail_unless_equals_int(number(f.last(), "points"), 54);
  gboolean removed = FALSE;
  g_signal_emit_by_name(f.element, "remove-point", 20, &removed);
  fail_unless(removed);
  for (int n = 0; n < 3; ++n) f.frame();
  fail_unless_equals_int(number(f.last(), "points"), 53);
  near_pose(f.solved(), f.scene.pose(1), 0.0003, 0.001);
}
GST_END_TEST;

// Keys and buttons: BackSpace and the right button take the newest point out, then views.
GST_START_TEST(test_a_wrong_click_is_taken_back) {
  PointsFixture f("points=checkerboard:9x6:25mm");
  const Observation truth = f.scene.truth(1);
  f.frame();
  f.send(click(truth.uv[0]));
  f.frame();
  f.send(click(truth.uv[7]));
  f.frame();
  fail_unless_equals_int(number(f.last(), "id"), 1);
  f.send(backspace());
  fail_unless_equals_int(number(f.last(), "points"), 1);
  f.send(click(truth.uv[1]));
  f.frame();
  fail_unless_equals_int(number(f.last(), "id"), 1);
  f.send(click({0, 0}, 3));
  f.send(click({0, 0}, 3));
  fail_unless_equals_int(number(f.last(), "points"), 0);
  const std::size_t said = f.bus->named("calib-point").size();
  f.send(click({0, 0}, 3));
  f.send(backspace());
  fail_unless_equals_int(static_cast<int>(f.bus->named("calib-point").size()),
                         static_cast<int>(said));
  // One that has not met a frame yet.
  f.send(click(truth.uv[1]));
  f.send(backspace());
  f.frame();
  fail_unless_equals_int(static_cast<int>(f.bus->named("calib-point").size()),
                         static_cast<int>(said));
}
GST_END_TEST;

// A sink behind calibrate; its detector does not find the board that is clicked.
GST_START_TEST(test_calibrate_forwards_them) {
  PointsFixture f("mode=sync board=checkerboard:7x5:10mm points=checkerboard:9x6:25mm", "I420",
                  "calibrate");
  const Observation truth = f.scene.truth(1);
  f.frame();
  for (const std::size_t i : {0U, 1U, 2U}) {
    f.send(click({truth.uv[i].u + 1, truth.uv[i].v + 1}));
    f.frame();
  }
  gboolean removed = FALSE;
  g_signal_emit_by_name(f.element, "remove-point", 0, &removed);
  fail_unless(removed);
  const Eigen::Vector3d p = f.scene.board.points()[0];
  g_signal_emit_by_name(f.element, "add-point", truth.uv[0].u, truth.uv[0].v, p.x(), p.y(), p.z());
  for (const std::size_t i : {30U, 20U}) {
    const Eigen::Vector3d place = f.scene.board.points()[i];
    f.send(point({truth.uv[i].u, truth.uv[i].v}, {place.x(), place.y(), 0}));
    f.frame();
  }
  near_pose(f.solved(), f.scene.pose(1), 0.01, 0.05);
}
GST_END_TEST;

GST_START_TEST(test_wrong_points_are_told_at_the_start) {
  for (const char* wrong : {"/no/such/file.txt", "dot", "checkerboard:2:3"}) {
    const auto errors = check::errors_at_start("calibsolve", "points", wrong);
    fail_unless(!errors.empty() && errors.front().find("cannot be used") != std::string::npos, "%s",
                wrong);
  }
  fail_unless(!check::errors_at_start("calibsolve", "fix", "all").empty(), "of no camera");
}
GST_END_TEST;

static Suite* calibsolve_points_suite() {
  Suite* suite = suite_create("calibsolve_points");
  TCase* tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_set_timeout(tc, 60);
  tcase_add_checked_fixture(tc, gst::register_metas, nullptr);
  tcase_add_test(tc, test_clicks_are_snapped);
  tcase_add_test(tc, test_events_and_signals_bring_their_places);
  tcase_add_test(tc, test_points_of_a_file);
  tcase_add_test(tc, test_the_rest_of_a_file_is_found);
  tcase_add_test(tc, test_a_wrong_click_is_taken_back);
  tcase_add_test(tc, test_calibrate_forwards_them);
  tcase_add_test(tc, test_wrong_points_are_told_at_the_start);
  return suite;
}

GST_CHECK_MAIN(calibsolve_points)
