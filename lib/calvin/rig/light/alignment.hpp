// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Cameras up to scale where they are known to stand. Internal.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/result.hpp"
#include "calvin/geometry/se3.hpp"

namespace calvin::rig {

struct KnownPlace {
  std::size_t camera = 0;
  Eigen::Vector3d place;  // m, world
};

// world = scale * rotation * rig + translation
struct Similarity {
  double scale = 1;
  SE3 motion;
};

struct Alignment {
  Similarity world_from_rig;
  bool is_framed = false;  // by three places or more; else by a length alone, and the frame stays
  std::optional<double> rms;  // m, of what is left of three known places or more
  double length_sigma = 0;    // m, of the distance between two
  // Of a rig that has its unit: how much larger it is by the places, and how well they tell that by
  // how well they fit.
  struct ScaleByPlaces {
    double scale = 1;
    double sigma = 0;
  };
  std::optional<ScaleByPlaces> scale_by_places;
};

// `length_sigma`, m: how well the distance between two places is known. Where `has_unit` the rig
// does not grow: the places give its frame, and two of them nothing. By least squares (S. Umeyama,
// PAMI 13(4), 1991). kDegenerate where three places or more lie on one line or two are the same;
// kInvalidArgument where they fit as their own mirror image alone, or, beside a unit, as lengths in
// mm, cm or inches.
[[nodiscard]] Result<Alignment> align(const std::vector<SE3>& rig_from_camera,
                                      const std::vector<KnownPlace>& places, bool has_unit = false,
                                      double length_sigma = 0);

// The covariance of turns and places of all cameras about the axes of the world, in which the known
// places decide what is not known of the rig as a whole. `covariance` is that before, over numbers
// of which those of camera c are its turn (3) and its place (3) from `first[c]` on, in the frame
// and unit of the world already; `world_from_camera` are in that frame too. Where places decide
// less than a frame it is changed as far as they do.
[[nodiscard]] Eigen::MatrixXd covariance_by_places(const Eigen::MatrixXd& covariance,
                                                   const std::vector<Eigen::Index>& first,
                                                   const std::vector<SE3>& world_from_camera,
                                                   const std::vector<KnownPlace>& places,
                                                   const Alignment& alignment);

}  // namespace calvin::rig
