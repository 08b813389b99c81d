// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibrig with a harness around the pads of each camera.
#pragma once

#include <algorithm>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "calvin/io/calibration_io.hpp"
#include "rig_views.hpp"
#include "support.hpp"

#include <gst/check/gstharness.h>

namespace calvin::check {

using rig_views::SeenByCamera;

// A rig of cameras, a harness around the pads of each, and what they see.
struct RigFixture {
  explicit RigFixture(std::vector<SeenByCamera> of, bool with_intrinsics = true,
                      GstClockTime clock_error = 0)
      : cameras(std::move(of)), element(make_element("calibrig")), bus(element) {
    gst_object_ref_sink(element);
    for (std::size_t c = 0; c < cameras.size(); ++c) {
      const std::string number = std::to_string(c);
      harnesses.push_back(gst_harness_new_with_element(element, ("sink_" + number).c_str(),
                                                       ("src_" + number).c_str()));
      // A harness starts its element, and settings are for the next start.
      gst_element_set_state(element, GST_STATE_NULL);
      if (with_intrinsics) {
        const std::string file = folder / ("cam" + number + ".json").c_str();
        (void)write_calibration(file, cameras[c].calibration);
        gst_child_proxy_set(GST_CHILD_PROXY(element), ("sink_" + number + "::intrinsics").c_str(),
                            file.c_str(), nullptr);
      }
      for (Observation& seen : cameras[c].observations) seen.timestamp += c * clock_error;
    }
  }
  ~RigFixture() {
    bus.detach();
    for (GstHarness* h : harnesses) gst_harness_teardown(h);
    gst_object_unref(element);
  }

  // A harness starts its element before anything can be set.
  void start() {
    gst_element_set_state(element, GST_STATE_NULL);
    gst_element_set_state(element, GST_STATE_PLAYING);
    for (std::size_t c = 0; c < harnesses.size(); ++c) {
      const ImageSize size = cameras[c].calibration.image_size;
      gst_harness_set_src_caps(harnesses[c], caps_of("GRAY8", size));
    }
  }
  // A frame of a camera, and the one that came out.
  GstBuffer* push(std::size_t camera, const std::vector<Observation>& observations,
                  GstClockTime pts) {
    const ImageSize size = cameras[camera].calibration.image_size;
    GstBuffer* buffer = gst_buffer_new_allocate(
        nullptr, static_cast<gsize>(GST_ROUND_UP_4(size.width) * size.height), nullptr);
    GST_BUFFER_PTS(buffer) = pts;
    gst::attach_observations(buffer, observations);
    return gst_harness_push_and_pull(harnesses[camera], buffer);
  }
  // What all cameras see, in the order of time.
  void push_all(std::size_t leave_out = 1000) {
    std::vector<std::pair<std::uint64_t, std::pair<std::size_t, std::size_t>>> order;
    for (std::size_t c = 0; c < cameras.size(); ++c) {
      for (std::size_t v = 0; v < cameras[c].observations.size(); ++v) {
        if (c != leave_out) order.push_back({cameras[c].observations[v].timestamp, {c, v}});
      }
    }
    std::sort(order.begin(), order.end());
    for (auto one = order.begin(); one != order.end();) {
      const auto [time, of] = *one;
      std::vector<Observation> picture;
      for (; one != order.end() && one->first == time && one->second.first == of.first; ++one) {
        picture.push_back(cameras[of.first].observations[one->second.second]);
      }
      gst_buffer_unref(push(of.first, picture, time));
    }
  }
  void end_all() {
    for (GstHarness* h : harnesses) gst_harness_push_event(h, gst_event_new_eos());
  }
  // A whole session, with the properties that were set before.
  void run() {
    start();
    push_all();
    end_all();
  }
  const GstStructure* final_result() {
    for (const GstStructure* s : bus.named("calib-rig-result")) {
      if (std::strcmp(gst_structure_get_string(s, "state"), "final") == 0) return s;
    }
    return nullptr;
  }
  double worst(const Rig& found) const { return rig_views::worst_error(found, cameras); }

  std::vector<SeenByCamera> cameras;
  TemporaryFolder folder;
  GstElement* element;
  Bus bus;
  std::vector<GstHarness*> harnesses;
};

}  // namespace calvin::check
