// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The information of a view from the rows of the least squares, and the choice of the views.

#include "calvin/solve/view_information.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "calvin/geometry/symmetric.hpp"
#include "calvin/solve/judge/projection_grid.hpp"
#include "calvin/solve/linear/cholesky.hpp"
#include "calvin/solve/linear/products.hpp"
#include "calvin/solve/linear/scaled_solve.hpp"
#include "calvin/solve/parameters/parameterization.hpp"
#include "calvin/solve/residuals/points.hpp"
#include "calvin/solve/residuals/view_points.hpp"
#include "calvin/solve/residuals/view_rows.hpp"

namespace calvin {

namespace {

using Matrix = Eigen::MatrixXd;

// 1 sigma of what is known before, by kind of parameter.
constexpr double kFocal = 1;           // of the focal length
constexpr double kCenter = 0.25;       // of the picture's size
constexpr double kCoefficient = 1;     // of the lens, about its value
constexpr double kSkewOfFocal = 0.01;  // of the focal length

Eigen::VectorXd prior_of(const Camera& camera, const CameraUnknowns& unknowns) {
  Eigen::VectorXd sigma = Eigen::VectorXd::Constant(unknowns.all().count, kCoefficient);
  sigma[unknowns.focal()[0]] = kFocal * camera.fx();
  sigma[unknowns.focal()[1]] = kFocal * camera.fy();
  sigma[unknowns.center()[0]] = kCenter * camera.image_size().width;
  sigma[unknowns.center()[1]] = kCenter * camera.image_size().height;
  if (!unknowns.skew().empty()) sigma[unknowns.skew().first] = kSkewOfFocal * camera.fx();
  return sigma.array().square().inverse();
}

std::vector<int> columns_of(const CameraUnknowns& unknowns) {
  std::vector<int> columns(static_cast<std::size_t>(unknowns.intrinsics().count));
  std::iota(columns.begin(), columns.end(), 0);
  if (!unknowns.skew().empty()) columns.push_back(kSkewColumn);
  return columns;
}

// What is left of the products of all columns when those of the pose are eliminated. The columns
// are those of RowLayout, without the residuals.
std::optional<Matrix> without_pose(const double* products, std::size_t stride, int shared) {
  constexpr int kPose = RowLayout::kPose;
  const auto product = [&](int i, int j) {
    return products[static_cast<std::size_t>(i) * stride + static_cast<std::size_t>(j)];
  };
  double pose[kPose * kPose];
  for (int i = 0; i < kPose; ++i) {
    for (int j = 0; j <= i; ++j) pose[i * kPose + j] = product(i, j);
  }
  double factor[kPose * kPose];
  if (!cholesky_of<kPose>(pose, 0, factor)) return std::nullopt;
  Eigen::Matrix<double, kPose, Eigen::Dynamic> reduced(kPose, shared);
  for (int i = 0; i < shared; ++i) {
    double* column = reduced.col(i).data();
    for (int j = 0; j < kPose; ++j) column[j] = product(RowLayout::kFirstShared + i, j);
    solve_lower<kPose>(factor, column);
  }
  Matrix left(shared, shared);
  for (int i = 0; i < shared; ++i) {
    for (int j = 0; j <= i; ++j) {
      left(i, j) = product(RowLayout::kFirstShared + i, RowLayout::kFirstShared + j) -
                   reduced.col(i).dot(reduced.col(j));
      left(j, i) = left(i, j);
    }
  }
  return left;
}

// R with R^T R = m for a symmetric m without negative eigenvalues, but for rounding.
Result<Matrix> factor_of(const Matrix& m) {
  const auto eigen = symmetric_eigen(m);
  if (!eigen) return make_error(ErrorCode::kInvalidArgument, "The camera projects to no numbers.");
  return Matrix(eigen->values.cwiseMax(0).cwiseSqrt().asDiagonal() * eigen->vectors.transpose());
}

}  // namespace

Result<ViewScorer> ViewScorer::make(const Camera& camera, const SolveOptions& options) {
  SolveOptions asked = options;
  asked.model = camera.model();
  asked.initial = camera.to_calibration();
  asked.readout.reset();
  const auto parameters = make_parameterization(asked, camera.image_size());
  if (!parameters) return tl::unexpected<Error>(parameters.error());
  const CameraUnknowns unknowns = parameters->table.unknowns(0);
  ViewScorer scorer;
  scorer.camera_ = camera;
  scorer.basis_ = parameters->basis;
  const Matrix prior = prior_of(camera, unknowns).asDiagonal();
  scorer.prior_ = restrict_to(scorer.basis_, prior);
  Matrix weight = Matrix::Zero(unknowns.all().count, unknowns.all().count);
  const ProjectionGrid grid = projection_grid(camera, columns_of(unknowns));
  for (const auto& cell : grid) weight += cell.transpose().lazyProduct(cell);
  weight /= 2.0 * static_cast<double>(std::max<std::size_t>(grid.size(), 1));
  auto root = factor_of(restrict_to(scorer.basis_, weight));
  if (!root) return tl::unexpected<Error>(root.error());
  scorer.weight_root_ = *std::move(root);
  return scorer;
}

std::optional<Matrix> ViewScorer::information(const View& view,
                                              const SE3& camera_from_board) const {
  if (!view.observation.found() || !check_before_camera(view, camera_->image_size()))
    return std::nullopt;
  const PointSet set = to_points(view.board, view.board.points(), view.observation);
  const ViewPoints points(set, {});
  const auto intrinsics = camera_->parameters().size();
  const auto shared = static_cast<int>(basis_.rows());
  ViewRows rows({CameraUnknowns::of(intrinsics, shared > static_cast<int>(intrinsics)), 0});
  rows.resize(points.padded());
  const RowPoint at = {camera_->parameters().data(), camera_->skew(), nullptr};
  if (!fill_rows_of(camera_->model())(points, at, camera_from_board, {}, rows, RowContent::kAll)
           .valid) {
    return std::nullopt;
  }
  const auto columns = static_cast<std::size_t>(rows.layout().columns());
  const std::size_t stride = (columns + kLanes - 1) / kLanes * kLanes;
  std::vector<double> products(stride * stride);
  column_products(rows.data(), 2 * rows.padded(), rows.layout().columns(), products.data(), stride);
  const auto information = without_pose(products.data(), stride, shared);
  if (!information || !information->allFinite()) return std::nullopt;
  return restrict_to(basis_, *information);
}

// The trace of F^T C F, where the weight is F F^T and the covariance C the inverse of L L^T, is the
// sum of squares of L^-1 F. A factorisation that goes on through the rows of F^T gives them in its
// last rows.
double ViewScorer::variance(const Matrix& information) const {
  const Eigen::Index n = information.cols();
  Matrix l(n + weight_root_.rows(), n);
  l << information, weight_root_;
  for (Eigen::Index j = 0; j < n; ++j) {
    auto column = l.col(j).tail(l.rows() - j);
    for (Eigen::Index k = 0; k < j; ++k) column -= l(j, k) * l.col(k).tail(l.rows() - j);
    if (!(column[0] > 0) || !std::isfinite(column[0])) return HUGE_VAL;
    column *= 1 / std::sqrt(column[0]);
  }
  const double variance = l.bottomRows(weight_root_.rows()).squaredNorm();
  return std::isfinite(variance) ? variance : HUGE_VAL;
}

std::vector<std::size_t> most_informative(const ViewScorer& scorer, std::span<const Matrix> views,
                                          std::size_t count) {
  std::vector<std::size_t> chosen;
  std::vector<bool> taken(views.size(), false);
  Matrix sum = scorer.prior();
  // The view that lowers the variance most when it is added to `known`.
  const auto best = [&](const Matrix& known) {
    std::pair<double, std::size_t> least = {HUGE_VAL, views.size()};
    for (std::size_t i = 0; i < views.size(); ++i) {
      if (!taken[i]) least = std::min(least, {scorer.variance(known + views[i]), i});
    }
    return least;
  };
  while (chosen.size() < std::min(count, views.size())) {
    const auto [variance, i] = best(sum);
    if (i == views.size()) break;
    chosen.push_back(i);
    taken[i] = true;
    sum += views[i];
  }
  // Each exchange lowers the variance, which ends; a cap guards against rounding.
  bool better = chosen.size() < views.size();
  for (int round = 0; better && round < 10; ++round) {
    better = false;
    for (std::size_t& place : chosen) {
      const double now = scorer.variance(sum);
      const Matrix others = sum - views[place];
      const auto [variance, i] = best(others);
      if (!(variance < now * (1 - 1e-9))) continue;
      taken[place] = false;
      taken[i] = true;
      place = i;
      sum = others + views[i];
      better = true;
    }
  }
  std::ranges::sort(chosen);
  return chosen;
}

}  // namespace calvin
