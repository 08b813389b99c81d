// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Checks what was given, and says in the frame of the known places what the fit has found.

#include "calvin/rig/solve_light.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Core>

#include "calvin/core/text.hpp"
#include "calvin/geometry/convex_hull.hpp"
#include "calvin/geometry/dense.hpp"
#include "calvin/rig/light/alignment.hpp"
#include "calvin/rig/light/light_fit.hpp"
#include "calvin/rig/light/light_refinement.hpp"
#include "calvin/solve/uncertainty.hpp"
#include "calvin/solve/view.hpp"
#include "calvin/target/kinds.hpp"

namespace calvin {

namespace {

constexpr std::size_t kFewestInstants = 20;  // as the original asks for
constexpr Eigen::Index kPose = 6;

tl::unexpected<Error> invalid(std::string message) {
  return make_error(ErrorCode::kInvalidArgument, std::move(message));
}

Status check_camera(const LightCamera& camera, std::size_t instants) {
  if (const Status size = check_image_size(camera.image_size); !size) return size;
  if (camera.seen.size() != instants) {
    return invalid(
        fmt::format("The camera '{}' has {} instants, the first one {}: give all of "
                    "them the same, and nothing where a light was not seen.",
                    camera.name, camera.seen.size(), instants));
  }
  const auto is_outside = [](double at, int length) {
    constexpr double kTolerated = 0.05;  // of the picture, as of a view
    return !(at >= -kTolerated * length && at <= (1 + kTolerated) * length);
  };
  for (const auto& seen : camera.seen) {
    if (!seen) continue;
    if (is_outside(seen->uv.u, camera.image_size.width) ||
        is_outside(seen->uv.v, camera.image_size.height)) {
      return invalid(fmt::format(
          "The camera '{}' has the light at ({:.1f}, {:.1f}), outside of its "
          "picture of {}x{} px.",
          camera.name, seen->uv.u, seen->uv.v, camera.image_size.width, camera.image_size.height));
    }
    if (!is_known_sigma(seen->sigma)) {
      return invalid(fmt::format("The camera '{}' has a sigma of {} px: it is 1e-6 to 1e6.",
                                 camera.name, seen->sigma));
    }
  }
  return {};
}

Status check_counts(const std::vector<LightCamera>& cameras) {
  const bool all_known =
      std::ranges::all_of(cameras, [](const LightCamera& c) { return c.calibration.has_value(); });
  const std::size_t least = all_known ? 2 : 3;
  if (cameras.size() < least) {
    return make_error(
        ErrorCode::kDegenerate,
        fmt::format("{} cameras do not tell their focal lengths by a light: three are "
                    "needed, or two of which both calibrations are given.",
                    cameras.size()));
  }
  std::size_t enough = 0;
  for (std::size_t i = 0; i < cameras.front().seen.size(); ++i) {
    const auto rays =
        std::ranges::count_if(cameras, [&](const LightCamera& c) { return c.seen[i].has_value(); });
    enough += rays >= static_cast<std::ptrdiff_t>(least) ? 1 : 0;
  }
  if (enough >= kFewestInstants) return {};
  return make_error(ErrorCode::kDegenerate,
                    fmt::format("The light was seen by {} cameras at a time at {} instants, and {} "
                                "are the fewest: move it for a minute where their pictures "
                                "overlap, and see that their clocks agree.",
                                least, enough, kFewestInstants));
}

Status check(const std::vector<LightCamera>& cameras) {
  std::set<std::string> names;
  for (const LightCamera& camera : cameras) {
    if (camera.name.empty() || !names.insert(camera.name).second) {
      return invalid(fmt::format("Two cameras are called '{}', or have no name: give each its own.",
                                 camera.name));
    }
    if (const Status own = check_camera(camera, cameras.front().seen.size()); !own) return own;
  }
  return check_counts(cameras);
}

Result<std::vector<rig::KnownPlace>> known_places(const std::vector<LightCamera>& cameras,
                                                  const std::vector<CameraPlace>& places) {
  std::vector<rig::KnownPlace> known;
  std::set<std::string> names;
  for (const CameraPlace& place : places) {
    const auto camera = std::ranges::find(cameras, place.camera, &LightCamera::name);
    if (camera == cameras.end() || !names.insert(place.camera).second) {
      std::vector<std::string> all;
      for (const LightCamera& one : cameras) all.push_back(one.name);
      return invalid(
          fmt::format("A known place is that of '{}', which is no camera or has another "
                      "place: the cameras are '{}'.",
                      place.camera, join(all, "', '")));
    }
    const Eigen::Vector3d at(place.place[0], place.place[1], place.place[2]);
    if (!at.allFinite()) return invalid("A known place is not finite.");
    known.push_back({static_cast<std::size_t>(camera - cameras.begin()), at});
  }
  if (known.size() == 1) {
    return invalid(
        "The place of one camera tells nothing of the others: give two for the unit, "
        "three or more for the frame.");
  }
  return known;
}

std::vector<double> row_major(const Eigen::MatrixXd& matrix) {
  std::vector<double> all;
  for (Eigen::Index r = 0; r < matrix.rows(); ++r) {
    for (Eigen::Index c = 0; c < matrix.cols(); ++c) all.push_back(matrix(r, c));
  }
  return all;
}

// Says what the fit has found.
class Report {
 public:
  Report(const std::vector<LightCamera>& cameras, const rig::LightFit& fit)
      : cameras_(cameras), fit_(fit), table_(fit.unknowns.table()) {
    for (const SE3& pose : fit.state.camera_from_rig) rig_from_camera_.push_back(pose.inverse());
  }

  [[nodiscard]] Result<LightSolution> make(const std::vector<rig::KnownPlace>& places) {
    if (!places.empty()) {
      auto alignment = rig::align(rig_from_camera_, places);
      if (!alignment) return tl::unexpected(alignment.error());
      alignment_ = *std::move(alignment);
      solution_.places_rms = alignment_.rms;
    } else {
      set_unit();
    }
    solution_.rig.is_metric = !places.empty();
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
    if (!places.empty()) {
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
    found.board = PointLight().text();
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
    if (solution_.rig.is_metric) return;
    solution_.remarks.emplace_back(
        "Lengths have no unit: 1 is the distance between the first camera and the one farthest "
        "from it. The places of two cameras give the unit, those of three the frame.");
  }

  const std::vector<LightCamera>& cameras_;
  const rig::LightFit& fit_;
  const ParameterTable& table_;
  std::vector<SE3> rig_from_camera_;  // of the world, after to_world()
  rig::Alignment alignment_;
  std::vector<Eigen::Index> first_;  // of each camera's turn and place among the names
  Eigen::MatrixXd covariance_;
  LightSolution solution_;
};

}  // namespace

Status check(const LightOptions& options) {
  const LightCamera any{"camera", {640, 480}, std::nullopt, {}};
  const auto unknowns = rig::LightUnknowns::make({any}, options);
  return unknowns ? Status() : tl::unexpected(unknowns.error());
}

Result<LightSolution> solve_light(const std::vector<LightCamera>& cameras,
                                  const LightOptions& options, std::stop_token stop) {
  if (cameras.empty()) return invalid("Cameras have to be given.");
  if (const Status sound = check(cameras); !sound) return tl::unexpected(sound.error());
  const auto places = known_places(cameras, options.places);
  if (!places) return tl::unexpected(places.error());
  try {
    const auto fit = rig::fit_light(cameras, options, stop);
    if (!fit) return tl::unexpected(fit.error());
    return Report(cameras, *fit).make(*places);
  } catch (const std::exception&) {
    return make_error(ErrorCode::kDegenerate,
                      "There is no memory for so many instants: take fewer.");
  }
}

}  // namespace calvin
