// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Tests of the residuals by view, by part of the image and by corner of the board, and the
// covariance that follows from them.

#include "calvin/solve/judge/fit_diagnostics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "calvin/camera/image_transform.hpp"
#include "calvin/geometry/dense.hpp"
#include "calvin/geometry/symmetric.hpp"
#include "calvin/solve/fit/weights.hpp"
#include "calvin/solve/judge/agreement.hpp"
#include "calvin/solve/judge/board_error.hpp"
#include "calvin/solve/judge/contradiction.hpp"
#include "calvin/solve/judge/projection_grid.hpp"
#include "calvin/solve/linear/scaled_solve.hpp"
#include "calvin/solve/residuals/bundle_problem.hpp"

namespace calvin {

namespace {

// Corners in each part of the image, on average.
constexpr double kCornersPerPart = 40;

// The mean square over the places of the grid of a change d of the directions is d^T M d.
Eigen::MatrixXd projection_metric(const PlacedGrid& grid,
                                  const Parameterization& parameterization) {
  const ParameterRange own = parameterization.table.camera(0);
  const auto n = static_cast<Eigen::Index>(own.count);
  const Eigen::MatrixXd basis = parameterization.basis.middleRows(own.first, n);
  if (grid.at.empty()) return Eigen::MatrixXd::Zero(basis.cols(), basis.cols());
  const Eigen::MatrixXd sum =
      product(grid.u.transpose(), grid.u) + product(grid.v.transpose(), grid.v);
  return congruent(sum, basis) / static_cast<double>(grid.at.size());
}

// Residuals in groups whose means should be 0: per group the score of a shift and its information.
class Scores {
 public:
  // Adds a residual to the group `part` of the image or board with the number `of`.
  void add(std::size_t of, int part, double score, double information) {
    if (scores_.size() <= of) scores_.resize(of + 1);
    auto& parts = scores_[of];
    const auto at = static_cast<std::size_t>(part);
    if (parts.size() <= at) parts.resize(at + 1);
    parts[at].sum += score;
    parts[at].information += information;
  }
  // `kept` is the share of the variance that the fit leaves in residuals; `absorbed` is the number
  // of means that the unknowns of the fit have set to 0.
  [[nodiscard]] ChiSquare chi_square(double variance, double kept, double absorbed) const {
    ChiSquare result;
    double largest = 0;
    for (const auto& parts : scores_) {
      for (const Score& score : parts) largest = std::max(largest, score.information);
    }
    for (const auto& parts : scores_) {
      for (const Score& score : parts) {
        if (!(score.information > 0) || score.information < 1e-3 * largest) continue;
        result.sum += score.sum * score.sum / (score.information * variance * kept);
        result.degrees += 1;
      }
    }
    result.degrees = std::max(0.0, result.degrees - absorbed);
    return result;
  }

 private:
  struct Score {
    double sum = 0;
    double information = 0;
  };
  std::vector<std::vector<Score>> scores_;  // by `of`, then by `part`
};

class FitDiagnosis {
  static constexpr std::size_t kAxes = 2;  // of a board, in its plane

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
        rows_(row_layout(parameterization.table, 0, 0)),
        metric_(projection_metric(grid, parameterization)) {
    // From unknowns to directions, by the pseudo-inverse of the basis.
    const Eigen::MatrixXd& basis = parameterization.basis;
    const Eigen::MatrixXd pick =
        solve_symmetric(product(basis.transpose(), basis), basis.transpose());
    covariance_ = congruent(covariance, pick.transpose());
  }

  FitDiagnostics run(const std::stop_token& stop) {
    count();
    for (std::size_t v = 0; v < fit_.views.size(); ++v) {
      if (stop.stop_requested()) return {};
      if (fit_.used[v]) add_view(v);
    }
    FitDiagnostics result;
    result.views = views_->chi_square();
    result.views.degrees -= determined_;
    const double kept = std::clamp(1 - unknowns_ / residuals_, 0.1, 1.0);
    result.picture = picture_.chi_square(variance_, kept, 0);
    // Shift, turn and scale of a whole board are explained by poses and focal length.
    constexpr double kRigid = 7;
    // Where each corner has its own offset, the means by corner are 0 anyway.
    if (!offsets_estimated()) {
      const double rigid = kRigid * static_cast<double>(parts_.size());
      result.board =
          board_.chi_square(variance_, kept, rigid + parameterization_.table.board(0).count);
    }
    result.held_out = std::move(held_out_);
    add_shared(result);
    return result;
  }

 private:
  [[nodiscard]] bool offsets_estimated() const { return fit_.board && fit_.board->estimated; }

  // What the views would say were the corners of the board where all of them together see them.
  [[nodiscard]] std::optional<Eigen::MatrixXd> board_known(const FitDiagnostics& found) const {
    const auto known = [&](double of_board) { return variance_ / std::max(of_board, 1e-30); };
    const double in_plane = known(found.board_variance);
    const MeasuredBoard board =
        with_measured_board(fit_, shape_, parameterization_, covariance_ / variance_,
                            {in_plane, in_plane, known(board_bent_.variance())});
    const double degrees = residuals_ - unknowns_;
    const double left = std::min(1.0, board.left * degrees / std::max(1.0, degrees - board.fitted));
    const double noise = left * variance_;
    Contradiction views(left * covariance_);
    for (const auto& [at, view] : reduced_) {
      views.add(view.information / noise, board.gradients[at] / noise);
    }
    ChiSquare chi_square = views.chi_square();
    chi_square.degrees -= determined_;
    if (chi_square.deviations() > kSignificant) return views.covariance();
    return left * covariance_;
  }

  void add_shared(FitDiagnostics& result) const {
    result.bends_known = fit_.board || !parameterization_.table.warp(0).empty();
    result.picture_agrees = picture_shared_.deviations();
    if (!offsets_estimated()) {
      const double in_plane = board_shared_.deviations();
      result.board_agrees = std::max(in_plane, board_bent_.deviations());
      if (in_plane > kSignificant) result.board_variance = board_shared_.variance();
    }
    if (!(predicted_ > 0) || used_ < 2) return;
    result.split_half_ratio = std::sqrt(observed_ / predicted_);
    if (result.views.deviations() > kSignificant) result.views_covariance = views_->covariance();
    if (result.board_variance > 0) result.board_known = board_known(result);
  }

  void count() {
    for (std::size_t v = 0; v < fit_.views.size(); ++v) {
      if (!fit_.used[v]) continue;
      residuals_ += 2 * static_cast<double>(fit_.views[v].used());
      unknowns_ += 6;
      ++used_;
      std::size_t& corners = parts_[fit_.views[v].board];
      for (const int id : fit_.views[v].ids) {
        corners = std::max(corners, static_cast<std::size_t>(id) + 1);
      }
    }
    std::size_t first = 0;
    for (auto& [board, corners] : parts_) first += kAxes * std::exchange(corners, first);
    views_.emplace(covariance_);
    determined_ =
        static_cast<double>(covariance_.rows()) - determined_by_priors(fit_, parameterization_);
    unknowns_ += determined_ + (fit_.board ? fit_.board->determined : 0);
    const double parts = std::clamp(residuals_ / 2 / kCornersPerPart, 1.0, 400.0);
    const double aspect =
        static_cast<double>(camera_.image_size().width) / camera_.image_size().height;
    across_ = std::max(1, static_cast<int>(std::lround(std::sqrt(parts * aspect))));
    down_ = std::max(1, static_cast<int>(std::lround(std::sqrt(parts / aspect))));
  }

  void add_view(std::size_t v) {
    const ViewPoints points(fit_.views[v], shape_);
    BundleProblem problem({{{&points}}, {}},
                          {&parameterization_.table, parameterization_.basis, {}},
                          {fit_.shared, {fit_.camera_from_board[v]}, {}, {}}, Loss{});
    if (!problem.valid()) {
      held_out_.push_back(kUndetermined);
      return;
    }
    auto reduced = problem.reduced();
    // Without the only view there is nothing but what priors tell.
    const bool rest = used_ > 1 || !parameterization_.table.priors().empty();
    held_out_.push_back(reduced && rest ? held_out(*reduced, fit_.views[v]) : kUndetermined);
    if (reduced) {
      add_view(*reduced);
      reduced_.emplace_back(held_out_.size() - 1, *std::move(reduced));
    }
    add_residuals(v, points);
  }

  // The optimum without the view is one step away: (H - I) d = g. The cost is divided by the mean
  // squared weight, which depends on the model, so that the result is in px^2 whatever the model.
  double held_out(const BundleProblem::Reduced& view, const PointSet& points) const {
    const auto step = scaled_solve(fit_.information - view.information, view.gradient, 0);
    if (!step) return kUndetermined;
    const Eigen::VectorXd d = step->col(0);
    // Rounding may leave less than nothing of corners without noise.
    const double cost =
        std::max(0.0, view.cost + 2 * view.gradient.dot(d) + d.dot(view.information * d));
    double weights = 0;
    for (const double w : points.weight) weights += w * w;
    const auto corners = static_cast<double>(points.used());
    return cost / weights * corners / (corners - RowLayout::kPose / 2.0);
  }

  void add_view(const BundleProblem::Reduced& view) {
    // The fit to all views has absorbed a part of each: the gradient has the covariance I - I C I.
    const Eigen::MatrixXd information = view.information / variance_;
    const Eigen::VectorXd gradient = view.gradient / variance_;
    const Eigen::MatrixXd left = information - congruent(covariance_, information);
    views_->add(information, gradient);
    const Eigen::VectorXd step = covariance_ * gradient;
    observed_ += step.dot(metric_ * step);
    predicted_ += metric_.cwiseProduct(congruent(left, covariance_)).sum();
  }

  void add_residuals(std::size_t v, const ViewPoints& points) {
    rows_.resize(points.padded());
    fill_rows_of(parameterization_.model)(points,
                                          row_point(parameterization_.table, 0, 0, fit_.shared),
                                          fit_.camera_from_board[v], Loss{}, rows_);
    const PointSet& view = fit_.views[v];
    const Eigen::Matrix3d& turn = fit_.camera_from_board[v].rotation;
    std::size_t at = 0;
    for (std::size_t i = 0; i < view.size(); ++i) {
      if (!(view.weight[i] > 0)) continue;
      add_corner(view, i, at, turn);
      ++at;
    }
    ++group_;
  }

  void add_corner(const PointSet& view, std::size_t i, std::size_t at,
                  const Eigen::Matrix3d& turn) {
    const ImageSize size = camera_.image_size();
    const auto part = [](double x, int extent, int parts) {
      return std::clamp(static_cast<int>(share_before(x, extent) * parts), 0, parts - 1);
    };
    const int cell =
        part(view.uv[i].v, size.height, down_) * across_ + part(view.uv[i].u, size.width, across_);
    Eigen::Vector3d score = Eigen::Vector3d::Zero();
    Eigen::Vector3d information = Eigen::Vector3d::Zero();
    for (int k = 0; k < 2; ++k) {
      const auto column = [&](int c) { return (k == 0 ? rows_.u(c) : rows_.v(c))[at]; };
      const double residual = column(RowLayout::kResidual);
      const double w = view.weight[i];
      picture_.add(0, 2 * cell + k, w * residual, w * w);
      picture_shared_.add(group_, static_cast<std::size_t>(2 * cell + k), w * residual, w * w);
      const Eigen::Vector3d along =
          turn.transpose() * Eigen::Vector3d(column(3), column(4), column(5));
      score += residual * along;
      information += along.cwiseAbs2();
    }
    for (int k = 0; k < 3; ++k) {
      board_.add(view.board, 3 * view.ids[i] + k, score[k], information[k]);
    }
    const std::size_t place = parts_.at(view.board) + kAxes * static_cast<std::size_t>(view.ids[i]);
    for (std::size_t k = 0; k < kAxes; ++k) {
      const auto axis = static_cast<Eigen::Index>(k);
      board_shared_.add(group_, place + k, score[axis], information[axis]);
    }
    board_bent_.add(group_, place, score[2], information[2]);
  }

  const Fit& fit_;
  const Camera& camera_;
  const BoardShape& shape_;
  const Parameterization& parameterization_;
  double variance_;
  ViewRows rows_;
  Eigen::MatrixXd metric_;
  Eigen::MatrixXd covariance_;
  std::size_t used_ = 0;  // views
  double residuals_ = 0;
  double unknowns_ = 0;
  double determined_ = 0;  // how many of the directions the corners determine, not the priors
  int across_ = 1;
  int down_ = 1;
  // Of the boards that were seen, by number, the first of the parts of `board_shared_`.
  std::map<std::size_t, std::size_t> parts_;
  std::vector<double> held_out_;
  // Of the views used that have one, by their number among those used.
  std::vector<std::pair<std::size_t, BundleProblem::Reduced>> reduced_;
  std::optional<Contradiction> views_;
  Scores picture_;
  Scores board_;
  Agreement picture_shared_;
  Agreement board_shared_;  // in its plane
  Agreement board_bent_;    // across it
  std::size_t group_ = 0;   // of the view at hand
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
