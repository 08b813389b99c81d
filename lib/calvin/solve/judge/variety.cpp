// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Whether the views differ enough to determine a camera.

#include "calvin/solve/judge/variety.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "calvin/geometry/symmetric.hpp"

namespace calvin {

namespace {

// Boards closer to parallel than this count as parallel, rad.
constexpr double kParallel = 0.0175;

// Boards whose corners move by less than this are in one place, in parts of the image diagonal.
constexpr double kOnePlace = 0.02;

// Two tilts that hold the pinhole less firmly do not determine it: as two that are 5 degrees each,
// about x and about y.
constexpr double kLeastFirmness = 0.005;

constexpr const char* kAdvice =
    "Show the board in at least 3 views, tilted differently (30 to 45 degrees, to the left, to the "
    "right, up and down).";

// Each orientation of the plane gives two equations for fx fy cx cy and parallel planes the same
// two (Zhang 2000, section 4.4). The covariance alone would believe a still board seen a hundred
// times.
int orientations(const Fit& fit) {
  constexpr std::size_t kEnough = 3;  // no camera needs more
  std::vector<Eigen::Vector3d> normals;
  for (std::size_t v = 0; v < fit.views.size(); ++v) {
    if (!fit.used[v]) continue;
    const Eigen::Vector3d normal = fit.camera_from_board[v].rotation.col(2);
    const auto parallel = [&normal](const Eigen::Vector3d& other) {
      return normal.cross(other).norm() < std::sin(kParallel);
    };
    if (std::none_of(normals.begin(), normals.end(), parallel)) normals.push_back(normal);
    if (normals.size() == kEnough) break;
  }
  return static_cast<int>(normals.size());
}

// How firmly the boards hold the pinhole, 0 where some change of it leaves every one of them a
// board: with K moved to K (1 + E), the two sides of a board stay at right angles and of one length
// where E + E^T is a multiple of 1 in its plane. The least that a change of fx fy cx cy by its own
// size, in focal lengths, does to that.
double firmness(const Fit& fit, const Parameterization& parameterization) {
  const ParameterRange pinhole = parameterization.table.pinhole(0);
  std::vector<Eigen::Index> columns;
  for (Eigen::Index c = 0; c < parameterization.basis.cols(); ++c) {
    if (moves(parameterization.basis, c, pinhole)) columns.push_back(c);
  }
  if (columns.empty()) return HUGE_VAL;  // all of it is held
  const auto n = static_cast<Eigen::Index>(columns.size());
  Eigen::MatrixXd change(4, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Vector4d by = parameterization.basis.col(columns[static_cast<std::size_t>(i)])
                                   .segment(pinhole.first, pinhole.count);
    change.col(i) = by.normalized();
  }
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(n, n);
  for (std::size_t v = 0; v < fit.views.size(); ++v) {
    if (!fit.used[v]) continue;
    const Eigen::Vector3d x = fit.camera_from_board[v].rotation.col(0);
    const Eigen::Vector3d y = fit.camera_from_board[v].rotation.col(1);
    Eigen::Matrix<double, 2, 4> by;
    by << 2 * x[0] * y[0], 2 * x[1] * y[1], x[0] * y[2] + x[2] * y[0], x[1] * y[2] + x[2] * y[1],
        x[0] * x[0] - y[0] * y[0], x[1] * x[1] - y[1] * y[1], x[0] * x[2] - y[0] * y[2],
        x[1] * x[2] - y[1] * y[2];
    const Eigen::MatrixXd rows = by.lazyProduct(change);
    sum += rows.transpose().lazyProduct(rows);
  }
  const auto views = static_cast<double>(std::count(fit.used.begin(), fit.used.end(), true));
  const auto eigen = symmetric_eigen(sum / views);
  return eigen ? std::sqrt(std::max(eigen->values[0], 0.0)) : 0;
}

// Whether the corners that two views have in common are in about the same places; some of them
// tell.
bool same_place(const PointSet& a, const PointSet& b, double near) {
  constexpr std::size_t kSome = 32;
  bool common = false;
  for (std::size_t i = 0; i < a.size(); i += a.size() / kSome + 1) {
    const auto at = std::find(b.ids.begin(), b.ids.end(), a.ids[i]);
    if (at == b.ids.end()) continue;
    const Pixel& p = b.uv[static_cast<std::size_t>(at - b.ids.begin())];
    if (std::hypot(p.u - a.uv[i].u, p.v - a.uv[i].v) > near) return false;
    common = true;
  }
  return common && a.board == b.board;
}

}  // namespace

tl::unexpected<Error> degenerate(std::string what) {
  return make_error(ErrorCode::kDegenerate, fmt::format("{} {}", what, kAdvice));
}

Status tilted_enough(const Fit& fit, const Parameterization& parameterization) {
  for (std::size_t v = 0; v < fit.views.size(); ++v) {
    if (fit.used[v] && spans_space(fit.views[v])) return {};
  }
  const int seen = orientations(fit);
  if (2 * seen >= parameterization.pinhole_directions()) {
    // Two tilts give just enough equations, and not any two do. The angles of a wide lens, or
    // priors, give more.
    const bool alone = parameterization.lens.perspective && parameterization.table.priors().empty();
    const bool loose = seen == 2 && alone && firmness(fit, parameterization) < kLeastFirmness;
    if (!loose) return {};
    return degenerate(
        "The board is seen at two tilts only, and these two leave more cameras than one.");
  }
  if (seen > 1) {
    return degenerate(fmt::format(
        "The board is seen at {} tilts only, which do not determine a skew beside the camera.",
        seen));
  }
  return degenerate(
      "The board is moved but never tilted: it is parallel to itself in all views, which "
      "determines "
      "no camera.");
}

bool in_one_place(const Fit& fit, ImageSize size) {
  const double near = kOnePlace * std::hypot(size.width, size.height);
  return std::all_of(fit.views.begin(), fit.views.end(), [&](const PointSet& view) {
    return same_place(fit.views.front(), view, near);
  });
}

}  // namespace calvin
