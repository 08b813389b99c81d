// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibundistort in live streams: what changes shows as soon as its map is there, and no frame
// waits for one. Caps, calibration and view that change at the same time, from two threads, again
// and again (30 times; CALVIN_FULL=1: 1000): no frame is a mixture.

#include <atomic>
#include <chrono>
#include <map>
#include <thread>

#include "undistort_fixture.hpp"

#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>

using namespace calvin;
using namespace calvin::check;

GST_START_TEST(test_a_change_in_a_live_stream_shows_no_third_picture) {
  Fixture f("calibundistort", true);
  g_object_set(f.element, "calibration", kBarrel, nullptr);
  f.set_caps("GRAY8", kSize);
  const auto old_picture = expected_gray(kBarrel, kSize);
  const auto new_picture = expected_gray(kPincushion, kSize, 1);
  g_autoptr(GstBuffer) first = f.push(kSize, 0);
  fail_unless(gray_of(first, kSize) == old_picture);
  g_object_set(f.element, "calibration", kPincushion, "alpha", 1.0, nullptr);
  bool switched = false;
  for (int n = 1; n < 1000 && !switched; ++n) {
    g_autoptr(GstBuffer) out = f.push(kSize, n);
    const auto picture = gray_of(out, kSize);
    switched = picture == new_picture;
    fail_unless(switched || picture == old_picture);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  fail_unless(switched);
}
GST_END_TEST;

GST_START_TEST(test_a_live_stream_never_waits_but_for_its_first_frame) {
  Fixture f("calibundistort ! capsfilter caps=video/x-raw,width=320,height=240", true);
  const ImageSize half = {320, 240};
  f.set_caps("GRAY8", kSize);
  int n = 0;
  const auto come_to = [&](const std::vector<guint8>& picture, const std::vector<guint8>& before) {
    for (int i = 0; i < 2000; ++i) {
      g_autoptr(GstBuffer) out = f.push(kSize, n++);
      const auto shown = gray_of(out, half);
      if (shown == picture) return true;
      if (shown != before) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return false;
  };
  g_autoptr(GstBuffer) first = f.push(kSize, n++);
  const auto scaled = gray_of(first, half);
  const auto undistorted = expected_gray(kBarrel, kSize, 0, half);
  fail_if(scaled == undistorted);
  // Again and again, also while the worker is at the other one.
  for (int i = 0; i < 3; ++i) {
    g_object_set(f.element, "calibration", kBarrel, "enabled", TRUE, nullptr);
    fail_unless(come_to(undistorted, scaled));
    g_object_set(f.element, "enabled", FALSE, nullptr);
    fail_unless(come_to(scaled, undistorted));
    g_object_set(f.element, "enabled", TRUE, nullptr);
    gst_buffer_unref(f.push(kSize, n++));
    g_object_set(f.element, "enabled", FALSE, nullptr);
    gst_buffer_unref(f.push(kSize, n++));
    fail_unless(come_to(scaled, undistorted));
    g_object_set(f.element, "calibration", kPincushion, "enabled", TRUE, nullptr);
    fail_unless(come_to(expected_gray(kPincushion, kSize, 0, half), scaled));
    g_object_set(f.element, "enabled", FALSE, nullptr);
    fail_unless(come_to(scaled, expected_gray(kPincushion, kSize, 0, half)));
  }
}
GST_END_TEST;

static int rounds() { return std::getenv("CALVIN_FULL") != nullptr ? 1000 : 30; }

constexpr ImageSize kSizes[] = {{160, 120}, {96, 72}};
static const char* const kCameras[] = {
    "fx=120,fy=120,cx=81,cy=59,k1=-0.28,k2=0.09,width=160,height=120",
    "fx=120,fy=120,cx=81,cy=59,k1=0.1,k2=0,width=160,height=120"};
constexpr double kPans[] = {0, 9};  // degrees
constexpr double kAlphas[] = {0, 0.6};

// The settings as whoever changes them counts his steps: each sets one property.
struct Settings {
  int camera = 0;
  int pan = 0;
  int alpha = 0;

  [[nodiscard]] auto key() const { return std::tuple(camera, pan, alpha); }
};
static Settings after(int steps) {
  return {(steps + 2) / 3 % 2, (steps + 1) / 3 % 2, steps / 3 % 2};
}
static void take_step(GstElement* element, int to) {
  const Settings settings = after(to);
  switch (to % 3) {
    case 1:
      g_object_set(element, "calibration", kCameras[settings.camera], nullptr);
      break;
    case 2:
      g_object_set(element, "pan", kPans[settings.pan], nullptr);
      break;
    default:
      g_object_set(element, "alpha", kAlphas[settings.alpha], nullptr);
      break;
  }
}

// The picture of each setting at each size.
using Pictures = std::map<std::tuple<int, int, int>, std::vector<guint8>>;
static Pictures pictures_of(ImageSize size) {
  Pictures all;
  for (int i = 0; i < 6; ++i) {
    const Settings s = after(i);
    ViewOptions view;
    view.pan = kPans[s.pan] * G_PI / 180;
    view.alpha = kAlphas[s.alpha];
    const Camera camera = fit_to_frame(calibration_of(kCameras[s.camera]), size)->camera;
    const auto picture = gray_through(Undistorter::make(camera, view, {PlaneLayout{}}).value());
    for (const auto& [key, other] : all) fail_if(other == picture);
    all[s.key()] = picture;
  }
  fail_unless_equals_int(all.size(), 6);
  return all;
}

struct Race {
  explicit Race(bool is_live) : live(is_live), f("calibundistort", is_live) {
    for (const ImageSize size : kSizes) pictures.push_back(pictures_of(size));
    g_object_set(f.element, "calibration", kCameras[0], "n-threads", is_live ? 3 : 1, nullptr);
  }

  // One step after the other, as fast as the streaming thread takes frames.
  void change(const std::stop_token& stop) {
    for (int step = 1; !stop.stop_requested(); ++step) {
      begun = step;
      take_step(f.element, step);
      done = step;
      const int seen = frames;
      while (!stop.stop_requested() && frames < seen + step % 3) std::this_thread::yield();
    }
  }

  // A frame shows a setting that was in force while it was made; in a live stream it may also be
  // one from before, for which there is a map.
  void push(std::size_t size) {
    const int oldest = live ? 0 : done.load();
    g_autoptr(GstBuffer) out = f.push(kSizes[size], frames);
    const int newest = begun;
    const auto picture = gray_of(out, kSizes[size]);
    for (int step = newest; step >= std::max(oldest, newest - 5); --step) {
      if (picture == pictures[size].at(after(step).key())) {
        ++frames;
        if (step == newest) ++newest_shown;
        return;
      }
    }
    fail_unless(false, "frame %d of %dx%d, steps %d to %d", frames.load(), kSizes[size].width,
                kSizes[size].height, oldest, newest);
  }

  bool live;
  Fixture f;
  std::vector<Pictures> pictures;
  std::atomic<int> begun = 0;
  std::atomic<int> done = 0;
  std::atomic<int> frames = 0;
  int newest_shown = 0;
};

GST_START_TEST(test_no_frame_is_a_mixture) {
  Race race(__i__ == 1);
  {
    std::jthread other([&](const std::stop_token& stop) { race.change(stop); });
    // A busy machine may keep the other thread waiting: as many rounds as it takes for its steps.
    for (int round = 0; round < rounds() || race.done <= rounds(); ++round) {
      const auto size = static_cast<std::size_t>(round % 2);
      race.f.set_caps("GRAY8", kSizes[size]);
      for (int i = 0; i < 4; ++i) race.push(size);
    }
  }
  // What was set last is shown at last, by a worker or at once.
  const int last = race.done;
  const auto& want = race.pictures[1].at(after(last).key());
  race.f.set_caps("GRAY8", kSizes[1]);
  bool shown = false;
  for (int i = 0; i < 1000 && !shown; ++i) {
    g_autoptr(GstBuffer) out = race.f.push(kSizes[1], race.frames++);
    shown = gray_of(out, kSizes[1]) == want;
    fail_unless(shown || race.live);
    if (!shown) g_usleep(2000);
  }
  fail_unless(shown);
  fail_unless(race.live || race.newest_shown > rounds());
  fail_unless(race.f.bus.texts(GST_MESSAGE_ERROR).empty());
  // The smaller size is a scaled one, which is said once for each calibration and size.
  for (const std::string& warning : race.f.bus.texts(GST_MESSAGE_WARNING)) {
    fail_unless(warning.find("scaled") != std::string::npos, "%s", warning.c_str());
  }
}
GST_END_TEST;

static Suite* calibundistort_live_suite() {
  Suite* suite = suite_create("calibundistort_live");
  TCase* tc = tcase_create("general");
  tcase_set_timeout(tc, 600);
  tcase_add_test(tc, test_a_change_in_a_live_stream_shows_no_third_picture);
  tcase_add_test(tc, test_a_live_stream_never_waits_but_for_its_first_frame);
  tcase_add_loop_test(tc, test_no_frame_is_a_mixture, 0, 2);
  suite_add_tcase(suite, tc);
  return suite;
}

GST_CHECK_MAIN(calibundistort_live)
