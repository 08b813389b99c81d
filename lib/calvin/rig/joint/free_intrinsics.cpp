// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The least squares over intrinsics and places, from that over the places.

#include "calvin/rig/joint/free_intrinsics.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "calvin/geometry/dense.hpp"
#include "calvin/geometry/symmetric.hpp"

namespace calvin::rig {

namespace {

// What is as good as nothing beside what corners tell: without it equations that leave something
// open would have no solution, and nobody would know what they leave open.
constexpr double kNoPrior = 1e-8;

// The directions of errors of that covariance, each one sigma long.
Eigen::MatrixXd sigmas_long(const Eigen::MatrixXd& covariance) {
  constexpr double kNone = 1e-9;  // of a variance, where the parameters have one
  const Eigen::VectorXd sigma = covariance.diagonal().cwiseSqrt();
  const Eigen::VectorXd scale =
      sigma.unaryExpr([](double s) { return s > 0 ? 1 / s : 0; });  // held ones have none
  const auto eigen = symmetric_eigen(scale.asDiagonal() * covariance * scale.asDiagonal());
  if (!eigen) return Eigen::MatrixXd(covariance.rows(), 0);
  Eigen::MatrixXd all(covariance.rows(), covariance.rows());
  Eigen::Index count = 0;
  for (Eigen::Index i = 0; i < eigen->values.size(); ++i) {
    if (eigen->values[i] < kNone) continue;
    all.col(count++) = std::sqrt(eigen->values[i]) * sigma.cwiseProduct(eigen->vectors.col(i));
  }
  return all.leftCols(count);
}

// Each parameter by itself, and by a part of what it is.
Eigen::MatrixXd one_by_one(const Eigen::VectorXd& values) {
  constexpr double kPart = 0.01;
  constexpr double kLeast = 0.01;
  return values.cwiseAbs()
      .cwiseMax(1.0)
      .unaryExpr([](double v) { return v > 1 ? kPart * v : kLeast; })
      .asDiagonal();
}

// Variances of errors over those that the noise of corners makes.
double growth_of(const Calibration& calibration) {
  constexpr double kMost = 0.99;
  return 1 / (1 - std::clamp(calibration.systematic.value_or(0), 0.0, kMost));
}

bool has_sigmas(const Calibration& calibration) {
  return std::ranges::any_of(calibration.parameters,
                             [](const Parameter& p) { return p.sigma.has_value(); });
}

// The covariance of sigmas alone, where a file has no other. As a prior it is too weak rather than
// too strong, for errors of the parameters of a lens make up for each other.
Eigen::MatrixXd of_sigmas(const Calibration& calibration, const ParameterTable& table,
                          std::size_t camera) {
  const ParameterRange range = table.intrinsics(camera);
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(range.count, range.count);
  for (const Parameter& p : calibration.parameters) {
    const auto at = table.find(p.name, camera);
    if (p.sigma && at) all(*at - range.first, *at - range.first) = *p.sigma * *p.sigma;
  }
  return all;
}

}  // namespace

FreeIntrinsics free_intrinsics(const std::vector<RigCameraViews>& calibrations,
                               const std::vector<Camera>& cameras, std::vector<bool> may_be_free,
                               bool has_prior) {
  const ParameterTable table = table_of(cameras);
  const Eigen::Index count = table.rig_pose(1).first;
  const Eigen::MatrixXd covariance = covariance_of_intrinsics(table, calibrations);
  const std::vector<double> values = values_of_cameras(table, cameras);
  FreeIntrinsics free;
  free.is_free = std::move(may_be_free);
  free.prior = has_prior ? 1 : kNoPrior;
  free.known = Eigen::Map<const Eigen::VectorXd>(values.data(), count);
  free.held = Eigen::MatrixXd::Zero(count, count);
  free.directions = Eigen::MatrixXd::Zero(count, count);
  Eigen::Index used = 0;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    const ParameterRange range = table.intrinsics(c);
    const Eigen::MatrixXd known =
        covariance.block(range.first, range.first, range.count, range.count);
    const bool is_known = has_sigmas(calibrations[c].calibration);
    if (has_prior && !is_known) free.is_free[c] = false;
    if (!free.is_free[c]) {
      free.held.block(range.first, range.first, range.count, range.count) = known;
      continue;
    }
    const Eigen::MatrixXd own =
        !is_known ? one_by_one(free.known.segment(range.first, range.count))
                  : sigmas_long(known.isZero(0) ? of_sigmas(calibrations[c].calibration, table, c)
                                                : known);
    free.directions.block(range.first, used, range.count, own.cols()) = own;
    used += own.cols();
  }
  free.directions.conservativeResize(count, used);
  free.z = Eigen::VectorXd::Zero(used);
  for (const RigCameraViews& one : calibrations) {
    free.growth = std::max(free.growth, growth_of(one.calibration));
  }
  return free;
}

IntrinsicsStep intrinsics_step(const BundleProblem::Reduced& equations, const FreeIntrinsics& free,
                               double variance) {
  variance *= free.growth;
  const Eigen::Index first = free.known.size();
  const Eigen::Index count = free.z.size();
  const Eigen::Index places = equations.information.rows() - first;
  Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(first + places, count + places);
  basis.topLeftCorner(first, count) = free.directions;
  basis.bottomRightCorner(places, places).setIdentity();
  Eigen::MatrixXd information = congruent(equations.information, basis) / variance;
  Eigen::VectorXd gradient = basis.transpose() * equations.gradient / variance;
  information.diagonal().head(count).array() += free.prior;
  gradient.head(count) += free.prior * free.z;
  const Eigen::MatrixXd inverse =
      solve_symmetric(information, Eigen::MatrixXd::Identity(count + places, count + places));
  // Errors of what is held move the optimum, by the implicit function of the gradient.
  const Eigen::MatrixXd moved =
      product(inverse, transposed_product(basis, equations.information.leftCols(first)) / variance);
  const Eigen::MatrixXd covariance = inverse + congruent(free.held, moved.transpose());
  // Errors of the intrinsics are those along the directions and those of what is held.
  const Eigen::MatrixXd with_held = -product(moved, free.held);
  const Eigen::MatrixXd with_intrinsics =
      product(covariance.leftCols(count), free.directions.transpose()) + with_held;
  const Eigen::MatrixXd mixed = product(free.directions, with_held.topRows(count));
  PlaceCovariance known = {
      covariance.bottomRightCorner(places, places), with_intrinsics.bottomRows(places),
      congruent(covariance.topLeftCorner(count, count), free.directions.transpose()) + mixed +
          mixed.transpose() + free.held};
  return {-(inverse * gradient).head(count), covariance.topLeftCorner(count, count),
          std::move(known)};
}

}  // namespace calvin::rig
