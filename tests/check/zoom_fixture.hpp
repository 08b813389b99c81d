// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A small zoom table, and what calibundistort has to make of the grey noise with it.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "calvin/camera/zoom_interpolation.hpp"
#include "calvin/io/zoom_io.hpp"
#include "undistort_fixture.hpp"

namespace calvin::check {

// Zoom 100 to 500: from barrel to pincushion.
inline ZoomTable zoom_table(ImageSize size = kSize) {
  const double k1[] = {-0.3, -0.12, 0.05, 0.3, 0.6};
  std::vector<Calibration> settings;
  for (int i = 0; i < 5; ++i) {
    const double f = size.width * (0.8 + 0.3 * i);
    settings.push_back(Camera::make("brown4", size,
                                    {f, f, size.width / 2.0 + i, size.height / 2.0, k1[i], 0, 0, 0})
                           .value()
                           .to_calibration());
    settings.back().zoom = 100 * (i + 1);
  }
  return make_zoom_table(std::move(settings)).value();
}

inline std::string text_of(const ZoomTable& table) { return print_zoom_table(table).value(); }

inline Camera camera_at(const ZoomTable& table, double zoom) {
  return Camera::make(interpolate(table, {zoom, std::nullopt})->calibration).value();
}

inline std::vector<guint8> gray_at(const ZoomTable& table, double zoom) {
  return gray_through(Undistorter::make(camera_at(table, zoom), {}, {PlaneLayout{}}).value());
}

}  // namespace calvin::check
