// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Poses and labellings of single views.

#include "calvin/rig/board_views.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Core>

#include "calvin/geometry/dense.hpp"
#include "calvin/solve/fit/weights.hpp"
#include "calvin/solve/residuals/bundle_problem.hpp"
#include "calvin/solve/start/pose_fit.hpp"
#include "calvin/solve/view.hpp"
#include "calvin/target/unbounded_grid.hpp"

namespace calvin::rig {

namespace {

// The other tilt of a plane is looked at where its squared distances are at most as many times
// those of the better one, of corners with noise in them.
constexpr double kTiltRatio = 6;

// A quarter turn of a board that is `height` m high, which puts it into the first quadrant again.
SE3 quarter_turn(double height) { return {exp_so3({0, 0, std::numbers::pi / 2}), {height, 0, 0}}; }

constexpr double kRounding = 1e-6;  // px^2 of a corner

// Whether a plane has a second tilt that its corners nearly allow.
bool has_two_tilts(const PoseFit& fit, const PointSet& seen) {
  return fit.other_cost <= RivalTilt{kTiltRatio, kRounding}.limit(fit.cost, seen.used()) &&
         (fit.other.rotation - fit.camera_from_board.rotation).norm() > 1e-3;
}

// How near to its optimum a pose is.
enum class PoseUse { kResult, kStart };

bool find_poses(BoardView& view, const Camera& camera, const CameraPoints& points, PoseUse use) {
  const auto rays = rays_of(view.seen, points);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (rays[i].isZero(0)) view.seen.weight[i] = 0;
  }
  if (!spans_plane(view.seen)) return false;
  const auto fit = use == PoseUse::kStart
                       ? fit_pose_roughly(view.seen, rays, camera, {kTiltRatio, kRounding})
                       : fit_pose(view.seen, camera, Loss{});
  if (!fit) return false;
  view.sample = sample_of(view.seen);
  view.poses = {fit->camera_from_board};
  if (has_two_tilts(*fit, view.seen)) view.poses.push_back(fit->other);
  return true;
}

Eigen::Vector3d middle_of(const BoardArea& area) {
  return {0.5 * (area.left + area.right), 0.5 * (area.top + area.bottom), 0};
}

// Which of the boards that were seen before a board is; a new one is added.
std::size_t number_of(const Board& board, std::vector<Board>& boards) {
  const auto known = std::ranges::find(boards, board);
  const auto number = static_cast<std::size_t>(known - boards.begin());
  if (known == boards.end()) boards.push_back(board);
  return number;
}

constexpr Eigen::Index kMotions = 6;
constexpr double kSmallMotion = 1e-6;  // rad, m

// px of u and v of every corner in turn; rows of corners without a projection are 0.
Eigen::VectorXd projected(const PointSet& seen, const Camera& camera, const SE3& pose) {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(2 * static_cast<Eigen::Index>(seen.size()));
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const auto at = camera.project(pose * seen.points[i]);
    if (!at) continue;
    all(2 * static_cast<Eigen::Index>(i)) = at->u;
    all(2 * static_cast<Eigen::Index>(i) + 1) = at->v;
  }
  return all;
}

// px/s: how fast the corners that are seen move where the board moves as a whole, by least squares
// from how fast each of them was seen to move. A hundred measured numbers become six, so that the
// noise of each is small: by noisy velocities what they multiply seems smaller than it is. As they
// were measured where the pose leaves a motion open; empty where there are none.
std::vector<Pixel> rigid_velocities(const PointSet& seen, const Camera& camera,
                                    const SE3& camera_from_board,
                                    const std::vector<Pixel>& measured) {
  constexpr double kLeastPivot = 1;  // (px per rad or m)^2
  const std::size_t count = seen.size();
  if (measured.size() != count) return {};
  Eigen::MatrixXd columns(2 * static_cast<Eigen::Index>(count), kMotions);
  for (Eigen::Index k = 0; k < kMotions; ++k) {
    std::array<double, 6> d{};
    d[static_cast<std::size_t>(k)] = kSmallMotion;
    const SE3 ahead = retract(camera_from_board, d.data());
    d[static_cast<std::size_t>(k)] = -kSmallMotion;
    const SE3 behind = retract(camera_from_board, d.data());
    columns.col(k) =
        (projected(seen, camera, ahead) - projected(seen, camera, behind)) / (2 * kSmallMotion);
  }
  Eigen::VectorXd right(columns.rows());
  Eigen::VectorXd weight(columns.rows());
  for (std::size_t i = 0; i < count; ++i) {
    const auto row = 2 * static_cast<Eigen::Index>(i);
    right.segment<2>(row) = Eigen::Vector2d(measured[i].u, measured[i].v);
    weight.segment<2>(row).setConstant(seen.weight[i] > 0 ? 1 : 0);
  }
  const Eigen::MatrixXd used = weight.asDiagonal() * columns;
  const auto motion =
      solve_definite(transposed_product(used, used), transposed_product(used, right), kLeastPivot);
  if (!motion) return measured;
  const Eigen::VectorXd moving = columns * motion->col(0);
  std::vector<Pixel> all;
  for (Eigen::Index row = 0; row < moving.size(); row += 2) {
    all.push_back({moving(row), moving(row + 1)});
  }
  return all;
}

// Whether any corner is known to move, so that clocks may show.
bool any_moves(const std::vector<RigCameraViews>& seen) {
  return std::ranges::any_of(seen, [](const RigCameraViews& camera) {
    return std::ranges::any_of(camera.views,
                               [](const View& v) { return !v.observation.velocity.empty(); });
  });
}

// Checks the views of all cameras; without poses.
Result<std::vector<BoardView>> checked_views(const std::vector<RigCameraViews>& seen,
                                             const std::vector<Camera>& cameras) {
  std::vector<BoardView> all;
  std::vector<PointSet> sets;
  std::vector<Board> boards;
  std::vector<std::vector<Eigen::Vector3d>> points;  // of those boards
  std::size_t count = 0;
  for (const RigCameraViews& camera : seen) count += camera.views.size();
  all.reserve(count);
  sets.reserve(count);
  for (std::size_t c = 0; c < seen.size(); ++c) {
    for (std::size_t v = 0; v < seen[c].views.size(); ++v) {
      const View& view = seen[c].views[v];
      if (!view.observation.found()) continue;
      if (const Status good = check_before_camera(view, cameras[c].image_size()); !good) {
        return make_error(good.error().code,
                          fmt::format("A view of the camera '{}': {}", seen[c].calibration.camera,
                                      good.error().message));
      }
      if (const Status named = check_names_points(view.board); !named) {
        return tl::unexpected<Error>(named.error());
      }
      const std::size_t board = number_of(view.board, boards);
      if (board == points.size()) points.push_back(view.board.points());
      all.push_back({{c, v},
                     board,
                     {},
                     1,
                     {},
                     labellings_of(view),
                     {},
                     {},
                     board,
                     middle_of(view.board.extent())});
      sets.push_back(to_points(view.board, points[board], view.observation));
    }
  }
  const WeightScale scale = normalise_weights(sets);
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i].seen = std::move(sets[i]);
    all[i].sigma = scale.sigma;
  }
  return all;
}

// Leaves out those that determine none.
void find_all_poses(const std::vector<RigCameraViews>& seen, const std::vector<Camera>& cameras,
                    PoseUse use, std::vector<BoardView>& all) {
  const std::vector<CameraPoints> points = points_before(cameras);
  std::erase_if(all, [&](BoardView& view) {
    const std::size_t camera = view.of.camera;
    return !find_poses(view, cameras[camera], points[camera], use);
  });
  for (BoardView& view : all) {
    const Observation& observation = seen[view.of.camera].views[view.of.view].observation;
    view.velocity = rigid_velocities(view.seen, cameras[view.of.camera], view.poses.front(),
                                     observation.velocity);
  }
}

}  // namespace

// A dozen corners tell a wrong place from a right one as well as all do.
std::shared_ptr<const ViewPoints> sample_of(const PointSet& seen) {
  constexpr std::size_t kMost = 12;
  std::vector<std::size_t> used;
  used.reserve(seen.size());
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (seen.weight[i] > 0) used.push_back(i);
  }
  const std::size_t count = std::min(used.size(), kMost);
  PointSet sample = seen.without_corners();
  sample.reserve(count);
  for (std::size_t k = 0; k < count; ++k) sample.append(seen, used[k * used.size() / count]);
  return std::make_shared<const ViewPoints>(sample, BoardShape());
}

std::vector<CameraPoints> points_before(const std::vector<Camera>& cameras) {
  return {cameras.begin(), cameras.end()};
}

std::vector<SE3> labellings_of(const View& view) {
  std::vector<SE3> all = {SE3()};
  const BoardArea extent = view.board.extent();
  const auto grid = view.board.grid();
  const double pitch = grid ? grid->pitch : 0;
  for (const Relabelling& other : view.observation.ambiguous) {
    SE3 motion;
    double width = extent.width();
    double height = extent.height();
    for (int i = 0; i < other.quarter_turns; ++i) {
      motion = quarter_turn(height) * motion;
      std::swap(width, height);
    }
    motion.translation += Eigen::Vector3d(other.cols * pitch, other.rows * pitch, 0);
    all.push_back(motion);
  }
  return all;
}

bool is_same_labelling(const SE3& one, const SE3& other) {
  constexpr double kSame = 1e-6;  // rad, m
  return (one.rotation - other.rotation).norm() < kSame &&
         (one.translation - other.translation).norm() < kSame;
}

Result<std::vector<BoardView>> board_views(const std::vector<RigCameraViews>& seen,
                                           const std::vector<Camera>& cameras) {
  auto all = checked_views(seen, cameras);
  if (all) find_all_poses(seen, cameras, PoseUse::kResult, *all);
  return all;
}

Result<std::vector<BoardView>> paired_board_views(const std::vector<RigCameraViews>& seen,
                                                  const std::vector<Camera>& cameras,
                                                  std::uint64_t tolerance, InstantsOf of) {
  auto all = checked_views(seen, cameras);
  if (!all) return all;
  if (!any_moves(seen)) {
    std::vector<bool> is_paired(all->size(), false);
    for (const auto& group : group_views(pair_instants(seen, tolerance, of), *all)) {
      for (const std::size_t v : group) is_paired[v] = true;
    }
    std::vector<BoardView> paired;
    for (std::size_t v = 0; v < all->size(); ++v) {
      if (is_paired[v]) paired.push_back(std::move((*all)[v]));
    }
    *all = std::move(paired);
  }
  find_all_poses(seen, cameras, PoseUse::kStart, *all);
  return all;
}

std::vector<std::vector<std::size_t>> group_views(const Instants& instants,
                                                  const std::vector<BoardView>& views) {
  std::vector<std::vector<std::size_t>> groups;
  const auto key = [](const RigView& v) { return std::pair(v.camera, v.view); };
  for (const Instant& instant : instants.instants) {
    std::vector<std::size_t>& group = groups.emplace_back();
    for (const RigView& view : instant.views) {
      const auto at = std::ranges::lower_bound(views, key(view), {},
                                               [&](const BoardView& v) { return key(v.of); });
      if (at != views.end() && key(at->of) == key(view)) {
        group.push_back(static_cast<std::size_t>(at - views.begin()));
      }
    }
  }
  return groups;
}

double misfit(const BoardView& view, const CameraPoints& camera, const SE3& camera_from_board,
              const SE3& labelling) {
  constexpr double kNoProjection = 1e4;  // px
  constexpr std::size_t kMost = 16;      // no sample is larger
  const ViewPoints& sample = *view.sample;
  if (sample.count() == 0 || sample.padded() > kMost) return kNoProjection;
  alignas(64) double squares[kMost];
  camera.squares(sample, camera_from_board * labelling, squares);
  double sum = 0;
  for (std::size_t i = 0; i < sample.count(); ++i) {
    sum += std::min(squares[i], kNoProjection * kNoProjection);
  }
  return std::sqrt(sum / static_cast<double>(sample.count()));
}

}  // namespace calvin::rig
