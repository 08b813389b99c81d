// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Zoom lenses that do not exist, as measured ones are: focal length, distortion and principal point
// move smoothly, and not in proportion to what the control says.
#pragma once

#include <cmath>
#include <ostream>
#include <string_view>
#include <vector>

#include "calvin/camera/camera.hpp"

namespace calvin::scenes {

struct ZoomLens {
  const char* name;
  const char* model;
  ImageSize size;
  double first;  // in units of its control
  double last;
  // 0..1 from one end of the control to the other -> the same of log f.
  double (*travel)(double t);
  double shortest;  // px
  double ratio;     // of the longest focal length to the shortest
  // What the terms of the third, fifth and seventh order do in the corner of the image, as parts of
  // its distance from the middle, where `s` is 0..1 of log f.
  double (*third)(double s);
  double (*fifth)(double s);
  double (*seventh)(double s);
  // px from the middle of the image.
  double (*right)(double s);
  double (*down)(double s);
  // Whether its settings are calibrated where the lens moves fastest rather than evenly.
  bool uneven = false;

  friend std::ostream& operator<<(std::ostream& out, const ZoomLens& lens) {
    return out << lens.name;
  }

  [[nodiscard]] Camera at(double zoom) const {
    const double s = travel((zoom - first) / (last - first));
    const double f = shortest * std::pow(ratio, s);
    const double corner = std::hypot(size.width, size.height) / 2 / f;  // of the ideal picture
    const double q = corner * corner;
    std::vector<double> p = {f, 1.001 * f, (size.width - 1) / 2.0 + right(s),
                             (size.height - 1) / 2.0 + down(s)};
    if (std::string_view(model) == "fisheye") {
      for (const double k : {third(s) / q, fifth(s) / q / q, seventh(s) / q / q / q, 0.0}) {
        p.push_back(k);
      }
    } else {
      const double decentring = 0.002 / corner;
      for (const double k : {third(s) / q, fifth(s) / q / q, decentring * (s - 0.4),
                             decentring * (0.7 - s * s), seventh(s) / q / q / q}) {
        p.push_back(k);
      }
    }
    return Camera::make(model, size, p).value();
  }

  // Where a number of settings are calibrated.
  [[nodiscard]] std::vector<double> settings(int count) const {
    std::vector<double> all;
    for (int i = 0; i < count; ++i) {
      double t = static_cast<double>(i) / (count - 1);
      if (uneven) t = 1 - std::pow(1 - t, 1.6);
      all.push_back(first + t * (last - first));
    }
    return all;
  }
};

// Distortion goes from barrel to pincushion in all of them.
inline const std::vector<ZoomLens> kZoomLenses = {
    // A camera for conferences: the control is nearly the focal length.
    {"Conference",
     "brown5",
     {640, 480},
     100,
     500,
     [](double t) { return std::log(1 + 3 * t * (0.85 + 0.15 * t)) / std::log(4.0); },
     520,
     4,
     [](double s) { return -0.15 + 0.22 * s - 0.03 * s * s; },
     [](double s) { return 0.03 * (1 - s) * (1 - s) - 0.004 * s; },
     [](double) { return 0.0; },
     [](double s) { return 5 + 6 * std::sin(2.2 * s); },
     [](double s) { return -4 - 3 * s + 5 * s * s; }},
    // A box lens for television: its encoder is the logarithm, and pincushion is most in between.
    {"Television",
     "brown5",
     {1280, 720},
     0,
     1,
     [](double t) { return t; },
     1100,
     12,
     [](double s) { return -0.06 + 0.20 * s - 0.13 * s * s; },
     [](double s) { return 0.012 - 0.03 * s + 0.02 * s * s; },
     [](double s) { return -0.002 * (1 - s); },
     [](double s) { return 9 * std::cos(3 * s); },
     [](double s) { return 7 * s * s * s - 3; }},
    // A varifocal lens with a stepping motor: the refractive power goes with the steps.
    {"Stepper",
     "brown5",
     {1280, 960},
     -40,
     1200,
     [](double t) { return -std::log(1 - 0.7 * t) / -std::log(0.3); },
     780,
     1 / 0.3,
     [](double s) { return -0.11 + 0.16 * s * s * (3 - 2 * s); },
     [](double s) { return 0.02 * std::cos(2.5 * s); },
     [](double s) { return 0.004 * s - 0.003; },
     [](double s) { return -12 + 8 / (1 + std::exp(-8 * (s - 0.5))); },
     [](double s) { return 6 - 9 * s; },
     true},
    // A varifocal lens that is a fisheye at its wide end.
    {"Fisheye",
     "fisheye",
     {1280, 960},
     0,
     255,
     [](double t) { return t * (1.3 - 0.3 * t); },
     420,
     3,
     [](double s) { return -0.05 + 0.08 * s; },
     [](double s) { return 0.01 - 0.016 * s; },
     [](double s) { return 0.002 * s; },
     [](double s) { return 4 - 9 * s; },
     [](double s) { return 5 * std::sin(4 * s); }},
};

}  // namespace calvin::scenes
