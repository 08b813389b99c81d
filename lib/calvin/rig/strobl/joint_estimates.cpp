// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The unknowns of the fit to first order as the numbers of files, and what of them is determined.

#include "calvin/rig/strobl/joint_estimates.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "calvin/camera/camera.hpp"
#include "calvin/core/text.hpp"
#include "calvin/geometry/convex_hull.hpp"
#include "calvin/geometry/dense.hpp"
#include "calvin/rig/hand_eye/report.hpp"
#include "calvin/rig/pose_unknowns.hpp"
#include "calvin/solve/judge/projection_error.hpp"

namespace calvin::rig {

namespace {

constexpr std::array<std::string_view, 6> kPoseNames = {"rx", "ry", "rz", "tx", "ty", "tz"};
// Rows of estimates by the unknowns of the fit.
class Rows {
 public:
  Rows(Eigen::Index unknowns, std::vector<std::string>& names)
      : names_(names), rows_(Eigen::MatrixXd::Zero(0, unknowns)) {}

  // As many further rows, whose names begin with `owner`.
  template <typename Names>
  ParameterRange add(const std::string& owner, const Names& names) {
    const ParameterRange range = {static_cast<int>(names_.size()), static_cast<int>(names.size())};
    for (const auto& name : names) names_.push_back(owner + std::string(name));
    rows_.conservativeResize(range.end(), Eigen::NoChange);
    rows_.bottomRows(range.count).setZero();
    return range;
  }
  // The rows that are unknowns from `first` on as they are.
  void set_equal(ParameterRange range, int first) {
    rows_.block(range.first, first, range.count, range.count).setIdentity();
  }
  template <int kRows, int kColumns>
  void set(int row, int column, const Eigen::Matrix<double, kRows, kColumns>& values) {
    rows_.block<kRows, kColumns>(row, column) = values;
  }
  [[nodiscard]] const Eigen::MatrixXd& all() const { return rows_; }

 private:
  std::vector<std::string>& names_;
  Eigen::MatrixXd rows_;
};

double sigma_of(const JointEstimates& estimates, int row) {
  return std::sqrt(estimates.covariance(row, row));
}

std::vector<double> block_of(const JointEstimates& estimates, ParameterRange range) {
  return row_major(estimates.covariance.block(range.first, range.first, range.count, range.count));
}

// Corners of the loops in use that a camera has seen.
std::vector<Pixel> corners_of(const HandEyeFit& fit, const std::vector<LoopView>& loops,
                              std::size_t camera) {
  std::vector<Pixel> corners;
  for (std::size_t v = 0; v < loops.size(); ++v) {
    for (const SeenBoard& seen : loops[v].seen) {
      if (!fit.used[v] || seen.view->of.camera != camera) continue;
      const PointSet& points = seen.view->seen;
      for (std::size_t i = 0; i < points.size(); ++i) {
        if (points.weight[i] > 0) corners.push_back(points.uv[i]);
      }
    }
  }
  return corners;
}

Calibration calibration_of(const HandEyeFit& fit, const JointEstimates& estimates,
                           const Calibration& known, std::size_t camera) {
  Calibration found = fit.mounted.cameras[camera].to_calibration();
  const ParameterRange rows = estimates.intrinsics[camera];
  for (int i = 0; i < rows.count; ++i) {
    found.parameters[static_cast<std::size_t>(i)].sigma = sigma_of(estimates, rows[i]);
  }
  found.covariance = block_of(estimates, rows);
  found.camera = known.camera;
  found.sensor_crop = known.sensor_crop;
  found.device = known.device;
  found.focus = known.focus;
  found.zoom = known.zoom;
  found.rms = fit.rms.of_cameras[camera];
  return found;
}

tl::unexpected<Error> undetermined(std::string what) {
  return make_error(ErrorCode::kDegenerate, std::move(what));
}

Status check_camera(const Camera& camera, const JointEstimates& estimates, ParameterRange rows,
                    const std::string& name) {
  constexpr double kWorstFocal = 0.1;   // sigma, of the focal length
  constexpr double kWorstCenter = 0.1;  // of the width of the image
  for (int i = 0; i < 2; ++i) {
    const double f = camera.parameters()[static_cast<std::size_t>(i)];
    if (!(sigma_of(estimates, rows[i]) < kWorstFocal * f)) {
      return undetermined(
          fmt::format("The views do not determine the focal length of '{}' ({:.0f} +- {} px): the "
                      "board is too nearly parallel to the image. Tilt it, or turn the hand, by 20 "
                      "to 45 degrees to all sides.",
                      name, f, two_digits(sigma_of(estimates, rows[i]))));
    }
    const double center = sigma_of(estimates, rows[2 + i]);
    if (!(center < kWorstCenter * camera.image_size().width)) {
      return undetermined(
          fmt::format("The views do not determine the principal point of '{}' (+- {} px): the "
                      "board is always tilted the same way. Tilt it, or turn the hand, to all "
                      "sides.",
                      name, two_digits(center)));
    }
  }
  return {};
}

}  // namespace

JointEstimates joint_estimates(const HandEyeFit& fit, const HandEyeTask& task,
                               const std::vector<std::string>& names) {
  JointEstimates all;
  const ParameterTable& table = fit.table;
  Rows rows(fit.covariance.rows(), all.names);
  const int scale = table.count() + kScaleColumn;
  for (std::size_t c = 0; c < table.cameras(); ++c) {
    all.intrinsics.push_back(rows.add(names[c] + ".", parameter_names(table.model(c))));
    rows.set_equal(all.intrinsics[c], table.intrinsics(c).first);
  }
  all.places.emplace_back();
  for (std::size_t c = 1; c < table.cameras(); ++c) {
    // For R = exp(d) R0 and t = exp(d) t0 + e the camera stands at -s R^T t: it turns by -R0^T d
    // and moves by -s R0^T e, and with the scale s.
    const SE3 first_from_camera = fit.mounted.camera_from_first[c].inverse();
    const int from = table.rig_pose(c).first;
    const ParameterRange at = rows.add(names[c] + ".", kPoseNames);
    all.places.push_back(at);
    rows.set<3, 3>(at[0], from, -first_from_camera.rotation);
    rows.set<3, 3>(at[3], from + 3, -fit.places.scale * first_from_camera.rotation);
    rows.set<3, 1>(at[3], scale, first_from_camera.translation);
  }
  rows.set_equal(rows.add("mount.", kPoseNames), table.count() + kMountColumn);
  rows.set_equal(rows.add("carrier.", kPoseNames), table.count() + kCarrierColumn);
  if (task.free_scale) {
    all.scale = rows.add("", std::array{"scale"});
    rows.set_equal(all.scale, scale);
  }
  if (task.free_aspect) {
    all.aspect = rows.add("", std::array{"aspect"});
    rows.set_equal(all.aspect, table.aspect(0).first);
  }
  all.covariance = congruent(fit.covariance, rows.all().transpose());
  return all;
}

std::vector<Calibration> joint_calibrations(const HandEyeFit& fit, const JointEstimates& estimates,
                                            const std::vector<LoopView>& loops,
                                            const std::vector<Calibration>& known,
                                            const std::string& board) {
  std::vector<Calibration> all;
  for (std::size_t c = 0; c < known.size(); ++c) {
    Calibration found = calibration_of(fit, estimates, known[c], c);
    found.board = board;
    found.covered = convex_hull(corners_of(fit, loops, c));
    if (const auto promise = promise_of(found)) {
      found.expected_error = promise->covered;
      found.expected_error_anywhere = promise->anywhere;
      found.worst_place = promise->worst;
    }
    all.push_back(std::move(found));
  }
  return all;
}

Rig joint_rig(const HandEyeFit& fit, const JointEstimates& estimates,
              const std::vector<Calibration>& calibrations) {
  Rig rig;
  rig.world = calibrations.front().camera;
  rig.rms = fit.rms.all;
  for (std::size_t c = 0; c < calibrations.size(); ++c) {
    RigCamera camera;
    camera.calibration = calibrations[c];
    camera.rms = fit.rms.of_cameras[c];
    if (c > 0) {
      SE3 place = fit.mounted.camera_from_first[c].inverse();
      place.translation *= fit.places.scale;
      camera.rig_from_camera = to_pose(place);
      camera.covariance = block_of(estimates, estimates.places[c]);
    }
    rig.cameras.push_back(std::move(camera));
  }
  return rig;
}

Status check_determined(const HandEyeFit& fit, const JointEstimates& estimates,
                        const std::vector<std::string>& names) {
  // A ruler, and what printers are known for, say more than sigmas of these.
  constexpr double kWorstScale = 0.01;
  constexpr double kWorstAspect = 0.005;
  for (std::size_t c = 0; c < names.size(); ++c) {
    Status good =
        check_camera(fit.mounted.cameras[c], estimates, estimates.intrinsics[c], names[c]);
    if (!good) return good;
  }
  if (!estimates.scale.empty()) {
    const double sigma = sigma_of(estimates, estimates.scale.first) / fit.places.scale;
    if (!(sigma < kWorstScale)) {
      return undetermined(
          fmt::format("The motions of the robot tell the size of the board to {} % only: move the "
                      "hand farther between the pictures, or measure the board and hold its "
                      "pitch.",
                      two_digits(100 * sigma)));
    }
  }
  if (!estimates.aspect.empty()) {
    const double sigma = sigma_of(estimates, estimates.aspect.first);
    if (!(sigma < kWorstAspect)) {
      return undetermined(
          fmt::format("The pictures tell the aspect of the board to {} % only: turn the board, or "
                      "the hand, about the optical axis by 90 degrees in some of them, tilt it to "
                      "all sides, or measure the board and hold its aspect.",
                      two_digits(100 * sigma)));
    }
  }
  return {};
}

}  // namespace calvin::rig
