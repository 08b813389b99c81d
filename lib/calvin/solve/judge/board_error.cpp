// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The derivatives of the optimum by the places of corners on their boards.

#include "calvin/solve/judge/board_error.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "calvin/geometry/dense.hpp"
#include "calvin/solve/fit/fit_derivatives.hpp"
#include "calvin/solve/linear/scaled_solve.hpp"
#include "calvin/solve/residuals/view_rows.hpp"

namespace calvin {

namespace {

// Along x and y of the board. Offsets out of its plane are the curvatures', which are unknowns.
constexpr Eigen::Index kAxes = 2;

// The first corner of each board among the corners of all, and how many these are.
std::map<std::size_t, Eigen::Index> first_corners(const Fit& fit, Eigen::Index& count) {
  std::map<std::size_t, Eigen::Index> ids;
  for (std::size_t v = 0; v < fit.views.size(); ++v) {
    if (!fit.used[v]) continue;
    Eigen::Index& most = ids[fit.views[v].board];
    for (const int id : fit.views[v].ids) most = std::max<Eigen::Index>(most, id + 1);
  }
  count = 0;
  for (auto& [board, corners] : ids) count += std::exchange(corners, count);
  return ids;
}

// Calls `use` with the derivatives of each view used, whose ids are made those among the corners of
// all boards.
template <typename Use>
void for_views(const Fit& fit, const BoardShape& shape, const Parameterization& parameterization,
               const std::map<std::size_t, Eigen::Index>& first, Use use) {
  for_view_derivatives(fit, shape, parameterization, [&](ViewDerivatives by) {
    const auto before = static_cast<int>(first.at(fit.views[by.view].board));
    for (int& id : by.ids) id += before;
    use(std::move(by));
  });
}

// Least squares over the corners of all boards, three numbers each, and the directions, the poses
// eliminated, by conjugate gradients.
class BoardSolve {
 public:
  struct Unknowns {
    Eigen::Matrix3Xd corners;
    Eigen::VectorXd directions;

    [[nodiscard]] double dot(const Unknowns& other) const {
      return corners.cwiseProduct(other.corners).sum() + directions.dot(other.directions);
    }
    void add(double factor, const Unknowns& other) {
      corners += factor * other.corners;
      directions += factor * other.directions;
    }
  };

  BoardSolve(std::vector<ViewDerivatives> views, Eigen::Index corners,
             const Parameterization& parameterization, const Eigen::MatrixXd& inverse,
             const Eigen::Vector3d& known)
      : views_(std::move(views)),
        basis_(parameterization.basis),
        inverse_(inverse),
        known_(known.replicate(1, corners)),
        information_(Eigen::Matrix3Xd::Zero(3, corners)) {
    for (const ViewDerivatives& view : views_) {
      for_corners(view, [&](Eigen::Index corner, Eigen::Index row) {
        information_.col(corner) += view.along.row(row).transpose().cwiseAbs2();
      });
    }
  }

  // The residuals of each view that are left.
  std::vector<Eigen::VectorXd> run() {
    constexpr int kRounds = 60;
    constexpr double kSmall = 1e-6;  // of the first step's square
    Unknowns at = zero();
    Unknowns left = gradient([](const ViewDerivatives& view) { return view.residual; });
    Unknowns step = preconditioned(left);
    double size = left.dot(step);
    const double first = size;
    for (int i = 0; i < kRounds && size > kSmall * first; ++i) {
      Unknowns curved = gradient([&](const ViewDerivatives& view) { return moved(view, step); });
      curved.corners += known_.cwiseProduct(step.corners);
      const double along = step.dot(curved);
      if (!(along > 0)) break;
      at.add(size / along, step);
      left.add(-size / along, curved);
      Unknowns next = preconditioned(left);
      const double smaller = left.dot(next);
      next.add(smaller / size, step);
      step = std::move(next);
      size = smaller;
    }
    std::vector<Eigen::VectorXd> residuals;
    residuals.reserve(views_.size());
    for (const ViewDerivatives& view : views_) {
      residuals.emplace_back(view.residual - moved(view, at));
    }
    return residuals;
  }

  [[nodiscard]] const std::vector<ViewDerivatives>& views() const { return views_; }
  [[nodiscard]] double fitted() const {
    return information_.cwiseQuotient(information_ + known_).sum();
  }

 private:
  // Calls `use` with each corner that a view shows and each of its two rows.
  template <typename Use>
  static void for_corners(const ViewDerivatives& view, Use use) {
    for (std::size_t i = 0; i < view.ids.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      use(view.ids[i], row);
      use(view.ids[i], view.height() + row);
    }
  }

  [[nodiscard]] Unknowns zero() const {
    return {Eigen::Matrix3Xd::Zero(3, known_.cols()), Eigen::VectorXd::Zero(inverse_.rows())};
  }

  [[nodiscard]] Unknowns preconditioned(const Unknowns& u) const {
    return {u.corners.cwiseQuotient(information_ + known_), inverse_ * u.directions};
  }

  [[nodiscard]] Eigen::VectorXd moved(const ViewDerivatives& view, const Unknowns& by) const {
    Eigen::VectorXd moved = Eigen::VectorXd::Zero(view.residual.size());
    for_corners(view, [&](Eigen::Index corner, Eigen::Index row) {
      moved[row] = view.along.row(row) * by.corners.col(corner);
    });
    moved -= view.pose * (view.to_pose * moved);
    return moved + view.shared * (basis_ * by.directions);
  }

  template <typename Residual>
  [[nodiscard]] Unknowns gradient(Residual residual) const {
    Unknowns sum = zero();
    for (const ViewDerivatives& view : views_) {
      const Eigen::VectorXd r = residual(view);
      for_corners(view, [&](Eigen::Index corner, Eigen::Index row) {
        sum.corners.col(corner) += view.along.row(row).transpose() * r[row];
      });
      sum.directions += basis_.transpose() * (view.shared.transpose() * r);
    }
    return sum;
  }

  std::vector<ViewDerivatives> views_;
  const Eigen::MatrixXd& basis_;
  const Eigen::MatrixXd& inverse_;
  Eigen::Matrix3Xd known_;
  Eigen::Matrix3Xd information_;
};

}  // namespace

Eigen::MatrixXd board_covariance(const Fit& fit, const BoardShape& shape,
                                 const Parameterization& parameterization) {
  Eigen::Index corners = 0;
  const auto first = first_corners(fit, corners);
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(row_layout(parameterization.table, 0, 0).shared(),
                                              kAxes * corners);  // J^T A
  for_views(fit, shape, parameterization, first, [&sum](const ViewDerivatives& by) {
    for (std::size_t i = 0; i < by.ids.size(); ++i) {
      const auto u = static_cast<Eigen::Index>(i);
      const Eigen::Index v = by.height() + u;
      const Eigen::Index at = kAxes * by.ids[i];
      for (Eigen::Index k = 0; k < kAxes; ++k) {
        sum.col(at + k) += by.along(u, k) * by.shared.row(u).transpose() +
                           by.along(v, k) * by.shared.row(v).transpose();
      }
    }
  });
  const auto moves =
      scaled_solve(fit.information, transposed_product(parameterization.basis, sum), kLeastPivot);
  const Eigen::Index n = fit.information.rows();
  return moves ? product(*moves, moves->transpose()) : Eigen::MatrixXd::Zero(n, n);
}

MeasuredBoard with_measured_board(const Fit& fit, const BoardShape& shape,
                                  const Parameterization& parameterization,
                                  const Eigen::MatrixXd& inverse, const Eigen::Vector3d& known) {
  Eigen::Index corners = 0;
  const auto first = first_corners(fit, corners);
  std::vector<ViewDerivatives> views;
  for_views(fit, shape, parameterization, first,
            [&views](ViewDerivatives by) { views.push_back(std::move(by)); });
  BoardSolve solve(std::move(views), corners, parameterization, inverse, known);
  const auto residuals = solve.run();
  MeasuredBoard result;
  result.fitted = solve.fitted();
  double before = 0;
  double after = 0;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    const ViewDerivatives& view = solve.views()[i];
    before += view.residual.squaredNorm();
    after += residuals[i].squaredNorm();
    result.gradients.emplace_back(parameterization.basis.transpose() *
                                  (view.shared.transpose() * residuals[i]));
  }
  result.left = before > 0 ? after / before : 1;
  return result;
}

}  // namespace calvin
