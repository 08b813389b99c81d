// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What cameras have seen of one light, or of the lights of a wand, that are moved before them, and
// what is known beforehand.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calvin/core/calibration.hpp"
#include "calvin/core/image.hpp"
#include "calvin/core/observation.hpp"
#include "calvin/core/result.hpp"
#include "calvin/core/rig.hpp"

namespace calvin {

// Where the light was in a picture.
struct LightPoint {
  Pixel uv;
  double sigma = 1;  // px, per coordinate
};

struct LightCamera {
  std::string name;
  ImageSize image_size;
  // The intrinsics, where they are known: then only its place is found.
  std::optional<Calibration> calibration;
  // By instant; absent where the light was not seen. All cameras have as many. Of a wand of n
  // lights light k at instant i is number n i + k.
  std::vector<std::optional<LightPoint>> seen;
};

struct LightCameras {
  std::vector<LightCamera> cameras;  // by name
  std::uint64_t farthest = 0;        // ns, between two pictures of one instant, at the most
  std::size_t left_out = 0;          // observations of several points, of which one is the light
  std::size_t lights = 1;            // of each instant
};

// What was seen of a light, by camera and by instant: pictures at most `tolerance` ns apart are of
// one. Where velocities are known, the light is taken back to where it was when the first picture
// was taken, and what may be wrong with that is a part of its sigma. Instants at which one camera
// alone has seen it are left out, as they say nothing. Of a wand `lights` says how many it has, and
// ids are their numbers; of one light an observation has one point, whatever its id.
// kInvalidArgument where a camera has pictures of several sizes, or an id is none of a wand's.
[[nodiscard]] Result<LightCameras> light_cameras(const std::vector<Observation>& seen,
                                                 std::uint64_t tolerance, std::size_t lights = 1);

// m, of a wand whose lights were measured from middle to middle by a caliper or a good rule.
inline constexpr double kDefaultWandSigma = 0.0002;

struct LightOptions {
  // The lens of cameras without a calibration, one that is a pinhole where its coefficients are 0.
  std::string model = "brown4";
  // What is held of these cameras: coefficients at 0, "cx", "cy" or "center" at the middle of the
  // picture; "aspect" holds fy = fx.
  std::vector<std::string> fix = {"aspect", "p1", "p2"};
  // How far the axis may be from the middle of the picture, 1 sigma, of its width; it counts as a
  // measurement. Square pixels tell focal lengths by themselves from four cameras on (M. Pollefeys,
  // R. Koch, L. Van Gool, IJCV 32(1), 1999: 2 n >= 8), and weakly so of few. 0: nothing is known.
  double center_sigma = 0.03;
  // Three or more that are on no line give the frame of the rig and its unit; two, the distance
  // between them, give the unit alone. Without any, the first camera is the rig, and the distance
  // of the camera that is farthest from it is 1. With a wand the unit is that of the wand.
  std::vector<CameraPlace> places;
  // m, 1 sigma: how well the distance between two places is known, where these give the unit. How
  // well three or more are known is told by how well they fit.
  double length_sigma = 0;
  // Of a wand with several lights on a line: where each is along it, m, rising from 0. Empty: one
  // light.
  std::vector<double> wand;
  // How well the place of each light but the first is known, m, 1 sigma; 0: exactly. It is one
  // error for all instants, so that no number of them makes the unit better known than the wand.
  double wand_sigma = kDefaultWandSigma;
};

// The distance between two cameras by name gives the unit, or is held against that of a wand.
void set_known_distance(const CameraBaseline& known, LightOptions& options);

}  // namespace calvin
