// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The properties of calibundistort.
#pragma once

#include <string>

#include "undistort/view_properties.hpp"

namespace calvin::gst {

struct UndistortSettings {
  std::string calibration;
  bool enabled = true;
  ViewSettings view;
};

// The one that is not kept in the settings.
inline constexpr guint kUndistortOutputCalibration = 5;

void install_undistort_properties(GObjectClass* object_class);

// Where the property of that number is kept; nowhere for kUndistortOutputCalibration.
[[nodiscard]] Field undistort_field(UndistortSettings& settings, guint id);

// The other name of a property that has two, else nullptr: whoever listens to that one is told too.
[[nodiscard]] const char* other_name(guint id);

// Whether the calibration is set by the property of that number.
[[nodiscard]] bool tells_calibration(guint id);

}  // namespace calvin::gst
