// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Checks what was given, and says in the frame of the known places what the fit has found.

#include "calvin/rig/solve_light.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Core>

#include "calvin/geometry/convex_hull.hpp"
#include "calvin/geometry/dense.hpp"
#include "calvin/rig/light/alignment.hpp"
#include "calvin/rig/light/light_check.hpp"
#include "calvin/rig/light/light_fit.hpp"
#include "calvin/rig/light/light_refinement.hpp"
#include "calvin/rig/light/wand.hpp"
#include "calvin/rig/pose_unknowns.hpp"
#include "calvin/solve/uncertainty.hpp"
#include "calvin/target/kinds.hpp"

namespace calvin {

namespace {

using rig::kPose;

// Says what the fit has found.
class Report {
 public:
  Report(const std::vector<LightCamera>& cameras, const rig::LightFit& fit)
      : cameras_(cameras), fit_(fit), table_(fit.unknowns.table()) {
    if (has_wand()) board_.places = fit.unknowns.wand();
    for (const SE3& pose : fit.state.camera_from_rig) rig_from_camera_.push_back(pose.inverse());
  }

  [[nodiscard]] Result<LightSolution> make(const std::vector<rig::KnownPlace>& places,
                                           double length_sigma) {
    if (!places.empty()) {
      auto alignment = rig::align(rig_from_camera_, places, has_wand(), length_sigma);
      if (!alignment) return tl::unexpected(alignment.error());
      alignment_ = *std::move(alignment);
      solution_.places_rms = alignment_.rms;
    } else if (!has_wand()) {
      set_unit();
    }
    solution_.rig.is_metric = !places.empty() || has_wand();
    if (has_wand()) set_wand();
    to_world();
    set_covariance(places);
    set_errors();
    for (std::size_t c = 0; c < cameras_.size(); ++c) add_camera(c);
    solution_.rig.world = alignment_.is_framed ? kPlacesWorld : cameras_.front().name;
    solution_.scatter = std::sqrt(fit_.scatter);
    solution_.sigma_factor = std::sqrt(fit_.variance);
    set_remarks();
    return std::move(solution_);
  }

 private:
  [[nodiscard]] bool has_wand() const { return fit_.stage == rig::LightStage::kWand; }

  // How long cameras alone see the wand, in its unit.
  void set_wand() {
    LightWandErrors wand;
    wand.places = fit_.unknowns.wand_at(fit_.state.values);
    constexpr double kLeastSigma = 1e-9;  // m
    double weights = 0;
    double squares = 0;
    double sum = 0;
    std::size_t last = fit_.state.points.size();
    for (const auto& one : rig::wand_distances(cameras_, fit_.unknowns, fit_.state)) {
      const double off = one.seen - (wand.places[one.b] - wand.places[one.a]);
      const double weight = 1 / std::pow(std::max(one.sigma, kLeastSigma), 2);
      weights += weight;
      squares += weight * off * off;
      sum += weight * off;
      wand.instants += one.first != last ? 1 : 0;
      last = one.first;
    }
    if (weights > 0) {
      wand.rms = std::sqrt(squares / weights);
      wand.mean = sum / weights;
    }
    solution_.wand = std::move(wand);
  }

  // The fit holds the distance of the farthest camera to first order only: a long way from its
  // start it is 1 no longer.
  void set_unit() {
    double farthest = 0;
    for (const SE3& pose : rig_from_camera_) {
      farthest = std::max(farthest, pose.translation.norm());
    }
    if (farthest > 0) alignment_.world_from_rig.scale = 1 / farthest;
  }

  void to_world() {
    const auto& [scale, motion] = alignment_.world_from_rig;
    for (SE3& pose : rig_from_camera_) {
      pose = {motion.rotation * pose.rotation,
              scale * (motion.rotation * pose.translation) + motion.translation};
    }
    for (const auto& point : fit_.state.points) {
      auto& to = solution_.points.emplace_back();
      if (!point) continue;
      const Eigen::Vector3d at = scale * (motion.rotation * *point) + motion.translation;
      to = {at.x(), at.y(), at.z()};
    }
    solution_.used = fit_.state.used;
  }

  // The unknowns of a camera that were estimated.
  [[nodiscard]] std::vector<int> estimated(std::size_t camera) const {
    std::vector<int> all;
    const ParameterRange range = table_.intrinsics(camera);
    for (int i = range.first; i < range.end(); ++i) {
      if (!fit_.unknowns.is_known()[camera] && fit_.covariance(i, i) > 0) all.push_back(i);
    }
    return all;
  }

  // For R = exp(d) R0 and t = exp(d) t0 + e of camera_from_rig the camera stands at -R^T t, so that
  // turn and place in the rig move by -R0^T of d and e.
  void set_covariance(const std::vector<rig::KnownPlace>& places) {
    constexpr const char* kNames[] = {"rx", "ry", "rz", "tx", "ty", "tz"};
    std::vector<Eigen::Index> first;
    Eigen::MatrixXd by = Eigen::MatrixXd::Zero(
        table_.count() + kPose * static_cast<Eigen::Index>(cameras_.size()), table_.count());
    Eigen::Index row = 0;
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
      for (const int unknown : estimated(c)) {
        by(row++, unknown) = 1;
        solution_.names.push_back(fmt::format("{}.{}", cameras_[c].name, name_of(c, unknown)));
      }
      first.push_back(row);
      const ParameterRange pose = table_.rig_pose(c);
      if (!pose.empty()) {
        const Eigen::Matrix3d back = -rig_from_camera_[c].rotation;
        by.block<3, 3>(row, pose.first) = back;
        by.block<3, 3>(row + 3, pose.first + 3) = alignment_.world_from_rig.scale * back;
      }
      for (const char* name : kNames) {
        solution_.names.push_back(fmt::format("{}.{}", cameras_[c].name, name));
      }
      row += kPose;
    }
    const Eigen::MatrixXd turned = by.topRows(row);
    covariance_ = product(product(turned, fit_.covariance), turned.transpose());
    // A length beside the wand is no frame, and decides nothing.
    if (!places.empty() && (alignment_.is_framed || !has_wand())) {
      covariance_ =
          rig::covariance_by_places(covariance_, first, rig_from_camera_, places, alignment_);
    }
    first_ = std::move(first);
    solution_.covariance = row_major(covariance_);
  }

  [[nodiscard]] std::string_view name_of(std::size_t camera, int unknown) const {
    return parameter_names(
        table_.model(camera))[static_cast<std::size_t>(unknown - table_.intrinsics(camera).first)];
  }

  void set_errors() {
    const auto models = fit_.unknowns.cameras(fit_.state.values);
    double sum = 0;
    double squares = 0;
    double count = 0;
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
      LightCameraErrors own;
      double own_squares = 0;
      for (std::size_t i = 0; i < cameras_[c].seen.size(); ++i) {
        own.seen += cameras_[c].seen[i] ? 1 : 0;
        if (!fit_.state.used[c][i]) continue;
        const double off = rig::distance(cameras_[c], i, (*models)[c], fit_.state, c).value_or(0);
        ++own.used;
        own.mean += off;
        own_squares += off * off;
      }
      const double used = std::max<double>(1, static_cast<double>(own.used));
      sum += own.mean;
      squares += own_squares;
      count += used;
      own.mean /= used;
      own.rms = std::sqrt(own_squares / used);
      solution_.errors.push_back(own);
    }
    solution_.mean_error = sum / count;
    solution_.rig.rms = std::sqrt(squares / count);
  }

  [[nodiscard]] Calibration calibration_of(std::size_t c) const {
    if (cameras_[c].calibration) return *cameras_[c].calibration;
    Calibration found;
    found.image_size = cameras_[c].image_size;
    found.model = table_.model(c);
    found.board = board_.text();
    found.rms = solution_.errors[c].rms;
    const std::vector<int> free = estimated(c);
    const ParameterRange range = table_.intrinsics(c);
    for (int i = range.first; i < range.end(); ++i) {
      Parameter parameter{std::string(name_of(c, i)),
                          fit_.state.values[static_cast<std::size_t>(i)], std::nullopt};
      if (std::ranges::find(free, i) != free.end()) {
        parameter.sigma = std::sqrt(fit_.covariance(i, i));
      }
      found.parameters.push_back(std::move(parameter));
    }
    for (const int i : free) {
      for (const int j : free) found.covariance.push_back(fit_.covariance(i, j));
    }
    std::vector<Pixel> used;
    for (std::size_t i = 0; i < cameras_[c].seen.size(); ++i) {
      if (fit_.state.used[c][i]) used.push_back(cameras_[c].seen[i]->uv);
    }
    found.covered = convex_hull(std::move(used));
    found.expected_error = expected_error(found);
    found.expected_error_anywhere = expected_error_anywhere(found);
    return found;
  }

  void add_camera(std::size_t c) {
    RigCamera camera;
    camera.calibration = calibration_of(c);
    camera.calibration.camera = cameras_[c].name;
    camera.rig_from_camera = to_pose(rig_from_camera_[c]);
    for (double& x : camera.rig_from_camera.translation) x += 0.0;  // no -0 of the first camera
    camera.rms = solution_.errors[c].rms;
    const Eigen::MatrixXd own = covariance_.block(first_[c], first_[c], kPose, kPose);
    if (!own.isZero(0)) camera.covariance = row_major(own);
    solution_.rig.cameras.push_back(std::move(camera));
  }

  void set_remarks() {
    constexpr double kManyRefused = 0.3;
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
      const LightCameraErrors& own = solution_.errors[c];
      const auto refused = static_cast<double>(own.seen - own.used);
      if (refused <= kManyRefused * static_cast<double>(own.seen)) continue;
      solution_.remarks.push_back(fmt::format(
          "Of what '{}' has seen, {:.0f} % fit no place of the light: look for reflections, other "
          "lights and a clock that runs apart.",
          cameras_[c].name, 100 * refused / static_cast<double>(own.seen)));
    }
    if (solution_.scatter > 1) {
      solution_.remarks.push_back(fmt::format(
          "Stretches of time contradict each other {:.1f} times as much as sightings scatter, and "
          "errors are enlarged by that: look for clocks that run apart, a light that is no point, "
          "and a lens of too few coefficients.",
          solution_.scatter));
    }
    if (has_wand()) add_wand_remarks();
    if (solution_.rig.is_metric) return;
    solution_.remarks.emplace_back(
        "Lengths have no unit: 1 is the distance between the first camera and the one farthest "
        "from it. The places of two cameras give the unit, those of three the frame, and a wand "
        "of two lights at a known distance gives the unit too.");
  }

  void add_wand_remarks() {
    constexpr double kFar = 4;       // sigmas
    constexpr double kAlike = 0.01;  // of a length: places are read off a tape
    const double sigma = fit_.unknowns.wand_sigma();
    for (std::size_t k = 1; k < solution_.wand->places.size(); ++k) {
      const double known = fit_.unknowns.wand()[k];
      if (std::abs(solution_.wand->places[k] - known) <= kFar * sigma) continue;
      solution_.remarks.push_back(fmt::format(
          "Beside the others light {} of the wand is {:.2f} mm along it, not {:.2f} mm, which was "
          "said to be known to {:.2g} mm: measure the wand, or give a larger sigma.",
          k, 1e3 * solution_.wand->places[k], 1e3 * known, 1e3 * sigma));
    }
    const auto by_places = alignment_.scale_by_places;
    if (!by_places) return;
    // How well the wand is known, and how well the places fit.
    const double of_wand = sigma / fit_.unknowns.wand().back();
    const double off = std::abs(by_places->scale - 1);
    if (off <= std::max(kAlike, kFar * std::hypot(of_wand, by_places->sigma))) return;
    const double length = 1e3 * fit_.unknowns.wand().back();
    solution_.remarks.push_back(
        fmt::format("By the known places of the cameras the wand is {:.1f} mm long, not {:.1f} mm: "
                    "measure both. The rig has the unit of the wand.",
                    by_places->scale * length, length));
  }

  const std::vector<LightCamera>& cameras_;
  const rig::LightFit& fit_;
  const ParameterTable& table_;
  PointLight board_;
  std::vector<SE3> rig_from_camera_;  // of the world, after to_world()
  rig::Alignment alignment_;
  std::vector<Eigen::Index> first_;  // of each camera's turn and place among the names
  Eigen::MatrixXd covariance_;
  LightSolution solution_;
};

}  // namespace

Status check(const LightOptions& options) {
  if (const Status wand = rig::check_wand(options); !wand) return wand;
  const LightCamera any{"camera", {640, 480}, std::nullopt, {}};
  const auto unknowns = rig::LightUnknowns::make({any}, options);
  return unknowns ? Status() : tl::unexpected(unknowns.error());
}

Result<LightSolution> solve_light(const std::vector<LightCamera>& cameras,
                                  const LightOptions& options, std::stop_token stop) {
  if (const Status wand = rig::check_wand(options); !wand) return tl::unexpected(wand.error());
  const std::size_t lights = std::max<std::size_t>(options.wand.size(), 1);
  if (const Status sound = rig::check(cameras, lights); !sound)
    return tl::unexpected(sound.error());
  const auto places = rig::known_places(cameras, options.places);
  if (!places) return tl::unexpected(places.error());
  try {
    const auto fit = rig::fit_light(cameras, options, stop);
    if (!fit) return tl::unexpected(fit.error());
    return Report(cameras, *fit).make(*places, options.length_sigma);
  } catch (const std::exception&) {
    return make_error(ErrorCode::kDegenerate,
                      "There is no memory for so many instants: take fewer.");
  }
}

}  // namespace calvin
