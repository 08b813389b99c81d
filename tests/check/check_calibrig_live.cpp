// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Four live cameras of 1280x720 at 30 frames a second through calibdetect and calibrig: every frame
// that a camera delivers comes out, while boards are looked for and the rig is solved.

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <string>
#include <vector>

#include "calvin/io/calibration_io.hpp"
#include "calvin/io/rig_io.hpp"
#include "emulated_cameras.hpp"
#include "support.hpp"

#include <gst/check/gstcheck.h>

using namespace calvin;

namespace {

constexpr std::size_t kCameras = 4;
constexpr GstClockTime kFrame = GST_SECOND / 30;

bool is_full() {
  const char* text = std::getenv("CALVIN_FULL");
  return text != nullptr && std::strcmp(text, "1") == 0;
}

// What a sink gets: frames in the order of time, each once.
struct Arrivals {
  std::atomic<int> count{0};
  std::atomic<int> gaps{0};
  GstClockTime last = GST_CLOCK_TIME_NONE;
  GstClockTime longest = 0;  // from the time of a frame to its arrival
};

void on_frame(GstElement* sink, GstBuffer* buffer, GstPad* /*pad*/, gpointer data) {
  auto& arrivals = *static_cast<Arrivals*>(data);
  const GstClockTime pts = GST_BUFFER_PTS(buffer);
  if (GST_CLOCK_TIME_IS_VALID(arrivals.last) && pts != arrivals.last + kFrame) ++arrivals.gaps;
  arrivals.last = pts;
  const GstClockTime now = gst_element_get_current_running_time(sink);
  if (now > pts) arrivals.longest = MAX(arrivals.longest, now - pts);
  ++arrivals.count;
}

// Cameras that cannot wait: of a frame that is not taken at once the next one but one takes the
// place. Beside other tests the machine itself stands still for longer than that: there a second is
// allowed, which only a stream that is held up uses.
struct LiveStudio {
  explicit LiveStudio(double seconds_of_motion) {
    emulated::Settings settings;
    settings.size = {1280, 720};
    settings.seconds = seconds_of_motion;
    settings.is_synchronous = true;
    settings.jitter = settings.drift = settings.lost = 0;
    cameras = emulated::render(settings);
    frames.resize(kCameras);
    for (const emulated::Frame& frame : cameras.frames) {
      frames[frame.camera].push_back(check::frame_of(frame.picture, "GRAY8", 0));
    }
    std::string launch = "calibrig name=rig location=" + (folder / "rig.json");
    std::string branches;
    for (std::size_t c = 0; c < kCameras; ++c) {
      const std::string n = std::to_string(c);
      const std::string file = folder / ("cam" + n + ".json").c_str();
      (void)write_calibration(file, cameras.calibrations[c]);
      launch += " sink_" + n + "::intrinsics=" + file;
      branches +=
          " appsrc name=camera" + n +
          " is-live=true format=time max-buffers=" + (is_full() ? "2" : "30") +
          " leaky-type=downstream block=false "
          "caps=video/x-raw,format=GRAY8,width=1280,height=720,framerate=30/1 ! calibdetect "
          "! rig.sink_" +
          n + " rig.src_" + n + " ! fakesink name=sink" + n +
          " sync=false async=false signal-handoffs=true";
    }
    pipeline = gst_parse_launch((launch + branches).c_str(), nullptr);
    for (std::size_t c = 0; c < kCameras; ++c) {
      sources.push_back(child("camera", c));
      g_autoptr(GstElement) sink = child("sink", c);
      g_signal_connect(sink, "handoff", G_CALLBACK(on_frame), &arrivals[c]);
    }
  }
  ~LiveStudio() {
    gst_element_set_state(pipeline, GST_STATE_NULL);
    for (GstElement* source : sources) gst_object_unref(source);
    for (const auto& of : frames) {
      for (GstBuffer* frame : of) gst_buffer_unref(frame);
    }
    gst_object_unref(pipeline);
  }
  GstElement* child(const char* name, std::size_t number) const {
    return gst_bin_get_by_name(GST_BIN(pipeline), (name + std::to_string(number)).c_str());
  }

  // The n-th frame of all cameras at its time: there and back through the motion.
  void run(int count) {
    gst_element_set_state(pipeline, GST_STATE_PLAYING);
    gst_element_get_state(pipeline, nullptr, nullptr, GST_CLOCK_TIME_NONE);
    g_autoptr(GstClock) clock = gst_element_get_clock(pipeline);
    const GstClockTime base = gst_element_get_base_time(pipeline);
    const GstClockTime start = gst_clock_get_time(clock) - base + 3 * kFrame;
    for (int n = 0; n < count; ++n) {
      const GstClockTime pts = start + static_cast<GstClockTime>(n) * kFrame;
      const GstClockID id = gst_clock_new_single_shot_id(clock, base + pts);
      gst_clock_id_wait(id, nullptr);
      gst_clock_id_unref(id);
      for (std::size_t c = 0; c < kCameras; ++c) {
        const int there = static_cast<int>(frames[c].size()) - 1;
        const int at = n % (2 * there);
        GstBuffer* buffer =
            gst_buffer_copy(frames[c][static_cast<std::size_t>(at <= there ? at : 2 * there - at)]);
        GST_BUFFER_PTS(buffer) = pts;
        GstFlowReturn flow = GST_FLOW_OK;
        g_signal_emit_by_name(sources[c], "push-buffer", buffer, &flow);
        gst_buffer_unref(buffer);
        fail_unless_equals_int(flow, GST_FLOW_OK);
      }
    }
  }
  // Waits for the last solve.
  void end() {
    for (GstElement* source : sources) {
      GstFlowReturn flow = GST_FLOW_OK;
      g_signal_emit_by_name(source, "end-of-stream", &flow);
    }
    g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
    g_autoptr(GstMessage) message = gst_bus_timed_pop_filtered(
        bus, 120 * GST_SECOND, static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR));
    fail_unless(message != nullptr && GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS);
  }

  check::TemporaryFolder folder;
  emulated::Cameras cameras;
  std::vector<std::vector<GstBuffer*>> frames;  // by camera
  std::vector<GstElement*> sources;
  Arrivals arrivals[kCameras];
  GstElement* pipeline = nullptr;
};

}  // namespace

GST_START_TEST(test_no_frame_is_lost) {
  const int count = is_full() ? 30 * 60 : 30 * 5;
  LiveStudio studio(is_full() ? 2.5 : 1.5);
  studio.run(count);
  studio.end();
  for (const Arrivals& arrivals : studio.arrivals) {
    std::cout << arrivals.count << " of " << count << " frames, at the latest "
              << arrivals.longest / GST_MSECOND << " ms after they were taken\n";
    fail_unless_equals_int(arrivals.count, count);
    fail_unless_equals_int(arrivals.gaps, 0);
  }
  const auto rig = read_rig(studio.folder / "rig.json");
  fail_unless(rig.has_value() && rig->cameras.size() == kCameras);
  const emulated::Error error = emulated::error_of(*rig, studio.cameras.after);
  std::cout << "e^T C^-1 e / 18 = " << error.square << ", largest " << error.largest << " sigmas\n";
  // The same pictures come again, with the same noise.
  fail_unless(error.largest < 8, "%f", error.largest);
}
GST_END_TEST;

static Suite* calibrig_live_suite(void) {
  Suite* s = suite_create("calibrig_live");
  TCase* tc = tcase_create("general");
  suite_add_tcase(s, tc);
  tcase_set_timeout(tc, 280);
  tcase_add_test(tc, test_no_frame_is_lost);
  return s;
}

GST_CHECK_MAIN(calibrig_live);
