// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibundistort: the properties of its view, animated ones too, and the way back.

#include <cmath>
#include <numbers>

#include "animate.hpp"
#include "undistort_fixture.hpp"

#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>

using namespace calvin;
using namespace calvin::check;

constexpr double kRadians = std::numbers::pi / 180;

// 190 degrees from the left to the right border.
static const char kVeryWide[] =
    "model=fisheye,fx=193,fy=193,cx=319.5,cy=239.5,k1=0,k2=0,k3=0,k4=0,width=640,height=480";

// ---- Each property ------------------------------------------------------------------------------

// What a property says in words, and the same to the library.
static const struct {
  const char* words;
  void (*change)(ViewOptions& view, Sampling& sampling);
} kWords[] = {
    {"alpha=0.5", [](ViewOptions& v, Sampling&) { v.alpha = 0.5; }},
    {"alpha-mode=opencv", [](ViewOptions& v, Sampling&) { v.alpha_mode = AlphaMode::kOpenCv; }},
    {"zoom=1.5", [](ViewOptions& v, Sampling&) { v.zoom = 1.5; }},
    {"pan=12", [](ViewOptions& v, Sampling&) { v.pan = 12 * kRadians; }},
    {"tilt=-7", [](ViewOptions& v, Sampling&) { v.tilt = -7 * kRadians; }},
    {"roll=30", [](ViewOptions& v, Sampling&) { v.roll = 30 * kRadians; }},
    {"projection=cylindrical",
     [](ViewOptions& v, Sampling&) { v.projection = Projection::kCylindrical; }},
    {"projection=equirectangular",
     [](ViewOptions& v, Sampling&) { v.projection = Projection::kEquirectangular; }},
    {"projection=stereographic",
     [](ViewOptions& v, Sampling&) { v.projection = Projection::kStereographic; }},
    {"projection=panini", [](ViewOptions& v, Sampling&) { v.projection = Projection::kPanini; }},
    {"projection=fisheye", [](ViewOptions& v, Sampling&) { v.projection = Projection::kFisheye; }},
    {"interpolation=nearest",
     [](ViewOptions&, Sampling& s) { s.interpolation = Interpolation::kNearest; }},
    {"interpolation=bicubic",
     [](ViewOptions&, Sampling& s) { s.interpolation = Interpolation::kBicubic; }},
    {"interpolation=lanczos",
     [](ViewOptions&, Sampling& s) { s.interpolation = Interpolation::kLanczos; }},
    {"pan=30 fill=replicate",
     [](ViewOptions& v, Sampling& s) { v.pan = 30 * kRadians, s.outside = Outside::kReplicate; }},
    {"pan=30 fill=mirror",
     [](ViewOptions& v, Sampling& s) { v.pan = 30 * kRadians, s.outside = Outside::kMirror; }},
};

static std::vector<guint8> expected_view(const ViewOptions& view, const Sampling& sampling = {}) {
  return gray_through(Undistorter::make(camera_of(kBarrel), view, {PlaneLayout{}}).value(),
                      sampling);
}

GST_START_TEST(test_a_property_says_what_the_library_shows) {
  const auto& [words, change] = kWords[__i__];
  Fixture f((std::string("calibundistort ") + words).c_str());
  g_object_set(f.element, "calibration", kBarrel, nullptr);
  f.set_caps("GRAY8", kSize);
  ViewOptions view;
  Sampling sampling;
  change(view, sampling);
  const auto want = expected_view(view, sampling);
  fail_if(want == expected_view({}));
  g_autoptr(GstBuffer) out = f.push(kSize);
  fail_unless(gray_of(out, kSize) == want, "%s", words);
  fail_unless(f.bus.texts(GST_MESSAGE_WARNING).empty());
}
GST_END_TEST;

// In sizes that leave no gap between rows.
GST_START_TEST(test_threads_share_the_rows) {
  for (const ImageSize size : {ImageSize{640, 480}, ImageSize{324, 8}, ImageSize{36, 6}}) {
    Fixture f("calibundistort");
    const Camera camera = camera_of(kBarrel).scaled(size);
    const std::string json = print_calibration(camera.to_calibration()).value();
    g_object_set(f.element, "calibration", json.c_str(), "pan", 10.0, nullptr);
    f.set_caps("NV12", size);
    g_autoptr(GstBuffer) one = gst_harness_push_and_pull(f.h, Fixture::noise("NV12", size, 0));
    GstMapInfo want;
    gst_buffer_map(one, &want, GST_MAP_READ);
    int n = 1;
    for (const int threads : {2, 7, 3, 1, 2}) {
      g_object_set(f.element, "n-threads", threads, nullptr);
      for (int i = 0; i < 3; ++i) {
        g_autoptr(GstBuffer) out =
            gst_harness_push_and_pull(f.h, Fixture::noise("NV12", size, n++));
        fail_unless(gst_buffer_memcmp(out, 0, want.data, want.size) == 0, "%d", threads);
      }
    }
    gst_buffer_unmap(one, &want);
  }
}
GST_END_TEST;

// ---- Animation ----------------------------------------------------------------------------------

constexpr struct {
  const char* name;
  double begin, end;
} kAnimated[] = {
    {"pan", -25, 25}, {"tilt", 8, -8}, {"roll", 0, 20}, {"zoom", 1, 1.6}, {"alpha", 0, 0.7}};

// Each frame is the one that an element makes whose properties stand still. `live`: also where a
// worker might make maps.
static void check_animation(std::span<const char* const> names, const char* camera = kBarrel,
                            bool live = false) {
  Fixture f("calibundistort", live);
  Fixture still("calibundistort");
  g_object_set(f.element, "calibration", camera, nullptr);
  g_object_set(still.element, "calibration", camera, nullptr);
  f.set_caps("GRAY8", kSize);
  still.set_caps("GRAY8", kSize);
  std::vector<GstControlSource*> sources;
  for (const auto& [name, begin, end] : kAnimated) {
    const bool wanted =
        std::find(names.begin(), names.end(), std::string_view(name)) != names.end();
    sources.push_back(wanted ? animate(f.element, name, begin, end) : nullptr);
  }
  std::vector<guint8> before;
  for (int n = 0; n < 25; ++n) {
    g_autoptr(GstBuffer) out = f.push(kSize, n);
    for (std::size_t i = 0; i < sources.size(); ++i) {
      double value = 0;
      if (sources[i] == nullptr) continue;
      fail_unless(gst_control_source_get_value(sources[i], GST_BUFFER_PTS(out), &value));
      g_object_set(still.element, kAnimated[i].name, value, nullptr);
    }
    g_autoptr(GstBuffer) want = still.push(kSize, n);
    auto picture = gray_of(out, kSize);
    fail_unless(picture == gray_of(want, kSize), "frame %d", n);
    fail_if(picture == before);
    before = std::move(picture);
  }
  for (GstControlSource* source : sources) gst_clear_object(&source);
}

GST_START_TEST(test_an_animated_view_is_exact_to_the_frame) {
  static const char* const kAll[] = {"pan", "tilt", "roll", "zoom", "alpha"};
  check_animation(kAll);
  for (const char* const& name : kAll) check_animation({&name, 1});
}
GST_END_TEST;

// Only maps that take longer than 2 ms are made beside a live stream; that of a usual lens does
// not, but where a sanitizer slows it down.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kMapsAreQuick = false;
#else
constexpr bool kMapsAreQuick = true;
#endif

GST_START_TEST(test_an_animated_view_is_exact_to_the_frame_in_a_live_stream) {
  static const char* const kPan[] = {"pan"};
  check_animation(
      kPan, "fx=480,fy=478,cx=325,cy=236,k1=-0.08,k2=0.01,p1=0,p2=0,width=640,height=480", true);
}
GST_END_TEST;

// A few frames; CALVIN_FULL=1: those of a second.
GST_START_TEST(test_4k_with_a_new_pan_at_every_frame) {
  const int frames = std::getenv("CALVIN_FULL") != nullptr ? 60 : 3;
  const ImageSize size = {3840, 2160};
  const std::string json =
      print_calibration(camera_of(kBarrel).scaled(size).to_calibration()).value();
  Fixture f("calibundistort");
  Fixture still("calibundistort");
  g_object_set(f.element, "calibration", json.c_str(), nullptr);
  g_object_set(still.element, "calibration", json.c_str(), nullptr);
  f.set_caps("NV12", size);
  still.set_caps("NV12", size);
  GstControlSource* pan = animate(f.element, "pan", -30, 30);
  for (int n = 0; n < frames; ++n) {
    g_autoptr(GstBuffer) out = gst_harness_push_and_pull(f.h, Fixture::noise("NV12", size, n % 25));
    double value = 0;
    fail_unless(gst_control_source_get_value(pan, GST_BUFFER_PTS(out), &value));
    g_object_set(still.element, "pan", value, nullptr);
    g_autoptr(GstBuffer) want =
        gst_harness_push_and_pull(still.h, Fixture::noise("NV12", size, n % 25));
    GstMapInfo map;
    gst_buffer_map(want, &map, GST_MAP_READ);
    fail_unless(gst_buffer_memcmp(out, 0, map.data, map.size) == 0, "frame %d", n);
    gst_buffer_unmap(want, &map);
  }
  fail_unless_equals_int(gst_harness_buffers_received(f.h), frames);
  gst_object_unref(pan);
}
GST_END_TEST;

GST_START_TEST(test_a_camera_that_turns_is_announced_once) {
  Fixture f("calibundistort");
  g_object_set(f.element, "calibration", kBarrel, nullptr);
  f.set_caps("GRAY8", kSize);
  GstControlSource* pan = animate(f.element, "pan", -25, 25);
  for (int n = 0; n < 5; ++n) gst_buffer_unref(f.push(kSize, n));
  fail_unless_equals_int(events_out(f).size(), 1);
  GstControlSource* zoom = animate(f.element, "zoom", 1, 2);
  for (int n = 5; n < 10; ++n) gst_buffer_unref(f.push(kSize, n));
  const auto events = events_out(f);
  fail_unless_equals_int(events.size(), 5);
  fail_unless(parse_calibration(events[4].json)->find("fx")->value >
              parse_calibration(events[0].json)->find("fx")->value);
  gst_object_unref(pan);
  gst_object_unref(zoom);
}
GST_END_TEST;

// ---- What no projection shows -------------------------------------------------------------------

GST_START_TEST(test_an_impossible_view_is_limited_with_a_warning) {
  Fixture f("calibundistort alpha=1");
  g_object_set(f.element, "calibration", kVeryWide, nullptr);
  f.set_caps("GRAY8", kSize);
  const auto field = [&] {
    const Camera view = Camera::make(parse_calibration(output_calibration(f)).value()).value();
    return (std::atan(view.cx() / view.fx()) + std::atan((639 - view.cx()) / view.fx())) / kRadians;
  };
  for (int n = 0; n < 3; ++n) gst_buffer_unref(f.push(kSize, n));
  fail_unless_equals_int(f.bus.texts(GST_MESSAGE_WARNING).size(), 1);
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "limited"));
  fail_unless(std::abs(field() - 150) < 1e-3, "%f", field());
  // A view that there is.
  g_object_set(f.element, "projection", 5, nullptr);
  gst_buffer_unref(f.push(kSize, 3));
  g_object_set(f.element, "projection", 0, "alpha", 0.5, nullptr);
  gst_buffer_unref(f.push(kSize, 4));
  fail_unless(field() < 149);
  fail_unless_equals_int(f.bus.texts(GST_MESSAGE_WARNING).size(), 1);
  // By the zoom.
  g_object_set(f.element, "zoom", 0.1, nullptr);
  gst_buffer_unref(f.push(kSize, 5));
  fail_unless_equals_int(f.bus.texts(GST_MESSAGE_WARNING).size(), 2);
  fail_unless(field() < 150.001);
}
GST_END_TEST;

GST_START_TEST(test_a_view_to_the_back_is_black_and_no_error) {
  Fixture f("calibundistort pan=180");
  g_object_set(f.element, "calibration", kBarrel, nullptr);
  f.set_caps("GRAY8", kSize);
  g_autoptr(GstBuffer) out = f.push(kSize);
  const auto picture = gray_of(out, kSize);
  // GRAY8 has the full range.
  fail_unless(std::all_of(picture.begin(), picture.end(), [](guint8 p) { return p == 0; }));
}
GST_END_TEST;

// ---- The way back -------------------------------------------------------------------------------

// Waves that are as good as linear between two pixels.
static double wave(double x, double y) {
  return 128 + 60 * std::sin(x / 25) + 60 * std::cos(y / 30);
}

GST_START_TEST(test_what_was_undistorted_is_distorted_back) {
  Fixture f(
      "calibundistort name=there alpha=1 ! capsfilter caps=video/x-raw,width=900,height=700 ! "
      "calibundistort name=back direction=distort alpha=1 ! capsfilter "
      "caps=video/x-raw,width=640,height=480");
  for (const char* name : {"there", "back"}) {
    GstElement* element = gst_bin_get_by_name(GST_BIN(f.h->element), name);
    g_object_set(element, "calibration", kBarrel, nullptr);
    gst_object_unref(element);
  }
  f.set_caps("GRAY8", kSize);
  GrayImage image(kSize.width, kSize.height);
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      image.row(y)[x] = static_cast<guint8>(std::lround(wave(x, y)));
    }
  }
  g_autoptr(GstBuffer) out = gst_harness_push_and_pull(f.h, frame_of(image, "GRAY8", 0));
  const auto picture = gray_of(out, kSize);
  int compared = 0;
  for (int y = 4; y < kSize.height - 4; ++y) {
    for (int x = 4; x < kSize.width - 4; ++x, ++compared) {
      // Two roundings, and what two interpolations take off the curvature: 1/8 (1/25)^2 60 each.
      const double got = picture[static_cast<std::size_t>(y * kSize.width + x)];
      fail_unless(std::abs(got - wave(x, y)) < 1.8, "%d, %d: %f, not %f", x, y, got, wave(x, y));
    }
  }
  fail_unless_equals_int(compared, 632 * 472);
}
GST_END_TEST;

// A pinhole picture of straight lines becomes what the formulae of the lens say.
GST_START_TEST(test_the_way_back_is_the_lens_itself) {
  Fixture f("calibundistort direction=distort alpha=1");
  g_object_set(f.element, "calibration", kBarrel, nullptr);
  f.set_caps("GRAY8", kSize);
  GrayImage image(kSize.width, kSize.height);
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      image.row(y)[x] = static_cast<guint8>(std::lround(0.3 * x + 0.1 * y));
    }
  }
  g_autoptr(GstBuffer) out = gst_harness_push_and_pull(f.h, frame_of(image, "GRAY8", 0));
  const auto picture = gray_of(out, kSize);
  // The frames that come out are the camera's: that is what is announced.
  const Calibration told = parse_calibration(output_calibration(f)).value();
  fail_unless(Camera::make(told)->parameters() == camera_of(kBarrel).parameters());
  ViewOptions all;
  all.alpha = 1;
  const Camera view = output_camera(camera_of(kBarrel), all).value();
  int compared = 0;
  for (double y = -0.45; y < 0.5; y += 0.05) {
    for (double x = -0.6; x < 0.7; x += 0.05) {
      const double r2 = x * x + y * y;
      const double g = 1 - 0.28 * r2 + 0.09 * r2 * r2;
      const double u = 480 * (x * g + 2 * 0.0005 * x * y - 0.0007 * (r2 + 2 * x * x)) + 325;
      const double v = 478 * (y * g + 0.0005 * (r2 + 2 * y * y) - 2 * 0.0007 * x * y) + 236;
      const int i = static_cast<int>(std::lround(u));
      const int j = static_cast<int>(std::lround(v));
      if (i < 4 || j < 4 || i > 635 || j > 475) continue;
      // The lens shrinks what the view shows by its own slope: at most by 2 near the corners.
      const double want = 0.3 * (view.fx() * x + view.cx()) + 0.1 * (view.fy() * y + view.cy());
      const double got = picture[static_cast<std::size_t>(j * kSize.width + i)];
      fail_unless(std::abs(got - want) < 1.01 + 2 * 0.5 * (0.3 + 0.1), "%f, %f", x, y);
      ++compared;
    }
  }
  fail_unless(compared > 400);
}
GST_END_TEST;

static Suite* calibundistort_views_suite() {
  Suite* suite = suite_create("calibundistort_views");
  TCase* tc = tcase_create("general");
  tcase_add_loop_test(tc, test_a_property_says_what_the_library_shows, 0,
                      static_cast<int>(std::size(kWords)));
  tcase_add_test(tc, test_threads_share_the_rows);
  tcase_add_test(tc, test_an_animated_view_is_exact_to_the_frame);
  if (kMapsAreQuick) {
    tcase_add_test(tc, test_an_animated_view_is_exact_to_the_frame_in_a_live_stream);
  }
  tcase_add_test(tc, test_4k_with_a_new_pan_at_every_frame);
  tcase_add_test(tc, test_a_camera_that_turns_is_announced_once);
  tcase_add_test(tc, test_an_impossible_view_is_limited_with_a_warning);
  tcase_add_test(tc, test_a_view_to_the_back_is_black_and_no_error);
  tcase_add_test(tc, test_what_was_undistorted_is_distorted_back);
  tcase_add_test(tc, test_the_way_back_is_the_lens_itself);
  suite_add_tcase(suite, tc);
  return suite;
}

GST_CHECK_MAIN(calibundistort_views)
