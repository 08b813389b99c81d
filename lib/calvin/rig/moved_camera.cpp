// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Solves a rig by the earlier and by the later half of its instants, and compares.

#include "calvin/rig/moved_camera.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include <fmt/format.h>
#include <Eigen/Cholesky>

#include "calvin/core/text.hpp"
#include "calvin/geometry/se3.hpp"

namespace calvin {

namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

// The views of all cameras before, or from, a time on.
std::vector<RigCameraViews> part_of(const std::vector<RigCameraViews>& seen, std::uint64_t at,
                                    bool is_later) {
  std::vector<RigCameraViews> part;
  for (const RigCameraViews& camera : seen) {
    RigCameraViews& of = part.emplace_back();
    of.calibration = camera.calibration;
    for (const View& view : camera.views) {
      if ((view.observation.timestamp >= at) == is_later) of.views.push_back(view);
    }
  }
  return part;
}

struct Change {
  double square = 0;  // in units of the covariance, per number
  double place = 0;   // m
  double turn = 0;    // rad
};

Change change_between(const RigCamera& before, const RigCamera& after) {
  if (before.covariance.size() != 36 || after.covariance.size() != 36) return {};
  const SE3 was = to_se3(before.rig_from_camera);
  const SE3 is = to_se3(after.rig_from_camera);
  Vector6 change;
  change << log_so3(is.rotation * was.rotation.transpose()), is.translation - was.translation;
  const Matrix6 covariance = Eigen::Map<const Matrix6>(before.covariance.data()) +
                             Eigen::Map<const Matrix6>(after.covariance.data());
  const double square = change.dot(covariance.ldlt().solve(change)) / 6;
  return {std::isfinite(square) ? square : 0, change.tail<3>().norm(), change.head<3>().norm()};
}

std::size_t agreeing_views(const RigSolution& solution, std::size_t camera) {
  std::size_t agree = 0;
  for (const RigLink& link : solution.links) {
    if (link.a == camera || link.b == camera) agree += link.agree;
  }
  return agree;
}

// Whether a camera has seen enough in both halves of the time, and not nearly all in one of them:
// the few views of the other one then show the board in one place.
bool is_in_both(const RigSolution& before, std::size_t then, const RigSolution& after,
                std::size_t now) {
  constexpr std::size_t kFewest = 5;
  constexpr std::size_t kRatio = 4;
  const auto [less, more] = std::minmax({agreeing_views(before, then), agreeing_views(after, now)});
  return less >= kFewest && kRatio * less >= more;
}

std::optional<std::size_t> find_camera(const Rig& rig, const std::string& name) {
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    if (rig.cameras[c].calibration.camera == name) return c;
  }
  return std::nullopt;
}

std::string sentence(const std::vector<std::string>& names, const Change& largest) {
  constexpr double kMillimetre = 1e-3;
  constexpr double kDegree = 0.017453292519943295;
  return fmt::format(
      "The camera {} has moved while boards were shown: it stands {:.1f} mm and {:.2f} degrees "
      "from "
      "where it stood before. Fix it, and show boards anew.",
      join(names, " or "), largest.place / kMillimetre, largest.turn / kDegree);
}

}  // namespace

std::string moved_cameras(const std::vector<RigCameraViews>& seen, RigOptions options,
                          const std::stop_token& stop) {
  constexpr double kSigmas = 5;
  if (options.mode != RigMode::kJoint) return "";
  // A camera of which only one half says where it stands keeps the others from nothing.
  options.is_partial = true;
  // Both halves are compared in the lengths of the boards.
  options.baselines.clear();
  options.intrinsics = RigIntrinsics::kHeld;
  options.world.reset();
  const auto instants = pair_instants(seen, options.tolerance).instants;
  if (instants.size() < 4) return "";
  // Half of the tolerance ahead: the pictures of an instant stay together.
  const std::uint64_t middle = instants[instants.size() / 2].timestamp;
  const std::uint64_t at = middle - std::min(middle, options.tolerance / 2);
  const auto before = solve_rig(part_of(seen, at, false), options, stop);
  if (!before) return "";
  const auto after = solve_rig(part_of(seen, at, true), options, stop);
  if (!after || after->rig.world != before->rig.world) return "";
  std::vector<std::string> moved;
  std::vector<std::string> compared;
  Change largest;
  for (std::size_t c = 1; c < before->rig.cameras.size(); ++c) {
    const std::string& name = before->rig.cameras[c].calibration.camera;
    const auto later = find_camera(after->rig, name);
    if (!later || !is_in_both(*before, c, *after, *later)) continue;
    compared.push_back(fmt::format("'{}'", name));
    const Change change = change_between(before->rig.cameras[c], after->rig.cameras[*later]);
    if (change.square < kSigmas * kSigmas) continue;
    moved.push_back(compared.back());
    if (change.square > largest.square) largest = change;
  }
  if (moved.empty()) return "";
  // All others have moved alike: or the first one, which is the frame, has.
  const std::string first = fmt::format("'{}'", before->rig.world);
  if (moved.size() == compared.size()) {
    moved = compared.size() == 1 ? std::vector{first, moved.front()} : std::vector{first};
  }
  return sentence(moved, largest);
}

}  // namespace calvin
