// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The normal equations of a board's points, each of which few residuals depend on, and their steps.

#include "calvin/solve/fit/board_fit.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/LU>

#include "calvin/geometry/dense.hpp"
#include "calvin/solve/fit/fit_derivatives.hpp"
#include "calvin/solve/linear/scaled_solve.hpp"
#include "calvin/target/measured/board_fields.hpp"

namespace calvin {

namespace {

Eigen::VectorXd flat(const std::vector<Eigen::Vector3d>& offsets) {
  Eigen::VectorXd values(3 * static_cast<Eigen::Index>(offsets.size()));
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    values.segment<3>(3 * static_cast<Eigen::Index>(i)) = offsets[i];
  }
  return values;
}

Eigen::MatrixXd inverse(const Eigen::MatrixXd& m) {
  const auto found = scaled_solve(m, Eigen::MatrixXd::Identity(m.rows(), m.rows()), 0);
  return found ? *found : Eigen::MatrixXd::Zero(m.rows(), m.rows());
}

// The sums of all views by the places of points, before the directions are eliminated.
struct PointSums {
  Eigen::MatrixXd information;  // by points, the poses eliminated
  Eigen::MatrixXd mixed;        // directions by points
  Eigen::VectorXd gradient;

  PointSums(Eigen::Index numbers, Eigen::Index directions)
      : information(Eigen::MatrixXd::Zero(numbers, numbers)),
        mixed(Eigen::MatrixXd::Zero(directions, numbers)),
        gradient(Eigen::VectorXd::Zero(numbers)) {}

  void add(const ViewDerivatives& by, const Eigen::MatrixXd& basis) {
    const Eigen::MatrixXd shared = product(by.shared, basis);
    const Eigen::VectorXd residual = by.residual - by.pose * (by.to_pose * by.residual);
    const auto n = static_cast<Eigen::Index>(by.ids.size());
    Eigen::MatrixXd to_pose(6, 3 * n);  // the pose that follows points
    Eigen::MatrixXd pose(6, 3 * n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto at = 3 * static_cast<Eigen::Index>(by.ids[static_cast<std::size_t>(i)]);
      to_pose.middleCols<3>(3 * i).setZero();
      pose.middleCols<3>(3 * i).setZero();
      for (const Eigen::Index row : {i, by.height() + i}) {
        const Eigen::RowVector3d along = by.along.row(row);
        information.block<3, 3>(at, at) += along.transpose() * along;
        mixed.middleCols<3>(at) += shared.row(row).transpose() * along;
        gradient.segment<3>(at) += along.transpose() * residual[row];
        to_pose.middleCols<3>(3 * i) += by.to_pose.col(row) * along;
        pose.middleCols<3>(3 * i) += by.pose.row(row).transpose() * along;
      }
    }
    const Eigen::MatrixXd absorbed = transposed_product(pose, to_pose);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto at = 3 * static_cast<Eigen::Index>(by.ids[static_cast<std::size_t>(i)]);
      for (Eigen::Index k = 0; k < n; ++k) {
        const auto to = 3 * static_cast<Eigen::Index>(by.ids[static_cast<std::size_t>(k)]);
        information.block<3, 3>(at, to) -= absorbed.block<3, 3>(3 * i, 3 * k);
      }
    }
  }
};

}  // namespace

BoardFit::BoardFit(const BoardMeasurement& prior)
    : prior_(prior),
      printed_(prior.board.points()),
      basis_(offset_basis(prior.board)),
      curvatures_(transposed_product(basis_, curvature_fields(prior.board))),
      prior_covariance_(congruent(prior.covariance, basis_)),
      offsets_(flat(prior.offsets)) {}

BoardFit::BoardFit(const BoardMeasurement& prior, const BoardWarp& start) : BoardFit(prior) {
  offsets_ = basis_ * (curvatures_ * Eigen::Vector2d(start.kx, start.ky));
}

void BoardFit::place(std::vector<PointSet>& views) const {
  const Eigen::MatrixXd squares = transposed_product(curvatures_, curvatures_);
  const Eigen::VectorXd bends =
      solve_symmetric(squares, curvatures_.transpose() * (basis_.transpose() * offsets_).eval());
  // The curvatures of BoardWarp have a height, which those among the offsets leave to the pose.
  const Eigen::VectorXd bent = curvature_fields(prior_.board) * bends;
  const Eigen::VectorXd all = offsets_ + bent - basis_ * (curvatures_ * bends);
  for (PointSet& view : views) {
    const Eigen::VectorXd& offsets = view.ambiguous ? bent : all;
    for (std::size_t i = 0; i < view.size(); ++i) {
      const auto id = static_cast<std::size_t>(view.ids[i]);
      view.points[i] = printed_[id] + offsets.segment<3>(3 * static_cast<Eigen::Index>(id));
    }
  }
}

bool BoardFit::linearise(const Fit& fit, const BoardShape& shape,
                         const Parameterization& parameterization) {
  const Eigen::Index directions = fit.information.rows();
  PointSums sums(offsets_.size(), directions);
  double corners = 0;
  double views = 0;
  for_view_derivatives(fit, shape, parameterization, [&](const ViewDerivatives& by) {
    corners += static_cast<double>(by.ids.size());
    views += 1;
    if (!fit.views[by.view].ambiguous) sums.add(by, parameterization.basis);
  });
  const Eigen::MatrixXd mixed = product(sums.mixed, basis_);
  const auto moves = scaled_solve(fit.information, -mixed, kLeastPivot);
  if (!moves) return false;
  moves_ = *moves;
  information_ = congruent(sums.information, basis_) + transposed_product(mixed, moves_);
  gradient_ = basis_.transpose() * sums.gradient;
  cost_ = fit.cost;
  degrees_ = 2 * corners - 6 * views - static_cast<double>(directions);
  return true;
}

std::optional<double> BoardFit::find_step(double sigma) {
  if (prior_information_.size() == 0) prior_information_ = inverse(prior_covariance_);
  variance_ = sigma * sigma;
  whole_ = information_ + variance_ * prior_information_;
  const Eigen::VectorXd off = basis_.transpose() * (offsets_ - flat(prior_.offsets));
  const auto step = scaled_solve(whole_, -(gradient_ + variance_ * (prior_information_ * off)), 0);
  if (!step || !step->allFinite()) return std::nullopt;
  step_ = step->col(0);
  return step_.dot(whole_ * step_);
}

void BoardFit::take_step() { offsets_ += basis_ * step_; }

// The views alone say that the offsets are x more than those of the prior. What x has in common
// with the offsets of the prior, and how much more the board is bent, are told by least squares
// over three numbers with the errors of both. The errors of the prior are a part of its offsets,
// which x takes back of any board: of one that was printed exactly, all of them.
bool BoardFit::contradicts_prior() const {
  constexpr double kOtherBoard = 0.5;  // of the offsets: half way to a board as it was printed
  constexpr double kSure = 3;          // deviations
  constexpr double kSureBend = 25;     // chi^2 of the two curvatures
  constexpr double kLeastBend = 0.05;  // of a bend that a board may have: less hardly matters
  constexpr double kFarOff = 9;        // squared deviations, of all numbers on average
  const auto numbers = static_cast<double>(gradient_.size());
  if (degrees_ < 1.5 * numbers) return false;
  const double wide = wide_curvature(prior_.board);
  Eigen::MatrixXd by_views = information_;
  by_views.diagonal().array() += cost_ / degrees_ / (wide * wide);
  const auto more = scaled_solve(by_views, -gradient_, 0);
  if (!more) return false;
  const double left = cost_ + gradient_.dot(more->col(0));
  const double noise = std::max(left / (degrees_ - numbers), 0.0);
  const Eigen::VectorXd known = basis_.transpose() * flat(prior_.offsets);
  Eigen::MatrixXd fields(known.size(), 3);
  const Eigen::MatrixXd squares = transposed_product(curvatures_, curvatures_);
  fields.col(0) = known - curvatures_ * solve_symmetric(squares, curvatures_.transpose() * known);
  fields.rightCols<2>() = curvatures_;
  const Eigen::MatrixXd seen = product(by_views, fields);
  const Eigen::Matrix3d inverse_seen = inverse(transposed_product(fields, seen));
  const Eigen::Vector3d found = inverse_seen * (seen.transpose() * more->col(0));
  const Eigen::Matrix3d spread =
      noise * inverse_seen + inverse_seen * congruent(prior_covariance_, seen) * inverse_seen;
  const double errors = by_views.cwiseProduct(prior_covariance_).sum();
  const double taken_back = std::min(errors / fields.col(0).dot(seen.col(0)), 1.0);
  const double lacks = -found[0] - taken_back;
  if (lacks > kOtherBoard && lacks > kSure * std::sqrt(spread(0, 0))) return true;
  const Eigen::Vector2d bend = found.tail<2>();
  const double bends = bend.dot(spread.bottomRightCorner<2, 2>().inverse() * bend);
  if (bends > kSureBend && bend.norm() > kLeastBend * wide) return true;
  const auto whitened =
      scaled_solve(noise * by_views + congruent(prior_covariance_, by_views), gradient_, 0);
  return whitened && gradient_.dot(whitened->col(0)) > kFarOff * numbers;
}

FittedBoard BoardFit::known() const {
  FittedBoard board;
  board.offsets = prior_.offsets;
  board.covariance = prior_.covariance;
  board.of_directions = congruent(prior_covariance_, moves_.transpose());
  return board;
}

FittedBoard BoardFit::fitted() const {
  const Eigen::MatrixXd covariance = inverse(whole_);
  FittedBoard board;
  board.estimated = true;
  for (std::size_t i = 0; i < printed_.size(); ++i) {
    board.offsets.emplace_back(offsets_.segment<3>(3 * static_cast<Eigen::Index>(i)));
  }
  board.covariance = congruent(covariance, basis_.transpose());
  board.of_directions = congruent(covariance, moves_.transpose());
  board.determined = static_cast<double>(step_.size()) -
                     variance_ * covariance.cwiseProduct(prior_information_).sum();
  return board;
}

}  // namespace calvin
