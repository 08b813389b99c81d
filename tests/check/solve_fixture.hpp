// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What the tests of calibsolve share: the element in a harness, fed with what a detector would see.
#pragma once

#include <random>
#include <utility>

#include "support.hpp"

#include <gst/check/gstharness.h>

namespace calvin::check {

// A field that is a double, and there.
inline double get(const GstStructure* structure, const char* field) {
  double value = 0;
  const bool found = gst_structure_get_double(structure, field, &value) != FALSE;
  g_assert_true(found);
  return value;
}

// An element that is fed with exact observations plus noise of 0.1 px; the pixels do not matter.
struct SolveFixture {
  // A harness says that it is live; most tests want every view.
  explicit SolveFixture(const std::string& properties = "", Scene seen_scene = {},
                        const char* capture = "capture-mode=all ")
      : scene(std::move(seen_scene)),
        element(make_element("calibsolve " + (capture + properties))),
        bus(element),
        h(harness_of(element)) {
    gst_harness_set_src_caps(h, caps_of("GRAY8", scene.size));
  }
  ~SolveFixture() {
    bus.detach();
    gst_harness_teardown(h);
  }

  // `times`: how often it was seen before; noise is another one each time.
  Observation seen(int n, int times = 0) {
    Observation o = scene.truth(n);
    std::mt19937 random(static_cast<unsigned>(n + 1000 * times));
    std::normal_distribution<double> noise(0, 0.1);
    for (Pixel& p : o.uv) p = {p.u + noise(random), p.v + noise(random)};
    o.sigma.assign(o.ids.size(), 0.1);
    o.camera = "left";
    return o;
  }
  // `width`: of the board in the picture, over the true one: what another camera would see.
  GstBuffer* push(int n, double width = 1) {
    Observation o = seen(n);
    for (Pixel& p : o.uv) p.u = scene.camera.cx() + width * (p.u - scene.camera.cx());
    return push_observation(o, n);
  }
  // On the frame of that number.
  GstBuffer* push_observation(Observation o, int n) {
    GstBuffer* buffer = gst_buffer_new_allocate(nullptr, 640 * 480, nullptr);
    GST_BUFFER_PTS(buffer) = static_cast<guint64>(n) * GST_SECOND / 30;
    GST_BUFFER_DURATION(buffer) = GST_SECOND / 30;
    o.timestamp = GST_BUFFER_PTS(buffer);
    gst::attach_observations(buffer, std::vector{o});
    return gst_harness_push_and_pull(h, buffer);
  }
  void push_views(int count) {
    for (int n = 0; n < count; ++n) gst_buffer_unref(push(n));
  }
  void eos() { gst_harness_push_event(h, gst_event_new_eos()); }
  // The last result message of that state, or nullptr.
  const GstStructure* result(const char* state) {
    const GstStructure* last = nullptr;
    for (const GstStructure* s : bus.named("calib-result")) {
      if (g_strcmp0(gst_structure_get_string(s, "state"), state) == 0) last = s;
    }
    return last;
  }

  Scene scene;
  GstElement* element;
  Bus bus;
  GstHarness* h;
};

}  // namespace calvin::check
