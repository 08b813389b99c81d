// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Live cameras in one pipeline, each before a detector and a pad of calibrig: what they deliver was
// rendered beforehand, and comes in real time.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "calvin/io/calibration_io.hpp"
#include "emulated_cameras.hpp"
#include "support.hpp"

#include <gst/check/gstcheck.h>

namespace calvin::check {

inline constexpr GstClockTime kFrame = GST_SECOND / 30;
// A camera needs that long to deliver a frame. Where the machine itself has stood still, what was
// due meanwhile comes one by one and not at once, as from a camera that goes on.
inline constexpr GstClockTime kReadout = GST_SECOND / 120;

inline bool is_full() {
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

inline void on_frame(GstElement* sink, GstBuffer* buffer, GstPad* /*pad*/, gpointer data) {
  auto& arrivals = *static_cast<Arrivals*>(data);
  const GstClockTime pts = GST_BUFFER_PTS(buffer);
  if (GST_CLOCK_TIME_IS_VALID(arrivals.last) && pts != arrivals.last + kFrame) ++arrivals.gaps;
  arrivals.last = pts;
  const GstClockTime now = gst_element_get_current_running_time(sink);
  if (now > pts) arrivals.longest = MAX(arrivals.longest, now - pts);
  ++arrivals.count;
}

struct LiveSettings {
  emulated::Settings cameras;
  std::string detector = "calibdetect";
  bool has_intrinsics = true;  // of each pad
};

// Cameras that cannot wait: of a frame that is not taken at once the next one but one takes the
// place. A machine that others use as well stands still for longer than a second at times: unless
// the full counts are asked for, on a quiet machine, three are allowed.
struct LiveStudio {
  explicit LiveStudio(const LiveSettings& settings) : cameras(emulated::render(settings.cameras)) {
    frames.resize(cameras.calibrations.size());
    last_.resize(frames.size());
    for (emulated::Frame& frame : cameras.frames) {
      shots.push_back({frame.camera, frame.timestamp, check::frame_of(frame.picture, "GRAY8", 0)});
      frames[frame.camera].push_back(shots.back().picture);
      frame.picture = {};
    }
    std::string launch = "calibrig name=rig location=" + (folder / "rig.json");
    std::string branches;
    for (std::size_t c = 0; c < frames.size(); ++c) {
      const std::string file = folder / fmt::format("cam{}.json", c).c_str();
      (void)write_calibration(file, cameras.calibrations[c]);
      if (settings.has_intrinsics) launch += fmt::format(" sink_{}::intrinsics={}", c, file);
      branches += fmt::format(
          " appsrc name=camera{0} is-live=true format=time max-buffers={1} leaky-type=downstream "
          "block=false caps=video/x-raw,format=GRAY8,width={2},height={3},framerate=30/1 ! {4} ! "
          "rig.sink_{0} rig.src_{0} ! fakesink name=sink{0} sync=false async=false "
          "signal-handoffs=true",
          c, is_full() ? 2 : 90, settings.cameras.size.width, settings.cameras.size.height,
          settings.detector);
    }
    pipeline = gst_parse_launch((launch + branches).c_str(), nullptr);
    arrivals = std::vector<Arrivals>(frames.size());
    for (std::size_t c = 0; c < frames.size(); ++c) {
      sources.push_back(child(fmt::format("camera{}", c)));
      g_autoptr(GstElement) sink = child(fmt::format("sink{}", c));
      g_signal_connect(sink, "handoff", G_CALLBACK(on_frame), &arrivals[c]);
    }
  }
  LiveStudio(const LiveStudio&) = delete;
  LiveStudio& operator=(const LiveStudio&) = delete;
  ~LiveStudio() {
    gst_element_set_state(pipeline, GST_STATE_NULL);
    for (GstElement* source : sources) gst_object_unref(source);
    for (const Shot& shot : shots) gst_buffer_unref(shot.picture);
    gst_object_unref(pipeline);
  }
  [[nodiscard]] GstElement* child(const std::string& name) const {
    return gst_bin_get_by_name(GST_BIN(pipeline), name.c_str());
  }

  // The n-th frame of all cameras at its time: there and back through the motion.
  void run(int count) {
    start();
    for (int n = 0; n < count; ++n) {
      const GstClockTime pts = static_cast<GstClockTime>(n) * kFrame;
      for (std::size_t c = 0; c < frames.size(); ++c) {
        const int there = static_cast<int>(frames[c].size()) - 1;
        const int at = n % (2 * there);
        push(c, frames[c][static_cast<std::size_t>(at <= there ? at : 2 * there - at)], pts);
      }
    }
  }
  // Each frame at the time at which its camera has taken it.
  void play() {
    start();
    for (const Shot& shot : shots) push(shot.camera, shot.picture, shot.timestamp);
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
    fail_unless(message != nullptr, "no end within two minutes");
    if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR) {
      g_autoptr(GError) error = nullptr;
      gst_message_parse_error(message, &error, nullptr);
      fail_unless(false, "%s", error->message);
    }
  }

  struct Shot {
    std::size_t camera = 0;
    GstClockTime timestamp = 0;
    GstBuffer* picture = nullptr;
  };

  check::TemporaryFolder folder;
  emulated::Cameras cameras;                    // without the pictures
  std::vector<Shot> shots;                      // in the order of time
  std::vector<std::vector<GstBuffer*>> frames;  // the same by camera
  std::vector<GstElement*> sources;
  std::vector<Arrivals> arrivals;
  GstElement* pipeline = nullptr;

 private:
  void start() {
    gst_element_set_state(pipeline, GST_STATE_PLAYING);
    gst_element_get_state(pipeline, nullptr, nullptr, GST_CLOCK_TIME_NONE);
    g_autoptr(GstClock) clock = gst_element_get_clock(pipeline);
    begin_ = gst_clock_get_time(clock) - gst_element_get_base_time(pipeline) + 3 * kFrame;
  }
  // At that time after the start.
  void push(std::size_t camera, GstBuffer* picture, GstClockTime time) {
    g_autoptr(GstClock) clock = gst_element_get_clock(pipeline);
    const GstClockTime pts = begin_ + time;
    const GstClockTime due =
        MAX(gst_element_get_base_time(pipeline) + pts, last_[camera] + kReadout);
    const GstClockID id = gst_clock_new_single_shot_id(clock, due);
    gst_clock_id_wait(id, nullptr);
    gst_clock_id_unref(id);
    last_[camera] = gst_clock_get_time(clock);
    GstBuffer* buffer = gst_buffer_copy(picture);
    GST_BUFFER_PTS(buffer) = pts;
    GstFlowReturn flow = GST_FLOW_OK;
    g_signal_emit_by_name(sources[camera], "push-buffer", buffer, &flow);
    gst_buffer_unref(buffer);
    fail_unless_equals_int(flow, GST_FLOW_OK);
  }

  GstClockTime begin_ = 0;          // running time of the first frame
  std::vector<GstClockTime> last_;  // when each camera has delivered
};

}  // namespace calvin::check
