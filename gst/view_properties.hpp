// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The properties of calibundistort that say what its output shows and how it is made.
#pragma once

#include <glib-object.h>

#include "calvin/remap/undistorter.hpp"

namespace calvin::gst {

struct ViewSettings {
  double alpha = 0;
  AlphaMode alpha_mode = AlphaMode::kCalvin;
  Projection projection = Projection::kRectilinear;
  double zoom = 1;
  double pan = 0;  // degrees
  double tilt = 0;
  double roll = 0;
  bool distort = false;
  Interpolation interpolation = Interpolation::kBilinear;
  Outside outside = Outside::kFill;
  int threads = 1;

  [[nodiscard]] ViewOptions view() const;
  [[nodiscard]] Sampling sampling() const;
};

// Properties first..first+count-1 of a class.
inline constexpr guint kViewProperties = 11;
void install_view_properties(GObjectClass* object_class, guint first);

// `which` counts from 0. Whoever calls holds the lock of the settings. false: there is none.
bool set_view_property(ViewSettings& settings, guint which, const GValue* value);
bool get_view_property(const ViewSettings& settings, guint which, GValue* value);

}  // namespace calvin::gst
