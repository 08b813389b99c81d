// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Tests of the residuals by view, by part of the image and by corner of the board, and the
// covariance that follows from them.

#include "calvin/solve/judge/fit_diagnostics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "calvin/geometry/dense.hpp"
#include "calvin/solve/fit/weights.hpp"
#include "calvin/solve/judge/agreement.hpp"
#include "calvin/solve/judge/board_error.hpp"
#include "calvin/solve/judge/contradiction.hpp"
#include "calvin/solve/judge/projection_grid.hpp"
#include "calvin/solve/judge/residual_scores.hpp"
#include "calvin/solve/judge/view_share.hpp"
#include "calvin/solve/linear/grid_kernels.hpp"
#include "calvin/solve/residuals/single_views.hpp"

namespace calvin {

namespace {

// m^T m, three columns at a time.
Eigen::MatrixXd squares_of(const Eigen::MatrixXd& m) {
  constexpr Eigen::Index kAtOnce = 3;
  const Eigen::Index n = m.cols();
  if (n < kAtOnce) return transposed_product(m, m);
  Eigen::MatrixXd sum(n, n);
  for (Eigen::Index at = 0; at < n; at += kAtOnce) {
    const Eigen::Index first = std::min(at, n - kAtOnce);
    Eigen::Matrix3Xd some = Eigen::Matrix3Xd::Zero(kAtOnce, first + kAtOnce);
    add_turn_products(m.col(first).data(), m.data(), static_cast<std::size_t>(m.rows()),
                      static_cast<int>(some.cols()), some.data());
    sum.block(first, 0, kAtOnce, some.cols()) = some;
  }
  return sum.selfadjointView<Eigen::Lower>();
}

// The mean square over the places of the grid of a change d of the directions is d^T M d.
Eigen::MatrixXd projection_metric(const PlacedGrid& grid,
                                  const Parameterization& parameterization) {
  const ParameterRange own = parameterization.table.camera(0);
  const auto n = static_cast<Eigen::Index>(own.count);
  const Eigen::MatrixXd basis = parameterization.basis.middleRows(own.first, n);
  if (grid.at.empty()) return Eigen::MatrixXd::Zero(basis.cols(), basis.cols());
  return congruent(squares_of(grid.u) + squares_of(grid.v), basis) /
         static_cast<double>(grid.at.size());
}

// From unknowns to directions, by the pseudo-inverse of the basis.
Eigen::MatrixXd over_directions(const Eigen::MatrixXd& covariance, const Eigen::MatrixXd& basis) {
  const Eigen::MatrixXd pick = solve_symmetric(transposed_product(basis, basis), basis.transpose());
  return congruent(covariance, pick.transpose());
}

class FitDiagnosis {
 public:
  static constexpr double kUndetermined = std::numeric_limits<double>::infinity();

  FitDiagnosis(const Fit& fit, const Camera& camera, const BoardShape& shape,
               const Parameterization& parameterization, const PlacedGrid& grid,
               const Eigen::MatrixXd& covariance, double variance)
      : fit_(fit),
        camera_(camera),
        shape_(shape),
        parameterization_(parameterization),
        variance_(variance),
        single_(parameterization.table, parameterization.basis, fit.shared),
        covariance_(over_directions(covariance, parameterization.basis)),
        views_(covariance_),
        metric_(congruent(projection_metric(grid, parameterization), views_.root())) {}

  FitDiagnostics run(const std::stop_token& stop) {
    count();
    for (std::size_t v = 0; v < fit_.views.size(); ++v) {
      if (stop.stop_requested()) return {};
      if (fit_.used[v]) add_view(v);
    }
    FitDiagnostics result;
    result.views = views_.chi_square();
    result.views.degrees -= determined_;
    const double kept = std::clamp(1 - unknowns_ / residuals_, 0.1, 1.0);
    result.picture = scores_->picture().chi_square(variance_, kept, 0);
    // Shift, turn and scale of a whole board are explained by poses and focal length.
    constexpr double kRigid = 7;
    // Where each corner has its own offset, the means by corner are 0 anyway.
    if (!offsets_estimated()) {
      const double rigid = kRigid * static_cast<double>(scores_->boards());
      result.board = scores_->board().chi_square(variance_, kept,
                                                 rigid + parameterization_.table.board(0).count);
    }
    result.held_out = std::move(held_out_);
    add_shared(result);
    return result;
  }

 private:
  [[nodiscard]] bool offsets_estimated() const { return fit_.board && fit_.board->estimated; }

  [[nodiscard]] std::vector<SeenOffset> estimated_offsets() const {
    std::vector<SeenOffset> corners;
    for (std::size_t i = 0; i < fit_.board->offsets.size(); ++i) {
      const auto at = 3 * static_cast<Eigen::Index>(i);
      const Eigen::Vector2d variance = fit_.board->covariance.diagonal().segment<2>(at);
      corners.push_back({shape_.grid->place(static_cast<int>(i)), fit_.board->offsets[i].head<2>(),
                         variance.cwiseInverse()});
    }
    return corners;
  }

  // What the views would say were the corners of the board where all of them together see them.
  [[nodiscard]] std::optional<Eigen::MatrixXd> board_known(const FitDiagnostics& found) const {
    const auto known = [&](double of_board) { return variance_ / std::max(of_board, 1e-30); };
    const double in_plane = known(found.board_variance);
    const MeasuredBoard board =
        with_measured_board(fit_, shape_, parameterization_, covariance_ / variance_,
                            {in_plane, in_plane, known(scores_->board_bent().variance())});
    const double degrees = residuals_ - unknowns_;
    const double left = std::min(1.0, board.left * degrees / std::max(1.0, degrees - board.fitted));
    const double noise = left * variance_;
    Contradiction views(left * covariance_);
    for (const auto& [at, view] : reduced_) {
      views.add(views.share(view.information / noise, board.gradients[at] / noise));
    }
    ChiSquare chi_square = views.chi_square();
    chi_square.degrees -= determined_;
    if (chi_square.deviations() > kSignificant) return views.covariance();
    return left * covariance_;
  }

  void add_shared(FitDiagnostics& result) const {
    result.bends_known = fit_.board || !parameterization_.table.warp(0).empty();
    result.picture_agrees = scores_->picture_shared().deviations();
    if (!offsets_estimated()) {
      const double in_plane = scores_->board_shared().deviations();
      result.board_agrees = std::max(in_plane, scores_->board_bent().deviations());
      if (in_plane > kSignificant) {
        result.board_variance = scores_->board_shared().variance();
        if (shape_.grid && scores_->boards() == 1) {
          result.board_pattern =
              board_pattern(*shape_.grid, scores_->offsets(*shape_.grid), OffsetsOf::kResiduals);
        }
      }
    } else if (shape_.grid) {
      result.board_pattern =
          board_pattern(*shape_.grid, estimated_offsets(), OffsetsOf::kMeasurement);
    }
    if (!(predicted_ > 0) || used_ < 2) return;
    result.split_half_ratio = std::sqrt(observed_ / predicted_);
    if (result.views.deviations() > kSignificant) result.views_covariance = views_.covariance();
    if (result.board_variance > 0) result.board_known = board_known(result);
  }

  void count() {
    for (std::size_t v = 0; v < fit_.views.size(); ++v) {
      if (!fit_.used[v]) continue;
      residuals_ += 2 * static_cast<double>(fit_.views[v].used());
      unknowns_ += 6;
      ++used_;
    }
    determined_ =
        static_cast<double>(covariance_.rows()) - determined_by_priors(fit_, parameterization_);
    unknowns_ += determined_ + (fit_.board ? fit_.board->determined : 0);
    scores_.emplace(fit_, camera_.image_size(), residuals_);
  }

  void add_view(std::size_t v) {
    const PointSet& view = fit_.views[v];
    if (!single_.next(view, shape_, fit_.camera_from_board[v])) {
      held_out_.push_back(kUndetermined);
      return;
    }
    auto reduced = single_.reduced();
    held_out_.push_back(reduced ? add_share(*reduced, view) : kUndetermined);
    if (reduced) reduced_.emplace_back(held_out_.size() - 1, *std::move(reduced));
    scores_->add(view, fit_.camera_from_board[v].rotation, single_.rows());
  }

  // Adds what the view says; returns its held-out error.
  double add_share(const BundleProblem::Reduced& view, const PointSet& points) {
    const ViewShare share = views_.share(view.information / variance_, view.gradient / variance_);
    if (!share.valid()) return kUndetermined;
    views_.add(share);
    const Eigen::MatrixXd& a = share.information();
    observed_ += share.gradient().dot(metric_ * share.gradient());
    // The fit to all views has absorbed a part of each: the gradient has the covariance A - A A.
    predicted_ += metric_.cwiseProduct(a).sum() - product(a, metric_).cwiseProduct(a).sum();
    // Without the only view there is nothing but what priors tell.
    const bool rest = used_ > 1 || !parameterization_.table.priors().empty();
    return rest && share.without() ? held_out(view.cost, share, points) : kUndetermined;
  }

  // The optimum without the view is one step away: (1 - A) y = z. The cost is divided by the mean
  // squared weight, which depends on the model, so that the result is in px^2 whatever the model.
  [[nodiscard]] double held_out(double cost, const ViewShare& share, const PointSet& points) const {
    const Eigen::VectorXd& step = *share.without();
    // 2 y^T z + y^T A y, where A y = y - z.
    const double more = variance_ * step.dot(share.gradient() + step);
    double weights = 0;
    for (const double w : points.weight) weights += w * w;
    const auto corners = static_cast<double>(points.used());
    // Rounding may leave less than nothing of corners without noise.
    return std::max(0.0, cost + more) / weights * corners / (corners - RowLayout::kPose / 2.0);
  }

  const Fit& fit_;
  const Camera& camera_;
  const BoardShape& shape_;
  const Parameterization& parameterization_;
  double variance_;
  SingleViews single_;
  Eigen::MatrixXd covariance_;
  Contradiction views_;
  Eigen::MatrixXd metric_;  // projection_metric() in units of what all views say
  std::size_t used_ = 0;    // views
  double residuals_ = 0;
  double unknowns_ = 0;
  double determined_ = 0;  // how many of the directions the corners determine, not the priors
  std::vector<double> held_out_;
  // Of the views used that have one, by their number among those used.
  std::vector<std::pair<std::size_t, BundleProblem::Reduced>> reduced_;
  std::optional<ResidualScores> scores_;
  double observed_ = 0;
  double predicted_ = 0;
};

}  // namespace

FitDiagnostics diagnose(const Fit& fit, const Camera& camera, const BoardShape& shape,
                        const Parameterization& parameterization, const PlacedGrid& covered,
                        const Eigen::MatrixXd& covariance, double variance,
                        const std::stop_token& stop) {
  return FitDiagnosis(fit, camera, shape, parameterization, covered, covariance, variance)
      .run(stop);
}

double board_excess(const FitDiagnostics& found) {
  return found.views_covariance ? std::max(1.0, found.views.ratio()) : 1;
}

namespace {

// How much larger the variance in the plane of a known board is by what the views agree on than it
// is told to be.
double known_excess(const FittedBoard& board, const FitDiagnostics& found) {
  double sum = 0;
  for (Eigen::Index i = 0; i < board.covariance.rows(); i += 3) {
    sum += board.covariance(i, i) + board.covariance(i + 1, i + 1);
  }
  const double mean = sum / (2 * static_cast<double>(board.offsets.size()));
  return mean > 0 ? std::max(1.0, found.board_variance / mean) : 1;
}

}  // namespace

Eigen::MatrixXd honest_covariance(const Fit& fit, const BoardShape& shape,
                                  const Parameterization& parameterization,
                                  const FitDiagnostics& found, const Eigen::MatrixXd& by_noise,
                                  double variance) {
  const Eigen::MatrixXd to_unknowns = parameterization.basis.transpose();
  Eigen::MatrixXd c = by_noise;
  if (found.views_covariance) c = congruent(*found.views_covariance, to_unknowns);
  if (fit.board) {
    const double scale =
        fit.board->estimated ? board_excess(found) * variance : known_excess(*fit.board, found);
    return c + scale * congruent(fit.board->of_directions, to_unknowns);
  }
  if (found.board_variance > 0) {
    const Eigen::MatrixXd of_board = board_covariance(fit, shape, parameterization);
    c += found.board_variance * congruent(of_board, to_unknowns);
  }
  return c;
}

}  // namespace calvin
