// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A calibdetect before a harness, and the scene that it is shown.
#pragma once

#include "support.hpp"

#include <gst/check/gstharness.h>

namespace calvin::check {

struct DetectFixture {
  explicit DetectFixture(const char* launch = "calibdetect mode=sync", const char* format = "GRAY8")
      : element(make_element(launch)), bus(element), h(harness_of(element)) {
    gst_harness_set_src_caps(h, caps_of(format, scene.size));
  }
  ~DetectFixture() {
    bus.detach();
    gst_harness_teardown(h);
  }
  Scene scene;
  GstElement* element;
  Bus bus;
  GstHarness* h;
};

}  // namespace calvin::check
