// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A rig of two cameras, and calibview as a source that shows it.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "calvin/io/rig_io.hpp"
#include "support.hpp"

#include <gst/check/gstharness.h>

namespace calvin::check {

inline Rig rig_of(double distance) {
  Rig rig;
  for (int c = 0; c < 2; ++c) {
    RigCamera camera;
    camera.calibration =
        Camera::make("pinhole", {640, 480}, {500, 500, 320, 240}).value().to_calibration();
    camera.calibration.camera = c == 0 ? "left" : "right";
    camera.rig_from_camera.translation[0] = c * distance;
    rig.cameras.push_back(std::move(camera));
  }
  rig.world = "left";
  return rig;
}

// The element behind a harness, and its pictures of 320x240, 30 in a second of the system's clock:
// what it makes is what it shows now.
struct ViewFixture {
  explicit ViewFixture(const std::string& properties = "orbit=0") {
    (void)write_rig(location, rig_of(0.1));
    h = gst_harness_new_parse(
        ("calibview is-live=true rig=" + location + " " + properties).c_str());
    gst_harness_use_systemclock(h);
    gst_harness_set_sink_caps_str(h, "video/x-raw,width=320,height=240,framerate=30/1");
  }
  ~ViewFixture() { gst_harness_teardown(h); }
  std::vector<std::uint8_t> pull(GstClockTime* pts = nullptr) {
    g_autoptr(GstBuffer) buffer = gst_harness_pull(h);
    if (pts != nullptr) *pts = GST_BUFFER_PTS(buffer);
    GstMapInfo map;
    gst_buffer_map(buffer, &map, GST_MAP_READ);
    std::vector<std::uint8_t> pixels(map.data, map.data + map.size);
    gst_buffer_unmap(buffer, &map);
    return pixels;
  }
  // Whether one of the next pictures is another one.
  bool changes_from(const std::vector<std::uint8_t>& before) {
    for (int n = 0; n < 300; ++n) {
      if (pull() != before) return true;
    }
    return false;
  }
  check::TemporaryFolder folder;
  std::string location = folder / "rig.json";
  GstHarness* h = nullptr;
};

}  // namespace calvin::check
