// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What the properties of calibundistort are set to.
#pragma once

#include <optional>
#include <string>

#include "calvin/camera/zoom_table.hpp"
#include "calvin/device/lens.hpp"
#include "calvin/remap/rectification.hpp"
#include "calvin/remap/undistorter.hpp"

namespace calvin::gst {

enum class Direction { kUndistort, kDistort };
enum class Rectify { kNone, kLeft, kRight };

// What the output shows and how it is made.
struct ViewSettings {
  double alpha = 0;
  AlphaMode alpha_mode = AlphaMode::kCalvin;
  Projection projection = Projection::kRectilinear;
  double zoom = 1;
  double pan = 0;  // degrees
  double tilt = 0;
  double roll = 0;
  Direction direction = Direction::kUndistort;
  Interpolation interpolation = Interpolation::kBilinear;
  Outside outside = Outside::kFill;
  int threads = 1;

  [[nodiscard]] bool distort() const { return direction == Direction::kDistort; }
  [[nodiscard]] ViewOptions view() const;
  [[nodiscard]] Sampling sampling() const;
};

// Where the application says that the lens stands. What it has never set it does not say.
struct LensSettings {
  double zoom = 0;
  double focus = 0;
  bool zoom_was_set = false;
  bool focus_was_set = false;
  std::string device;  // the V4L2 node that says the rest; empty: none does

  [[nodiscard]] LensPosition position(const std::optional<LensState>& lens) const;
};

struct UndistortSettings {
  std::string calibration;
  bool calibration_was_set = false;  // since the streaming thread looked last
  LensSettings lens;
  bool enabled = true;
  Rectify rectify = Rectify::kNone;
  ViewSettings view;

  // Of the camera that the frames are of, where they are to be rectified.
  [[nodiscard]] std::optional<StereoSide> side() const;
};

}  // namespace calvin::gst
