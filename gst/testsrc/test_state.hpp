// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What calibtestsrc was set to, and what it renders from that.
#pragma once

#include <optional>
#include <string>

#include <gst/base/gstbasesrc.h>
#include <gst/video/video.h>

#include "common/shared_settings.hpp"
#include "testsrc/frame_timeline.hpp"
#include "testsrc/test_scene.hpp"

namespace calvin::gst {

struct TestSettings {
  SceneSettings scene;
  RenderOptions render{.noise = 1, .blur = 0.7};
  std::string ground_truth;
  guint64 readout_time = 0;  // ns
};

struct TestState : SharedSettings<TestSettings> {
  explicit TestState(GstBaseSrc* source_element) : element(source_element) {}

  // Any thread. GstBaseSrc keeps whether the source is live.
  [[nodiscard]] bool is_live() { return gst_base_src_is_live(element) != FALSE; }
  void set_live(bool live) { gst_base_src_set_live(element, live); }
  [[nodiscard]] GstVideoInfo shared_info() {
    const std::lock_guard guard(lock_);
    return info;
  }

  // Streaming thread, and start() before it runs.
  void set_info(const GstVideoInfo& next) {
    const std::lock_guard guard(lock_);
    info = next;
  }

  GstBaseSrc* element;
  GstVideoInfo info{};  // lock_ to write, and to read off the streaming thread
  SceneSource source;
  std::optional<TestScene> scene;  // of the present size
  FrameTimeline timeline;
};

}  // namespace calvin::gst
