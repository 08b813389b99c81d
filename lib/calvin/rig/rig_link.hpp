// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// RigLink: what is said of two cameras of a rig. Data only.
#pragma once

#include <cstddef>
#include <optional>

namespace calvin {

// What two cameras have in common.
struct RigLink {
  std::size_t a = 0;  // cameras of the rig, a < b
  std::size_t b = 0;
  std::size_t views = 0;  // boards that both have seen at one time
  std::size_t agree = 0;  // of them, those that agree with where the cameras stand
  double distance = 0;    // m, between the cameras
  double distance_sigma = 0;
  double angle = 0;  // rad, between the optical axes
  // Of the distances between corners that both cameras have seen, by their rays, to those on the
  // board: the mean of the ratio less 1, and the root mean square of what is left, m. Absent where
  // rays are too nearly parallel.
  std::optional<double> bias;
  std::optional<double> spread;
  // px: how far corners are from the rows of each other in rectified pictures, root mean square.
  // Absent where no common view is in use.
  std::optional<double> epipolar_error;
};

}  // namespace calvin
