// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Four cameras that run as real ones do through calibdetect and calibrig: clocks that jitter and
// drift, frames that are lost, one camera that stops and starts again, and one that is pushed.

#include <cstring>
#include <iostream>
#include <string>
#include <vector>

#include "calvin/io/calibration_io.hpp"
#include "calvin/io/rig_io.hpp"
#include "emulated_cameras.hpp"
#include "support.hpp"

#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>

using namespace calvin;

namespace {

constexpr GstClockTime kTolerance = 10 * GST_MSECOND;
constexpr std::size_t kStopped = 3;
constexpr std::size_t kBumped = 2;
constexpr double kBump = 6;      // s
constexpr double kReinsert = 9;  // s

emulated::Settings as_they_run() {
  emulated::Settings settings;
  settings.stopped = kStopped;
  settings.stops = 3;
  settings.starts = 4.5;
  settings.bumped = kBumped;
  settings.bump = kBump;
  return settings;
}

// A detector before each pad of a rig.
struct Studio {
  explicit Studio(const emulated::Settings& settings)
      : cameras(emulated::render(settings)), rig(check::make_element("calibrig")), bus(rig) {
    gst_object_ref_sink(rig);
    for (std::size_t c = 0; c < cameras.calibrations.size(); ++c) {
      const std::string number = std::to_string(c);
      pads.push_back(
          gst_harness_new_with_element(rig, ("sink_" + number).c_str(), ("src_" + number).c_str()));
      // A harness starts its element, and settings are for the next start.
      gst_element_set_state(rig, GST_STATE_NULL);
      detectors.push_back(check::harness_of(check::make_element("calibdetect mode=sync")));
      const std::string file = folder / ("cam" + number + ".json").c_str();
      (void)write_calibration(file, cameras.calibrations[c]);
      gst_child_proxy_set(GST_CHILD_PROXY(rig), ("sink_" + number + "::intrinsics").c_str(),
                          file.c_str(), nullptr);
    }
    gst_element_set_state(rig, GST_STATE_NULL);
    g_object_set(rig, "location", (folder / "rig.json").c_str(), "tolerance", kTolerance, nullptr);
    gst_element_set_state(rig, GST_STATE_PLAYING);
    for (std::size_t c = 0; c < pads.size(); ++c) {
      gst_harness_set_src_caps(pads[c], check::caps_of("GRAY8", settings.size));
      gst_harness_set_src_caps(detectors[c], check::caps_of("GRAY8", settings.size));
    }
  }
  ~Studio() {
    bus.detach();
    for (GstHarness* h : pads) gst_harness_teardown(h);
    for (GstHarness* h : detectors) gst_harness_teardown(h);
    gst_object_unref(rig);
  }

  // Whether the same frame came out.
  bool push(const emulated::Frame& frame) {
    GstBuffer* buffer = check::frame_of(frame.picture, "GRAY8", 0);
    GST_BUFFER_PTS(buffer) = frame.timestamp;
    GstBuffer* seen = gst_harness_push_and_pull(detectors[frame.camera], buffer);
    g_autoptr(GstBuffer) out = gst_harness_push_and_pull(pads[frame.camera], seen);
    return out != nullptr && GST_BUFFER_PTS(out) == frame.timestamp;
  }
  // As a camera that was stopped does.
  void restart(std::size_t camera) {
    for (GstHarness* h : {detectors[camera], pads[camera]}) {
      gst_harness_push_event(h, gst_event_new_flush_start());
      gst_harness_push_event(h, gst_event_new_flush_stop(FALSE));
      GstSegment segment;
      gst_segment_init(&segment, GST_FORMAT_TIME);
      gst_harness_push_event(h, gst_event_new_segment(&segment));
    }
  }
  const GstStructure* wait_for(const char* name) {
    for (int n = 0; n < 600 && bus.named(name).empty(); ++n) g_usleep(50 * 1000);
    const auto all = bus.named(name);
    return all.empty() ? nullptr : all.front();
  }
  const GstStructure* end() {
    for (GstHarness* h : pads) gst_harness_push_event(h, gst_event_new_eos());
    for (const GstStructure* s : bus.named("calib-rig-result")) {
      if (std::strcmp(gst_structure_get_string(s, "state"), "final") == 0) return s;
    }
    return nullptr;
  }

  emulated::Cameras cameras;
  check::TemporaryFolder folder;
  GstElement* rig;
  check::Bus bus;
  std::vector<GstHarness*> pads;
  std::vector<GstHarness*> detectors;
};

double number(const GstStructure* s, const char* field) {
  double value = 0;
  fail_unless(gst_structure_get_double(s, field, &value), "%s", field);
  return value;
}

// Which camera has moved, since when and how far: as it is.
void check_moved(const GstStructure* moved) {
  fail_unless(moved != nullptr);
  fail_unless_equals_string(gst_structure_get_string(moved, "camera"), "cam2");
  fail_unless_equals_string(gst_structure_get_string(moved, "cameras"), "cam2");
  guint64 since = 0;
  gst_structure_get_uint64(moved, "since", &since);
  fail_unless(since >= kBump * GST_SECOND && since < (kBump + 1) * GST_SECOND, "%" GST_TIME_FORMAT,
              GST_TIME_ARGS(since));
  const emulated::Settings settings = as_they_run();
  const double distance = number(moved, "distance");
  const double angle = number(moved, "angle");
  fail_unless(distance > 0.6 * settings.bump_place && distance < 1.4 * settings.bump_place, "%f m",
              distance);
  fail_unless(angle > 0.7 * settings.bump_turn && angle < 1.3 * settings.bump_turn, "%f rad",
              angle);
}

// Only pictures of one time are paired: what the message says of them is so, and all of them agree.
void check_pairs(const GstStructure* result, const emulated::Cameras& cameras) {
  guint64 farthest = 0;
  for (std::size_t i = 0; i < cameras.frames.size(); ++i) {
    for (std::size_t j = i + 1; j < cameras.frames.size(); ++j) {
      const guint64 apart = cameras.frames[j].timestamp - cameras.frames[i].timestamp;
      if (apart > kTolerance) break;
      if (cameras.frames[i].camera != cameras.frames[j].camera) farthest = MAX(farthest, apart);
    }
  }
  guint64 pairing = 0;
  gst_structure_get_uint64(result, "pairing", &pairing);
  fail_unless(pairing <= farthest, "%lu of %lu", gulong(pairing), gulong(farthest));
  fail_unless(pairing > farthest / 2, "%lu of %lu", gulong(pairing), gulong(farthest));
  int rejected = 0;
  gst_structure_get_int(result, "rejected", &rejected);
  // All of the instant of the push, by which the board seems to have moved, at the most.
  fail_unless(rejected <= 4, "%d views contradict the others", rejected);
  const GValue* links = gst_structure_get_value(result, "links");
  fail_unless_equals_int(gst_value_array_get_size(links), 6);
}

}  // namespace

// Where one camera is pushed, and is to be inserted again or not.
GST_START_TEST(test_cameras_that_run_freely) {
  const bool is_reinserted = __i__ > 0;
  Studio s(as_they_run());
  bool is_stopped = false;
  bool is_told = false;
  for (const emulated::Frame& frame : s.cameras.frames) {
    const double now = 1e-9 * static_cast<double>(frame.timestamp);
    if (frame.camera == kStopped && now > 4 && !is_stopped) {
      is_stopped = true;
      s.restart(kStopped);
    }
    if (is_reinserted && now > kReinsert && !is_told) {
      is_told = true;
      check_moved(s.wait_for("calib-rig-moved"));
      const gboolean done = gst_harness_push_upstream_event(
          s.pads[kBumped], gst_event_new_custom(GST_EVENT_CUSTOM_UPSTREAM,
                                                gst_structure_new_empty("calvin-reinsert")));
      fail_unless(done);
    }
    fail_unless(s.push(frame));
  }
  const GstStructure* result = s.end();
  fail_unless(result != nullptr);
  check_pairs(result, s.cameras);
  fail_unless_equals_int(s.bus.named("calib-rig-moved").size(), 1);
  check_moved(s.bus.named("calib-rig-moved").front());
  fail_unless(s.bus.says(GST_MESSAGE_WARNING, "'cam2' has moved"));
  const auto rig = read_rig(s.folder / "rig.json");
  fail_unless(rig.has_value() && rig->cameras.size() == 4);
  const emulated::Error error =
      emulated::error_of(*rig, is_reinserted ? s.cameras.after : s.cameras.before);
  std::cout << "e^T C^-1 e / 18 = " << error.square << ", largest " << error.largest << " sigmas\n";
  fail_unless(error.square < 2.5, "%f", error.square);
  fail_unless(error.largest < 4.5, "%f", error.largest);
  const char* remarks = gst_structure_get_string(result, "remarks");
  const bool says_so = remarks != nullptr && std::strstr(remarks, "'cam2' has moved") != nullptr;
  fail_unless(says_so == !is_reinserted, "%s", remarks != nullptr ? remarks : "");
}
GST_END_TEST;

static Suite* calibrig_cameras_suite(void) {
  Suite* s = suite_create("calibrig_cameras");
  TCase* tc = tcase_create("general");
  suite_add_tcase(s, tc);
  tcase_set_timeout(tc, 280);
  tcase_add_loop_test(tc, test_cameras_that_run_freely, 0, 2);
  return s;
}

GST_CHECK_MAIN(calibrig_cameras);
