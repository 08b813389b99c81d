// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What calibtestsrc renders: its settings made sense of, and the frames of one size. No GStreamer.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "calvin/camera/camera.hpp"
#include "calvin/core/calibration.hpp"
#include "calvin/core/result.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/synth/motion.hpp"
#include "calvin/synth/render.hpp"

namespace calvin::gst {

struct SceneSettings {
  std::string board{kDefaultBoard};
  std::string calibration;  // as parse_calibration_setting() takes it; empty: default_camera()
  std::string rig;          // a file or JSON: then the camera is one of that
  std::string camera;       // its name; empty: the first one
  MotionKind motion = MotionKind::kRandom;
  std::uint64_t seed = 0;
};

// The texts of the settings, understood.
struct SceneSource {
  Board board;
  std::optional<Calibration> calibration;
  MotionKind motion = MotionKind::kRandom;
  std::uint64_t seed = 0;
  // Of a camera of a rig: the board moves before the first one, as that sees it.
  struct First {
    Camera camera;
    SE3 own_from_first;
  };
  std::optional<First> first;
};
[[nodiscard]] Result<SceneSource> read_scene_settings(const SceneSettings& settings);

struct TestFrame {
  std::int64_t number = 0;
  std::uint64_t time = 0;     // ns
  std::uint64_t readout = 0;  // ns from the first row to the last
  bool hold = false;          // random poses stay for 0.5 s instead of one frame
};

// All that the frames of one size have in common. Immutable.
class TestScene {
 public:
  // The calibration is scaled to the size where it is for another one of the same aspect; another
  // aspect is kInvalidArgument.
  static Result<TestScene> make(const SceneSource& source, ImageSize size);

  [[nodiscard]] const Calibration& truth() const { return truth_; }
  [[nodiscard]] const std::string& truth_json() const { return json_; }

  // Where the board is at row `v` of a frame.
  [[nodiscard]] SE3 pose(const TestFrame& frame, double v = 0) const;
  // The picture of the frame; options.seed is not used.
  [[nodiscard]] GrayImage picture(const TestFrame& frame, RenderOptions options) const;
  [[nodiscard]] Observation observation(const TestFrame& frame) const;

 private:
  TestScene(const SceneSource& source, const Camera& camera);

  [[nodiscard]] SE3 placed(double at) const;
  // Whether the board moves while a frame is taken.
  [[nodiscard]] bool rolls(const TestFrame& frame) const;

  SceneSource source_;
  Camera camera_;
  Calibration truth_;
  std::string json_;
  Motion motion_;
  BoardRenderer renderer_;
};

}  // namespace calvin::gst
