// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// By how much each setting of a zoom table counts at a position of the lens.
#pragma once

#include <vector>

#include "calvin/camera/zoom_table.hpp"

namespace calvin {

// How the focal length goes with what the control of a lens says.
enum class ZoomLaw {
  kPower,        // 1 / f straight: a motor that moves a group of lenses
  kLogarithm,    // log f straight: equal steps magnify equally
  kFocalLength,  // f straight: the control is the magnification
};

// The law by which the focal length of each inner zoom is found best from those of the others; of
// two zooms the logarithm.
[[nodiscard]] ZoomLaw zoom_law(const ZoomTable& table);

// A focal length as what is interpolated of it, the inverse, and its derivative.
[[nodiscard]] double by_law(ZoomLaw law, double f);
[[nodiscard]] double from_law(ZoomLaw law, double value);
[[nodiscard]] double slope_of_law(ZoomLaw law, double f);

// What lies between two settings.
enum class ZoomCurve {
  kSmooth,    // monotone_cubic_weights(), guided by the focal length
  kStraight,  // what is always between what the two have
};

// Of sum 1, along the focus within each zoom, and then along the zoom; beyond the table it ends. A
// focus or zoom that is absent is the first one.
[[nodiscard]] std::vector<double> setting_weights(const ZoomTable& table, ZoomLaw law,
                                                  ZoomCurve curve, const LensPosition& position);

}  // namespace calvin
