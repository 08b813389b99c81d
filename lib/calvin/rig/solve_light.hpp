// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Cameras calibrated by one light, or by a wand of lights, that is moved before them: their
// intrinsics and where they stand.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "calvin/core/result.hpp"
#include "calvin/core/rig.hpp"
#include "calvin/rig/light_camera.hpp"

namespace calvin {

struct LightCameraErrors {
  std::size_t seen = 0;  // instants
  std::size_t used = 0;  // of them, those that are no reflections
  double rms = 0;        // px, of those that are used
  double mean = 0;       // px, of their distances
};

// What a wand of known lengths came to.
struct LightWandErrors {
  std::size_t instants = 0;  // at which two lights or more are used
  // Of distances of its lights by the rays of cameras alone, less those on the wand, each by how
  // well the rays tell it.
  double rms = 0;              // m
  double mean = 0;             // m
  std::vector<double> places;  // m, of the lights along it, as the solve has them
};

struct LightSolution {
  // In metres by LightOptions::wand or places; without both it is not metric. The calibrations have
  // sigmas, covariance and the promise; a calibration that was given is there as it was.
  Rig rig;
  // Of the light, rig, per instant; of a wand per instant and light, as LightCamera::seen.
  std::vector<std::optional<std::array<double, 3>>> points;
  std::vector<std::vector<bool>> used;    // per camera and of these
  std::vector<LightCameraErrors> errors;  // per camera
  double mean_error = 0;                  // px, of all distances
  // How far stretches of time contradict each other, in the errors of independent sightings; by
  // this all sigmas are enlarged where it is more than 1.
  double scatter = 1;
  double sigma_factor = 1;  // what sightings are off by, over their sigmas
  // The joint covariance, row-major, over the numbers that `names` lists: of each camera the
  // intrinsics that were estimated ("cam0.fx"), then how far it is turned about the axes of the rig
  // (rad) and where it stands in it ("cam0.rx" ... "cam0.tz"), as RigCamera::covariance.
  std::vector<std::string> names;
  std::vector<double> covariance;
  std::optional<double> places_rms;     // m, from the places that were known
  std::optional<LightWandErrors> wand;  // where there was one
  std::vector<std::string> remarks;     // sentences for the user
};

// Whether `model`, `fix` and `center_sigma` are ones that a solve takes; errors are those of it.
[[nodiscard]] Status check(const LightOptions& options);

// Svoboda, Martinec, Pajdla, A Convenient Multicamera Self-Calibration for Virtual Environments,
// Presence 14(4), 2005, in one least squares: docs/methods.md. With a wand its lights are a rigid
// line at each instant, and the rig has its unit. No intrinsics have to be known where
// three cameras or more see the light at a time; with those of all cameras two are enough. The same
// sightings give the same numbers.
// kInvalidArgument for lists that do not fit together, names that are missing or there twice and
// sightings outside of the pictures; kDegenerate where too little was seen, the light stayed in a
// plane, a camera shares too little with the others or is mirrored, known places lie on a line or
// are mirrored, the lights of a wand are seldom seen together or not as far apart as was said:
// the message says what to do.
[[nodiscard]] Result<LightSolution> solve_light(const std::vector<LightCamera>& cameras,
                                                const LightOptions& options = {},
                                                std::stop_token stop = {});

}  // namespace calvin
