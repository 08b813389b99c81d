// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Tsai's three-parameter least squares, and the way to our models.

#include "calvin/solve/methods/tsai.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Cholesky>

#include "calvin/solve/linear/lm.hpp"

namespace calvin {

namespace {

// Focal length, tz and kappa by least squares on distances in the ideal image: for minimise().
class ThreeParameters {
 public:
  ThreeParameters(const std::vector<CenteredPoint>& seen, const TsaiCamera& from) : camera_(from) {
    const double tz = from.camera_from_board.translation.z();
    for (const CenteredPoint& s : seen) {
      const Eigen::Vector3d at = from.camera_from_board * s.board;
      points_.push_back({{at.x(), at.y(), at.z() - tz}, {s.image.x() / from.sx, s.image.y()}});
    }
    current_.x = {from.focal, tz, from.kappa};
    (void)linearise(current_);
  }

  [[nodiscard]] double cost() const { return current_.cost; }
  [[nodiscard]] std::optional<double> propose(double lambda) {
    Eigen::Matrix3d damped = current_.normal;
    damped.diagonal() *= 1 + lambda;
    const Eigen::Vector3d step = -damped.ldlt().solve(current_.gradient);
    if (!step.allFinite()) return std::nullopt;
    trial_.x = current_.x + step;
    const Eigen::Vector3d diagonal = current_.normal.diagonal();
    return std::max(0.0, step.dot(lambda * diagonal.cwiseProduct(step) - current_.gradient));
  }
  [[nodiscard]] std::optional<double> evaluate_trial() {
    if (!linearise(trial_)) return std::nullopt;
    return trial_.cost;
  }
  void accept() { std::swap(current_, trial_); }
  void accept_unseen(double predicted) {
    current_.x = trial_.x;
    current_.cost = std::max(0.0, current_.cost - predicted);
  }
  [[nodiscard]] TsaiCamera result() const {
    TsaiCamera found = camera_;
    found.focal = current_.x[0];
    found.camera_from_board.translation.z() = current_.x[1];
    found.kappa = current_.x[2];
    return found;
  }

 private:
  struct State {
    Eigen::Vector3d x;  // focal length, tz, kappa
    Eigen::Matrix3d normal;
    Eigen::Vector3d gradient;
    double cost = 0;
  };

  bool linearise(State& state) const {
    state.normal.setZero();
    state.gradient.setZero();
    state.cost = 0;
    for (const CenteredPoint& p : points_) {
      const double z = p.board.z() + state.x[1];
      if (!(z > 0)) return false;
      const double square = p.image.squaredNorm();
      for (int k = 0; k < 2; ++k) {
        const double slope = p.board[k] / z;
        const double r = state.x[0] * slope - p.image[k] * (1 + state.x[2] * square);
        const Eigen::Vector3d by(slope, -state.x[0] * slope / z, -p.image[k] * square);
        state.normal += by * by.transpose();
        state.gradient += r * by;
        state.cost += r * r;
      }
    }
    return std::isfinite(state.cost);
  }

  TsaiCamera camera_;
  std::vector<CenteredPoint> points_;  // camera frame less tz, and the image with sx taken off
  State current_;
  State trial_;
};

// What a radius of the ideal image, in focal lengths, adds to the seen one per unit of k1, k2, k3.
Eigen::Vector3d powers(double r) {
  const double square = r * r;
  return r * square * Eigen::Vector3d(1, square, square * square);
}

// Of radii spread over the image: seen, and ideal, in focal lengths.
std::vector<Eigen::Vector2d> radii(const TsaiCamera& camera, ImageSize size) {
  constexpr int kCount = 200;
  const double half_u = std::max(camera.center.u, size.width - 1 - camera.center.u) / camera.sx;
  const double half_v = std::max(camera.center.v, size.height - 1 - camera.center.v);
  double most = std::hypot(half_u, half_v);
  // Near the radius where the distortion folds no polynomial follows it.
  if (camera.kappa < 0) most = std::min(most, 0.9 / std::sqrt(-3 * camera.kappa));
  std::vector<Eigen::Vector2d> all;
  for (int i = 1; i <= kCount; ++i) {
    const double r = most * i / kCount;
    all.emplace_back(r / camera.focal, r * (1 + camera.kappa * r * r) / camera.focal);
  }
  return all;
}

}  // namespace

Result<TsaiCamera> tsai(const PointSet& view, Pixel center) {
  const auto start = radial_alignment(view, center);
  if (!start) return start;
  ThreeParameters problem(centered_points(view, {}, center), *start);
  (void)minimise(problem, LmOptions{}, {});
  const TsaiCamera camera = problem.result();
  if (!(camera.focal > 0) || !(camera.camera_from_board.translation.z() > 0)) {
    return no_tsai_camera(
        "focal length and distance run away from each other: tilt the plane more, or give points "
        "in space");
  }
  return camera;
}

NearestBrown nearest_brown(const TsaiCamera& camera, ImageSize size) {
  const auto all = radii(camera, size);
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const Eigen::Vector2d& r : all) {
    const Eigen::Vector3d by = powers(r[1]);
    normal += by * by.transpose();
    right += by * (r[0] - r[1]);
  }
  const Eigen::Vector3d unit = normal.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::Matrix3d scaled = unit.asDiagonal() * normal * unit.asDiagonal();
  const Eigen::Vector3d solved = scaled.ldlt().solve(unit.cwiseProduct(right));
  const Eigen::Vector3d k = unit.cwiseProduct(solved);
  NearestBrown brown;
  brown.parameters = {camera.sx * camera.focal,
                      camera.focal,
                      camera.center.u,
                      camera.center.v,
                      k[0],
                      k[1],
                      0,
                      0,
                      k[2]};
  for (const Eigen::Vector2d& r : all) {
    const double off = r[1] + k.dot(powers(r[1])) - r[0];
    brown.residual = std::max(brown.residual, camera.focal * std::abs(off));
  }
  return brown;
}

Result<MethodResult> tsai_method(const MethodInput& input) {
  if (input.views.size() != 1) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("Tsai's method takes one view, and {} are given: leave one, or "
                                  "take the method zhang or dlt.",
                                  input.views.size()));
  }
  const auto found = tsai(input.views[0], image_center(input.size));
  if (!found) return tl::unexpected<Error>(found.error());
  const NearestBrown brown = nearest_brown(*found, input.size);
  auto camera = Camera::make("brown5", input.size, brown.parameters);
  if (!camera) return tl::unexpected<Error>(camera.error());
  std::string remark = fmt::format(
      "Tsai: f {:.6g} px, kappa1 {:.6g} / px^2, sx {:.6g}; brown5 follows that within {:.2g} px.",
      found->focal, found->kappa, found->sx, brown.residual);
  return MethodResult{*std::move(camera), {found->camera_from_board}, {std::move(remark)}};
}

}  // namespace calvin
