// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The cameras before a light as unknowns of a table, at a stage of the solve. Internal.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/core/result.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/rig/light/euclidean.hpp"
#include "calvin/rig/light_camera.hpp"
#include "calvin/solve/parameters/parameter_table.hpp"

namespace calvin::rig {

// Which intrinsics of cameras without a calibration move.
enum class LightStage {
  kFocal,  // one focal length
  kLens,   // and the coefficients of the lens
  kAll,    // all that `fix` leaves
  kWand,   // these, the lights of each instant on one wand, and the unit with them
};

// The solve so far.
struct LightState {
  std::vector<double> values;                          // of the table
  std::vector<SE3> camera_from_rig;                    // the first camera is the rig
  std::vector<std::optional<Eigen::Vector3d>> points;  // per instant and light of a wand, rig
  std::vector<std::vector<bool>> used;                 // per camera and instant
  double noise = 1;                                    // of the sightings, in their sigmas
};

class LightUnknowns {
 public:
  // kInvalidArgument or kUnsupported where model, words of `fix` or calibrations are wrong.
  [[nodiscard]] static Result<LightUnknowns> make(const std::vector<LightCamera>& cameras,
                                                  const LightOptions& options);

  [[nodiscard]] const ParameterTable& table() const { return table_; }
  [[nodiscard]] const std::vector<bool>& is_known() const { return known_; }
  // The table with what moves at this stage.
  [[nodiscard]] ParameterTable at(LightStage stage) const;

  // Lights of a wand at each instant, and where they are along it, m; 1 and nothing without a wand.
  [[nodiscard]] std::size_t lights() const { return std::max<std::size_t>(wand_.size(), 1); }
  [[nodiscard]] const std::vector<double>& wand() const { return wand_; }
  [[nodiscard]] double wand_sigma() const { return wand_sigma_; }
  // The same as far as the solve has found it.
  [[nodiscard]] std::vector<double> wand_at(const std::vector<double>& values) const;

  // What is known of the axes of cameras without a calibration, and of a wand where its lights are
  // unknowns, in a table of at(). The covariance
  // of a solve is multiplied by the variance of the sightings: measurements that do not share in
  // that have their sigmas over `noise`.
  [[nodiscard]] std::vector<ParameterTable::Prior> priors(const ParameterTable& table,
                                                          double noise) const;

  // The directions that are free in at(stage). Without a wand that is not the one along which the
  // whole rig grows: the distance between the first camera and `scale_camera` does not change.
  [[nodiscard]] Eigen::MatrixXd basis(LightStage stage, const LightState& state) const;
  // The camera that is farthest from the first.
  [[nodiscard]] static std::size_t scale_camera(const LightState& state);

  // px of a unit of the coordinates from which a solve starts.
  [[nodiscard]] double start_scale(std::size_t camera) const { return scale_[camera]; }
  // What was seen in these coordinates, without what a known camera cannot have seen.
  [[nodiscard]] Tracks start_tracks(const std::vector<LightCamera>& cameras) const;
  // The intrinsics at the start.
  [[nodiscard]] std::vector<double> start_values(const std::vector<double>& focal) const;

  // Absent where the numbers make no camera.
  [[nodiscard]] std::optional<std::vector<Camera>> cameras(const std::vector<double>& values) const;

 private:
  [[nodiscard]] Status hold(std::size_t camera, std::string_view word);

  std::vector<ImageSize> sizes_;
  double center_sigma_ = 0;  // of the width; 0: nothing is known
  std::vector<bool> known_;
  std::vector<std::optional<Camera>> given_;
  std::vector<double> scale_;
  std::vector<double> wand_;  // m
  double wand_sigma_ = 0;     // m
  ParameterTable table_;
};

}  // namespace calvin::rig
