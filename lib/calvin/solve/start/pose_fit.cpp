// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Levenberg-Marquardt over the six unknowns of one pose, from both of a plane's tilts.

#include "calvin/solve/start/pose_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "calvin/solve/linear/cholesky.hpp"
#include "calvin/solve/linear/lm.hpp"
#include "calvin/solve/linear/products.hpp"
#include "calvin/solve/residuals/bundle_problem.hpp"
#include "calvin/solve/start/plane_pose.hpp"
#include "calvin/solve/start/projection_matrix.hpp"

namespace calvin {

namespace {

// The pose of one view as a problem for minimise().
class PoseProblem {
 public:
  PoseProblem(const ViewPoints& view, const Camera& camera, const Loss& loss, const SE3& start)
      : view_(view),
        camera_(camera),
        fill_(fill_rows_of(camera.model())),
        loss_(loss),
        rows_({CameraUnknowns::of(camera.parameters().size(), false), 0, false, true}) {
    current_.pose = start;
    rows_.resize(view.padded());
    valid_ = linearise(current_);
  }

  [[nodiscard]] bool valid() const { return valid_; }
  [[nodiscard]] double cost() const { return current_.cost; }
  [[nodiscard]] const SE3& pose() const { return current_.pose; }

  [[nodiscard]] std::optional<double> propose(double lambda) {
    double factor[kPose * kPose];
    if (!cholesky_of<kPose>(current_.block(), lambda, factor)) return std::nullopt;
    double step[kPose];
    for (int i = 0; i < kPose; ++i) step[i] = -current_.gradient()[i];
    solve_lower<kPose>(factor, step);
    solve_upper<kPose>(factor, step);
    double predicted = 0;
    for (int i = 0; i < kPose; ++i) {
      const double diagonal = current_.block()[i * kPose + i];
      predicted += step[i] * (lambda * diagonal * step[i] - current_.gradient()[i]);
    }
    if (!std::isfinite(predicted)) return std::nullopt;
    trial_.pose = retract(current_.pose, step);
    return std::max(predicted, 0.0);
  }
  [[nodiscard]] std::optional<double> evaluate_trial() {
    if (!linearise(trial_)) return std::nullopt;
    return trial_.cost;
  }
  void accept() { std::swap(current_, trial_); }
  void accept_unseen(double predicted) {
    current_.pose = trial_.pose;
    current_.cost = std::max(0.0, current_.cost - predicted);
  }

 private:
  static constexpr int kPose = RowLayout::kPose;

  struct State {
    SE3 pose;
    // The products of the pose columns with each other and, as a last row, with the residual.
    std::array<double, static_cast<std::size_t>(kPose + 1) * kPose> products{};
    double cost = 0;

    [[nodiscard]] const double* block() const { return products.data(); }
    [[nodiscard]] const double* gradient() const { return products.data() + kPose * kPose; }
  };

  bool linearise(State& state) {
    const RowPoint at = {camera_.parameters().data(), camera_.skew(), nullptr};
    const RowSums sums = fill_(view_, at, state.pose, loss_, rows_, RowContent::kAll);
    if (!sums.valid || !std::isfinite(sums.cost)) return false;
    state.cost = sums.cost;
    double products[(kPose + 1) * kLanes];
    column_products(rows_.data(), 2 * rows_.padded(), kPose + 1, products, kLanes);
    for (std::size_t i = 0; i <= kPose; ++i) {
      for (std::size_t j = 0; j < std::min<std::size_t>(i + 1, kPose); ++j) {
        state.products[i * kPose + j] = products[i * kLanes + j];
      }
    }
    return true;
  }

  const ViewPoints& view_;
  const Camera& camera_;
  FillRows fill_;
  Loss loss_;
  ViewRows rows_;
  State current_;
  State trial_;
  bool valid_ = false;
};

std::optional<SE3> start_on_plane(const PointSet& view, const std::vector<Eigen::Vector3d>& rays) {
  const auto board_from = board_from_plane(view);
  if (!board_from) return pose_from_rays(view.points, rays);
  const SE3 plane_from_board = board_from->inverse();
  std::vector<Eigen::Vector3d> points;
  points.reserve(view.size());
  for (const Eigen::Vector3d& p : view.points) points.push_back(plane_from_board * p);
  const auto pose = pose_from_rays(points, rays);
  if (!pose) return std::nullopt;
  return *pose * plane_from_board;
}

// The mean distance between the rays and the directions of the points, as unit vectors.
double ray_error(const PointSet& view, const std::vector<Eigen::Vector3d>& rays,
                 const SE3& camera_from_board) {
  double sum = 0;
  for (std::size_t i = 0; i < view.size(); ++i) {
    if (rays[i].isZero()) continue;
    sum += (rays[i] - (camera_from_board * view.points[i]).normalized()).norm();
  }
  return sum;
}

}  // namespace

std::vector<Eigen::Vector3d> rays_of(const PointSet& view, const Camera& camera) {
  return rays_of(view, CameraPoints(camera));
}

std::vector<Eigen::Vector3d> rays_of(const PointSet& view, const CameraPoints& camera) {
  std::vector<Eigen::Vector3d> rays = camera.rays(view.uv);
  for (std::size_t i = 0; i < view.size(); ++i) {
    if (!(view.weight[i] > 0)) rays[i].setZero();
  }
  return rays;
}

std::optional<SE3> start_pose(const PointSet& view, const Camera& camera) {
  return start_pose(view, rays_of(view, camera));
}

std::optional<SE3> start_pose(const PointSet& view, const std::vector<Eigen::Vector3d>& rays) {
  auto plane = start_on_plane(view, rays);
  if (!spans_space(view)) return plane;
  auto space = pose_in_space(view.points, rays);
  if (!space || !plane) return space ? space : plane;
  return ray_error(view, rays, *space) < ray_error(view, rays, *plane) ? space : plane;
}

SE3 mirrored_tilt(const PointSet& view, const SE3& camera_from_board) {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : view.points) center += p / static_cast<double>(view.size());
  const auto plane = board_from_plane(view);
  return plane ? mirrored_tilt(camera_from_board, center, plane->rotation.col(2))
               : mirrored_tilt(camera_from_board, center);
}

namespace {

// One of the minima, as both.
std::optional<PoseFit> refined(const ViewPoints& points, const Camera& camera, const Loss& loss,
                               const SE3& from, const LmOptions& options) {
  PoseProblem problem(points, camera, loss, from);
  if (!problem.valid()) return std::nullopt;
  minimise(problem, options, {});
  return PoseFit{problem.pose(), problem.cost(), problem.pose(), problem.cost()};
}

}  // namespace

std::optional<PoseFit> fit_pose(const PointSet& view, const Camera& camera, const Loss& loss) {
  const auto start = start_pose(view, camera);
  if (!start) return std::nullopt;
  const ViewPoints points(view, {});
  auto best = refined(points, camera, loss, *start, {});
  auto other = refined(points, camera, loss,
                       mirrored_tilt(view, best ? best->camera_from_board : *start), {});
  if (other && (!best || other->cost < best->cost)) std::swap(best, other);
  if (best && other) {
    best->other = other->camera_from_board;
    best->other_cost = other->cost;
  }
  return best;
}

namespace {

// The start by a few corners, or by all where few of those have a ray.
std::optional<SE3> quick_start(const PointSet& view, const std::vector<Eigen::Vector3d>& rays) {
  constexpr std::size_t kCorners = 20;
  constexpr std::size_t kFewest = 12;
  if (view.size() > kCorners) {
    PointSet few = view.without_corners();
    few.reserve(kCorners);
    std::vector<Eigen::Vector3d> few_rays;
    few_rays.reserve(kCorners);
    for (const std::size_t i : spread_corners(view.size(), kCorners)) {
      if (rays[i].isZero(0)) continue;
      few.append(view, i);
      few_rays.push_back(rays[i]);
    }
    if (few.size() >= kFewest && spans_plane(few)) {
      if (const auto start = start_pose(few, few_rays)) return start;
    }
  }
  return start_pose(view, rays);
}

}  // namespace

std::vector<std::size_t> spread_corners(std::size_t all, std::size_t most) {
  constexpr std::size_t kPlaces = 16;  // in each part
  constexpr std::size_t kJump = 7;     // prime to that: visits every place
  std::vector<std::size_t> few;
  const std::size_t n = std::min(all, most);
  few.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t first = i * all / n;
    const std::size_t length = (i + 1) * all / n - first;
    few.push_back(first + kJump * i % kPlaces * length / kPlaces);
  }
  return few;
}

std::optional<PoseFit> fit_pose_roughly(const PointSet& view,
                                        const std::vector<Eigen::Vector3d>& rays,
                                        const Camera& camera, const RivalTilt& rival) {
  constexpr double kClearly = 10;  // what is predicted of a minimum is wrong by less
  const auto start = quick_start(view, rays);
  if (!start) return std::nullopt;
  const ViewPoints points(view, {});
  LmOptions options;
  options.small = 1e-3;
  auto best = refined(points, camera, Loss{}, *start, options);
  if (best) options.hopeless = kClearly * rival.limit(best->cost, points.count());
  auto other = refined(points, camera, Loss{},
                       mirrored_tilt(view, best ? best->camera_from_board : *start), options);
  if (other && (!best || other->cost < best->cost)) std::swap(best, other);
  if (best && other && other->cost <= rival.limit(best->cost, points.count())) {
    best->other = other->camera_from_board;
    best->other_cost = other->cost;
  } else if (best) {
    best->other = best->camera_from_board;
    best->other_cost = std::numeric_limits<double>::infinity();
  }
  return best;
}

}  // namespace calvin
