// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibundistort with a zoom table: pixels between 12 settings that were calibrated from noisy
// corners come from where the true lens sees them, to half a pixel; frames follow the position
// while they flow, and in a live stream none waits for it.

#include <cmath>
#include <set>
#include <string>
#include <thread>

#include <Eigen/LU>

#include "animate.hpp"
#include "calvin/geometry/se3.hpp"
#include "zoom_fixture.hpp"
#include "zoom_settings.hpp"

#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>

using namespace calvin;
using namespace calvin::check;
using scenes::ZoomLens;

// ---- Against the truth --------------------------------------------------------------------------

constexpr int kSubpixels = 50;  // steps of grey for each pixel, of 65536

// Pixels whose grey says in which column, or in which row, they are.
static GstBuffer* ramp(ImageSize size, bool rows, int n) {
  GstVideoInfo info;
  gst_video_info_set_format(&info, GST_VIDEO_FORMAT_GRAY16_LE, static_cast<guint>(size.width),
                            static_cast<guint>(size.height));
  GstBuffer* buffer = gst_buffer_new_allocate(nullptr, info.size, nullptr);
  GstMapInfo map;
  gst_buffer_map(buffer, &map, GST_MAP_WRITE);
  for (int y = 0; y < size.height; ++y) {
    auto* row = reinterpret_cast<guint16*>(map.data + y * info.stride[0]);
    for (int x = 0; x < size.width; ++x) {
      row[x] = GUINT16_TO_LE(static_cast<guint16>(kSubpixels * (rows ? y : x)));
    }
  }
  gst_buffer_unmap(buffer, &map);
  GST_BUFFER_PTS(buffer) = static_cast<guint64>(n) * 40 * GST_MSECOND;
  return buffer;
}

// Which column, or row, of the input each pixel of a grid of the output comes from.
static std::vector<double> places(GstBuffer* buffer, ImageSize size) {
  GstVideoInfo info;
  gst_video_info_set_format(&info, GST_VIDEO_FORMAT_GRAY16_LE, static_cast<guint>(size.width),
                            static_cast<guint>(size.height));
  GstMapInfo map;
  gst_buffer_map(buffer, &map, GST_MAP_READ);
  std::vector<double> all;
  for (int y = 0; y < size.height; y += 20) {
    const auto* row = reinterpret_cast<const guint16*>(map.data + y * info.stride[0]);
    for (int x = 0; x < size.width; x += 20) {
      all.push_back(static_cast<double>(GUINT16_FROM_LE(row[x])) / kSubpixels);
    }
  }
  gst_buffer_unmap(buffer, &map);
  return all;
}

struct Sighting {
  Eigen::Vector3d ray;  // of a pixel of the output
  Pixel from;           // where its grey came from
};

static Eigen::VectorXd misses(const std::vector<Sighting>& all, const Camera& truth,
                              const Eigen::Matrix3d& turn) {
  Eigen::VectorXd e(2 * static_cast<Eigen::Index>(all.size()));
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto at = truth.project(turn * all[i].ray);
    fail_unless(at.has_value());
    e[2 * static_cast<Eigen::Index>(i)] = at->u - all[i].from.u;
    e[2 * static_cast<Eigen::Index>(i) + 1] = at->v - all[i].from.v;
  }
  return e;
}

// px: how far the worst of them is from where the true lens sees its ray, after the best turn of
// the camera.
static double worst_miss(const std::vector<Sighting>& all, const Camera& truth) {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  for (int i = 0; i < 6; ++i) {
    const Eigen::VectorXd e = misses(all, truth, turn);
    Eigen::MatrixXd j(e.size(), 3);
    constexpr double kStep = 1e-6;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d w = kStep * Eigen::Vector3d::Unit(k);
      j.col(k) = (misses(all, truth, exp_so3(w) * turn) - e) / kStep;
    }
    const Eigen::Matrix3d normal = j.transpose() * j;
    turn = exp_so3(-(normal.inverse() * (j.transpose() * e))) * turn;
  }
  const Eigen::VectorXd e = misses(all, truth, turn);
  double worst = 0;
  for (Eigen::Index i = 0; i < e.size(); i += 2)
    worst = std::max(worst, std::hypot(e[i], e[i + 1]));
  return worst;
}

static std::vector<Sighting> sightings(Fixture& f, ImageSize size, int& n) {
  std::vector<double> of[2];
  for (const bool rows : {false, true}) {
    g_autoptr(GstBuffer) out = gst_harness_push_and_pull(f.h, ramp(size, rows, n++));
    of[rows ? 1 : 0] = places(out, size);
  }
  const Camera shown = Camera::make(parse_calibration(output_calibration(f)).value()).value();
  std::vector<Sighting> all;
  std::size_t i = 0;
  for (int y = 0; y < size.height; y += 20) {
    for (int x = 0; x < size.width; x += 20, ++i) {
      const auto ray = shown.unproject({static_cast<double>(x), static_cast<double>(y)});
      all.push_back({*ray, {of[0][i], of[1][i]}});
    }
  }
  return all;
}

GST_START_TEST(test_pixels_between_twelve_settings_are_within_half_a_pixel) {
  const ZoomLens& lens = scenes::kZoomLenses[static_cast<std::size_t>(__i__)];
  const std::vector<double> zooms = lens.settings(12);
  Fixture f("calibundistort");
  const ZoomTable table = scenes::twelve_settings(lens, static_cast<std::uint64_t>(21 + __i__));
  g_object_set(f.element, "calibration", text_of(table).c_str(), nullptr);
  f.set_caps("GRAY16_LE", lens.size);
  int n = 0;
  double worst = 0;
  for (std::size_t i = 0; i + 1 < zooms.size(); ++i) {
    const double zoom = (zooms[i] + zooms[i + 1]) / 2;
    g_object_set(f.element, "zoom-position", zoom, nullptr);
    worst = std::max(worst, worst_miss(sightings(f, lens.size, n), lens.at(zoom)));
  }
  g_print("%s: %.3f px\n", lens.name, worst);
  fail_unless(worst < 0.5, "%s: %f px", lens.name, worst);
  fail_unless(f.bus.texts(GST_MESSAGE_WARNING).empty());
}
GST_END_TEST;

// ---- While frames flow --------------------------------------------------------------------------

GST_START_TEST(test_each_frame_is_that_of_its_position) {
  const ZoomTable table = zoom_table();
  Fixture f("calibundistort");
  g_object_set(f.element, "calibration", text_of(table).c_str(), nullptr);
  f.set_caps("GRAY8", kSize);
  int n = 0;
  for (const double zoom : {100.0, 130.0, 400.0, 401.0, 222.5, 500.0}) {
    g_object_set(f.element, "zoom-position", zoom, nullptr);
    g_autoptr(GstBuffer) out = f.push(kSize, n++);
    fail_unless(gray_of(out, kSize) == gray_at(table, zoom), "zoom %f", zoom);
    const auto announced = Camera::make(parse_calibration(output_calibration(f)).value());
    fail_unless(announced->model() == "pinhole");
  }
  fail_unless_equals_int(events_out(f).size(), 6);
  fail_unless(f.bus.texts(GST_MESSAGE_WARNING).empty());
}
GST_END_TEST;

GST_START_TEST(test_a_controller_moves_it) {
  const ZoomTable table = zoom_table();
  Fixture f("calibundistort");
  g_object_set(f.element, "calibration", text_of(table).c_str(), nullptr);
  f.set_caps("GRAY8", kSize);
  GstControlSource* source = animate(f.element, "zoom-position", 120, 420);
  for (int n = 0; n < 25; n += 4) {
    g_autoptr(GstBuffer) out = f.push(kSize, n);
    fail_unless(gray_of(out, kSize) == gray_at(table, 120 + 300 * 0.04 * n), "frame %d", n);
  }
  gst_object_unref(source);
}
GST_END_TEST;

// Without a position there is none to undistort with; beyond the table its end counts, and that is
// said once.
GST_START_TEST(test_what_is_not_known_is_said_once) {
  const ZoomTable table = zoom_table();
  Fixture f("calibundistort");
  g_object_set(f.element, "calibration", text_of(table).c_str(), nullptr);
  f.set_caps("GRAY8", kSize);
  g_autoptr(GstBuffer) noise = Fixture::noise("GRAY8", kSize, 0);
  for (int n = 0; n < 3; ++n) {
    g_autoptr(GstBuffer) out = f.push(kSize, n);
    fail_unless(gray_of(out, kSize) == gray_of(noise, kSize));
  }
  fail_unless_equals_int(f.bus.texts(GST_MESSAGE_WARNING).size(), 1);
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "Set zoom-position"));
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "zoom 100 to 500"));
  for (const double zoom : {700.0, 300.0, 800.0, -4.0}) {
    g_object_set(f.element, "zoom-position", zoom, nullptr);
    g_autoptr(GstBuffer) out = f.push(kSize, 3);
    fail_unless(gray_of(out, kSize) == gray_at(table, std::clamp(zoom, 100.0, 500.0)));
  }
  fail_unless_equals_int(f.bus.texts(GST_MESSAGE_WARNING).size(), 2);
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "stands at 700"));
  // Of another table it is news.
  g_object_set(f.element, "calibration", text_of(table).c_str(), nullptr);
  gst_buffer_unref(f.push(kSize, 4));
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "stands at -4"));
}
GST_END_TEST;

GST_START_TEST(test_a_focus_is_asked_for_where_the_table_has_several) {
  std::vector<Calibration> settings;
  for (const ZoomSetting& setting : zoom_table().settings) {
    for (const double focus : {0.0, 1.0}) {
      settings.push_back(setting.calibration);
      settings.back().focus = focus;
      settings.back().parameters[0].value *= 1 + 0.05 * focus;
    }
  }
  const ZoomTable table = make_zoom_table(std::move(settings)).value();
  Fixture f("calibundistort zoom-position=250");
  g_object_set(f.element, "calibration", text_of(table).c_str(), nullptr);
  f.set_caps("GRAY8", kSize);
  gst_buffer_unref(f.push(kSize, 0));
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "focus-position"));
  g_object_set(f.element, "focus-position", 0.3, nullptr);
  g_autoptr(GstBuffer) out = f.push(kSize, 1);
  const Camera camera = Camera::make(interpolate(table, {250, 0.3})->calibration).value();
  fail_unless(gray_of(out, kSize) ==
              gray_through(Undistorter::make(camera, {}, {PlaneLayout{}}).value()));
}
GST_END_TEST;

GST_START_TEST(test_a_table_is_taken_from_a_file_that_is_replaced) {
  const TemporaryFolder folder;
  const std::string path = folder / "zoom.json";
  const ZoomTable table = zoom_table();
  fail_unless(write_calibration(path, table.settings.front().calibration).has_value());
  Fixture f(("calibundistort zoom-position=330 calibration=" + path).c_str());
  f.set_caps("GRAY8", kSize);
  g_autoptr(GstBuffer) first = f.push(kSize, 0);
  fail_unless(gray_of(first, kSize) == gray_at(table, 100));
  fail_unless(write_zoom_table(path, table).has_value());
  for (int n = 1;; ++n) {
    g_autoptr(GstBuffer) out = f.push(kSize, n);
    const auto picture = gray_of(out, kSize);
    if (picture == gray_at(table, 330)) break;
    fail_unless(picture == gray_at(table, 100));
    g_usleep(20000);
  }
  fail_unless(f.bus.texts(GST_MESSAGE_WARNING).empty());
}
GST_END_TEST;

GST_START_TEST(test_what_is_no_table_is_an_error_at_the_start) {
  std::string broken = text_of(zoom_table());
  broken.replace(broken.find("brown4"), 6, "brown5");
  const auto errors = errors_at_start("calibundistort", "calibration", broken.c_str());
  fail_unless_equals_int(errors.size(), 1);
  fail_unless(errors.front().find("zoom table") != std::string::npos);
}
GST_END_TEST;

// A map of a large picture takes longer than a frame may wait. While the zoom moves with every
// frame, each frame is that of some position before, and newer ones keep coming.
GST_START_TEST(test_a_live_stream_follows_a_zoom_that_never_rests) {
  constexpr ImageSize kLarge = {1920, 1440};
  const ZoomTable table = zoom_table(kLarge);
  Fixture f("calibundistort alpha=0.5 zoom-position=100", true);
  g_object_set(f.element, "calibration", text_of(table).c_str(), nullptr);
  f.set_caps("GRAY8", kLarge);
  std::set<std::string> shown;
  double focal = 0;
  for (int n = 0; shown.size() < 6; ++n) {
    fail_unless(n < 2000, "maps do not keep coming");
    const double zoom = 100 + 0.2 * n;
    g_object_set(f.element, "zoom-position", zoom, nullptr);
    gst_buffer_unref(f.push(kLarge, n));
    shown.insert(output_calibration(f));
    const Camera now = Camera::make(parse_calibration(output_calibration(f)).value()).value();
    fail_unless(now.fx() >= focal, "an older map took the place of a newer one");
    focal = now.fx();
  }
  // It rests: the last map is that of where it rests.
  g_object_set(f.element, "zoom-position", 450.0, nullptr);
  Fixture still("calibundistort alpha=0.5 zoom-position=450");
  g_object_set(still.element, "calibration", text_of(table).c_str(), nullptr);
  still.set_caps("GRAY8", kLarge);
  g_autoptr(GstBuffer) expected = still.push(kLarge, 0);
  for (int n = 2000;; ++n) {
    g_autoptr(GstBuffer) out = f.push(kLarge, n);
    if (gray_of(out, kLarge) == gray_of(expected, kLarge)) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}
GST_END_TEST;

static Suite* calibundistort_zoom_suite() {
  Suite* suite = suite_create("calibundistort_zoom");
  TCase* tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_loop_test(tc, test_pixels_between_twelve_settings_are_within_half_a_pixel, 0,
                      static_cast<int>(scenes::kZoomLenses.size()));
  tcase_add_test(tc, test_each_frame_is_that_of_its_position);
  tcase_add_test(tc, test_a_controller_moves_it);
  tcase_add_test(tc, test_what_is_not_known_is_said_once);
  tcase_add_test(tc, test_a_focus_is_asked_for_where_the_table_has_several);
  tcase_add_test(tc, test_a_table_is_taken_from_a_file_that_is_replaced);
  tcase_add_test(tc, test_what_is_no_table_is_an_error_at_the_start);
  tcase_add_test(tc, test_a_live_stream_follows_a_zoom_that_never_rests);
  return suite;
}

GST_CHECK_MAIN(calibundistort_zoom)
