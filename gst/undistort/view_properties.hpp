// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The properties of calibundistort that say what its output shows and how it is made.
#pragma once

#include <glib-object.h>

#include "calvin/remap/undistorter.hpp"
#include "common/field.hpp"

namespace calvin::gst {

enum class Direction { kUndistort, kDistort };

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

// Properties first..first+count-1 of a class.
inline constexpr guint kViewProperties = 11;
void install_view_properties(GObjectClass* object_class, guint first);

// `which` counts from 0.
[[nodiscard]] Field view_field(ViewSettings& settings, guint which);

}  // namespace calvin::gst
