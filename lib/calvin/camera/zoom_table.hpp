// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Calibrations of one camera whose lens zooms, by where its zoom and its focus stood.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "calvin/core/calibration.hpp"
#include "calvin/core/result.hpp"

namespace calvin {

// In the units of the camera's controls, or of whatever encoder the lens has. Absent: not known.
struct LensPosition {
  std::optional<double> zoom;
  std::optional<double> focus;
  friend bool operator==(const LensPosition&, const LensPosition&) = default;
};

struct ZoomSetting {
  Calibration calibration;  // its `zoom` and `focus` are where the lens stood
  // px: how far the calibration that the table has without this setting is from it, in the worst
  // place that corners covered. Absent at the ends of the table, which nothing else tells of.
  std::optional<double> left_out;
};

struct ZoomTable {
  std::string camera;
  // By zoom, and by focus where several have one zoom. All have a zoom; all have a focus or none
  // has; all have one model and one size of images.
  std::vector<ZoomSetting> settings;
};

// Settings that have one zoom, of ZoomTable::settings.
struct ZoomGroup {
  std::size_t begin = 0;
  std::size_t end = 0;
};
[[nodiscard]] std::vector<ZoomGroup> groups_of(const ZoomTable& table);

// Whether some zoom has several settings of the focus, so that who asks must know the focus too.
[[nodiscard]] bool depends_on_focus(const ZoomTable& table);

// A table of calibrations in any order. kInvalidArgument, with what to do: fewer than two, one that
// does not say its zoom, some with a focus and some without, two at one position, and what is not
// of one camera: models, sizes of images, crops or names that differ. Camera::make()'s errors for
// what is none.
[[nodiscard]] Result<ZoomTable> make_zoom_table(std::vector<Calibration> calibrations);

}  // namespace calvin
