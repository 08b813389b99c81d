// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A rotation fitted between two cameras, and the changes of projection that it leaves.

#include "calvin/solve/difference.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Core>
#include <Eigen/Geometry>

#include "calvin/camera/models.hpp"
#include "calvin/geometry/convex_hull.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/solve/linear/scaled_solve.hpp"

namespace calvin {

namespace {

constexpr int kMaxIterations = 100;

// A pixel that counts for the rotation, and its ray in the frame of `a`.
struct Target {
  Pixel at;
  Eigen::Vector3d ray;
};

// The state after a rotation: the squared change of each target (px^2; absent where `b` has no
// value for it), and the normal equations of a further small rotation about the axes of `b`.
struct Normal {
  std::vector<std::optional<double>> squares;
  int count = 0;
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
};

template <typename M>
Normal evaluate(const Camera& b, const std::vector<Target>& targets, const Eigen::Matrix3d& turn) {
  Normal normal;
  normal.squares.resize(targets.size());
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const Target& target = targets[i];
    const Eigen::Vector3d ray = turn * target.ray;
    const auto seen = b.project(ray);
    if (!seen) continue;
    double uv[2];
    double jp[6];
    if (!M::project(b.parameters().data(), b.skew(), ray, uv, jp, nullptr)) continue;
    const Eigen::Vector2d e(seen->u - target.at.u, seen->v - target.at.v);
    const Eigen::Map<const Eigen::Matrix<double, 2, 3, Eigen::RowMajor>> by_ray(jp);
    Eigen::Matrix<double, 2, 3> j;  // of w x ray by w: each row is ray x (that of by_ray)
    for (int row = 0; row < 2; ++row) {
      j.row(row) = ray.cross(Eigen::Vector3d(by_ray.row(row))).transpose();
    }
    if (!e.allFinite() || !j.allFinite()) continue;
    normal.matrix += j.transpose() * j;
    normal.gradient += j.transpose() * e;
    normal.squares[i] = e.squaredNorm();
    ++normal.count;
  }
  return normal;
}

Normal evaluate(const Camera& b, const std::vector<Target>& targets, const Eigen::Matrix3d& turn) {
  Normal normal;
  visit_model(b.model(), [&]<typename M>() { normal = evaluate<M>(b, targets, turn); });
  return normal;
}

// The rotation that takes the rays of `a` to those of `b` for the same pixels, by the angle between
// them (S. Umeyama, PAMI 13(4), 1991): near enough for any difference.
Eigen::Matrix3d first_rotation(const Camera& b, const std::vector<Target>& targets) {
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  int count = 0;
  for (const Target& target : targets) {
    const auto ray = b.unproject(target.at);
    if (!ray) continue;
    products += *ray * target.ray.transpose();
    ++count;
  }
  return count < 3 ? Eigen::Matrix3d::Identity() : closest_rotation(products);
}

// Whether `next` has the smaller sum over the targets for which both rotations have a value, and
// keeps at least half of the targets.
bool improves(const Normal& next, const Normal& at) {
  double change = 0;
  for (std::size_t i = 0; i < at.squares.size(); ++i) {
    if (next.squares[i] && at.squares[i]) change += *next.squares[i] - *at.squares[i];
  }
  return change < 0 && next.count >= 3 && 2 * next.count >= at.count;
}

// Levenberg and Marquardt's iteration on the three parameters.
std::optional<Eigen::Matrix3d> fit_rotation(const Camera& b, const std::vector<Target>& targets) {
  Eigen::Matrix3d turn = first_rotation(b, targets);
  Normal at = evaluate(b, targets, turn);
  double damping = 0;
  for (int i = 0; i < kMaxIterations && at.count >= 3; ++i) {
    Eigen::Matrix3d damped = at.matrix;
    damped.diagonal() *= 1 + damping;
    const auto solved = scaled_solve(damped, at.gradient, 0);
    if (!solved) return std::nullopt;
    const Eigen::Vector3d step = -*solved;
    if (!(step.norm() > 1e-15)) return turn;
    const Eigen::Matrix3d next = exp_so3(step) * turn;
    Normal there = evaluate(b, targets, next);
    if (improves(there, at)) {
      turn = next;
      at = std::move(there);
      damping = damping < 1e-6 ? 0 : damping / 10;
    } else {
      if (step.norm() < 1e-12) return turn;  // rounding
      damping = std::max(10 * damping, 1e-3);
    }
  }
  if (at.count < 3) return std::nullopt;
  return turn;
}

bool in_focus(const std::vector<std::vector<Pixel>>& focus, Pixel at) {
  return std::all_of(focus.begin(), focus.end(),
                     [at](const auto& polygon) { return contains(polygon, at); });
}

void add(Difference::Summary& summary, const Difference::Cell& cell) {
  const double change = std::hypot(cell.change->u, cell.change->v);
  if (summary.cells == 0 || change > summary.max) {
    summary.max = change;
    summary.worst = cell.at;
  }
  summary.rms += change * change;
  ++summary.cells;
}

void finish(Difference::Summary& summary) {
  if (summary.cells > 0) summary.rms = std::sqrt(summary.rms / summary.cells);
}

Status check(const Camera& a, const Camera& b, const DifferenceOptions& options) {
  const ImageSize sa = a.image_size();
  const ImageSize sb = b.image_size();
  if (sa != sb) {
    return make_error(
        ErrorCode::kInvalidArgument,
        fmt::format("The calibrations are for images of {}x{} and {}x{} px, which cannot be "
                    "compared; scale one of them to the size of the other first.",
                    sa.width, sa.height, sb.width, sb.height));
  }
  if (options.columns < 2 || options.rows < 2 || options.columns > 1000 || options.rows > 1000) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("A grid of {}x{} pixels cannot be compared; give 2 to 1000 each "
                                  "way.",
                                  options.columns, options.rows));
  }
  return {};
}

}  // namespace

Result<Difference> difference(const Camera& a, const Camera& b, const DifferenceOptions& options) {
  if (const Status status = check(a, b, options); !status) return tl::unexpected(status.error());
  Difference result;
  result.columns = options.columns;
  std::vector<std::optional<Eigen::Vector3d>> rays;
  std::vector<Target> targets;
  for (int y = 0; y < options.rows; ++y) {
    for (int x = 0; x < options.columns; ++x) {
      const Pixel at = {x * (a.image_size().width - 1.0) / (options.columns - 1),
                        y * (a.image_size().height - 1.0) / (options.rows - 1)};
      rays.push_back(a.unproject(at));
      result.cells.push_back({at, {}, in_focus(options.focus, at)});
      if (rays.back() && result.cells.back().in_focus) targets.push_back({at, *rays.back()});
    }
  }
  const auto turn = fit_rotation(b, targets);
  if (!turn) {
    return make_error(ErrorCode::kDegenerate,
                      "The two calibrations have fewer than three pixels of the grid in common "
                      "that both of them know, so that no rotation between them can be found; take "
                      "a larger focus or a finer grid, and check that both are of this camera.");
  }
  const Eigen::Vector3d w = log_so3(*turn);
  result.rotation = {w[0], w[1], w[2]};
  for (std::size_t i = 0; i < result.cells.size(); ++i) {
    Difference::Cell& cell = result.cells[i];
    if (!rays[i]) continue;
    const auto seen = b.project(*turn * *rays[i]);
    if (!seen) continue;
    cell.change = Pixel{seen->u - cell.at.u, seen->v - cell.at.v};
    add(result.image, cell);
    if (cell.in_focus) add(result.focus, cell);
  }
  finish(result.image);
  finish(result.focus);
  return result;
}

}  // namespace calvin
