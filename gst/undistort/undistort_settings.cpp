// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Gives the settings of the view to the library in its units.

#include "undistort/undistort_settings.hpp"

#include <numbers>

namespace calvin::gst {

namespace {

constexpr double kRadians = std::numbers::pi / 180;

}  // namespace

ViewOptions ViewSettings::view() const {
  ViewOptions options;
  options.alpha = alpha;
  options.alpha_mode = alpha_mode;
  options.projection = projection;
  options.zoom = zoom;
  options.pan = pan * kRadians;
  options.tilt = tilt * kRadians;
  options.roll = roll * kRadians;
  return options;
}

std::optional<StereoSide> UndistortSettings::side() const {
  if (rectify == Rectify::kNone) return std::nullopt;
  return rectify == Rectify::kLeft ? StereoSide::kLeft : StereoSide::kRight;
}

LensPosition LensSettings::position(const std::optional<LensState>& lens) const {
  LensPosition position;
  if (lens && lens->zoom) position.zoom = *lens->zoom;
  if (lens && lens->focus) position.focus = *lens->focus;
  if (zoom_was_set) position.zoom = zoom;
  if (focus_was_set) position.focus = focus;
  return position;
}

Sampling ViewSettings::sampling() const { return {interpolation, outside}; }

}  // namespace calvin::gst
