// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Turns a finished fit into a Solution, or into an error that says which views are missing.

#include "calvin/solve/judge/make_solution.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/camera/models.hpp"
#include "calvin/geometry/convex_hull.hpp"
#include "calvin/geometry/dense.hpp"
#include "calvin/solve/fit/add_estimates.hpp"
#include "calvin/solve/judge/fit_diagnostics.hpp"
#include "calvin/solve/judge/projection_error.hpp"
#include "calvin/solve/judge/projection_grid.hpp"
#include "calvin/solve/judge/remarks.hpp"
#include "calvin/solve/judge/variety.hpp"
#include "calvin/solve/linear/scaled_solve.hpp"

namespace calvin {

namespace {

// A solve with a larger sigma than these is refused.
constexpr double kWorstFocalSigma = 0.1;   // of the focal length
constexpr double kWorstCenterSigma = 0.1;  // of the image width

constexpr const char* kStopped = "The solve was stopped.";

// The covariance sigma^2 (J^T J)^-1 over all unknowns. Absent where J^T J is singular.
std::optional<Eigen::MatrixXd> covariance(const Fit& fit, const Parameterization& parameterization,
                                          double variance) {
  const Eigen::Index n = fit.information.rows();
  const auto inverse = scaled_solve(fit.information, Eigen::MatrixXd::Identity(n, n), kLeastPivot);
  if (!inverse) return std::nullopt;
  const Eigen::MatrixXd c = variance * restrict_to(parameterization.basis.transpose(), *inverse);
  if (!c.allFinite() || c.diagonal().minCoeff() < 0) return std::nullopt;
  return c;
}

// The covariance with the rivals of the fit: another optimum may be the one near the truth, lifted
// above the best by noise. Each rival adds its squared distance, weighted by its likelihood.
Eigen::MatrixXd with_rivals(const Eigen::MatrixXd& c, const Fit& fit, double variance) {
  // A rival that is less likely does not count: its large distance would dominate the sigmas, which
  // are to say where two thirds of all errors lie.
  constexpr double kUnlikely = 0.02;
  Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(c.rows(), c.cols());
  double sum = 1;
  for (const Rival& rival : fit.rivals) {
    const double likelihood = std::exp((fit.cost - rival.cost) / (2 * variance));
    if (!(likelihood > kUnlikely)) continue;
    Eigen::VectorXd d(c.rows());
    for (Eigen::Index i = 0; i < d.size(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      d[i] = rival.shared[k] - fit.shared[k];
    }
    scatter += likelihood * d * d.transpose();
    sum += likelihood;
  }
  return c + scatter / sum;
}

tl::unexpected<Error> inseparable(const Parameterization& parameterization) {
  return degenerate(fmt::format(
      "The views do not tell the coefficients of {} apart: take a model with fewer of them.",
      parameterization.model));
}

// The sigma of the focal length on the axis, of the unknown fx or fy, over that length: f m there,
// with the magnification m of the lens, as 1 / (1 + xi) of doublesphere.
double relative_axis_sigma(const Fit& fit, const Parameterization& parameterization,
                           const Eigen::MatrixXd& c, int i) {
  constexpr double kBeside = 1e-6;                             // rad from the axis
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(c.rows());  // of log(f m)
  gradient[i] = 1 / fit.shared[static_cast<std::size_t>(i)];
  const ParameterRange lens = parameterization.table.distortion(0);
  const double* coefficients = values_of(fit.shared, lens).data();
  const int axis = i - parameterization.table.focal(0).first;
  visit_model(parameterization.model, [&]<typename M>() {
    const double p[3] = {axis == 0 ? kBeside : 0, axis == 1 ? kBeside : 0, 1};
    double xy[2];
    double jp[6];
    double jd[2 * std::max(M::Lens::kCount, 1)];
    M::Lens::template distort<double>(coefficients, p, xy, jp, jd);
    for (int k = 0; k < M::Lens::kCount; ++k) {
      gradient[lens[k]] = jd[axis * M::Lens::kCount + k] / xy[axis];
    }
  });
  return std::sqrt(std::max(gradient.dot(c * gradient), 0.0));
}

// Whether focal lengths and principal point are determined well enough to be a camera.
Status determined(const Fit& fit, const Parameterization& parameterization,
                  const Eigen::MatrixXd& c, ImageSize size) {
  const ParameterRange focal = parameterization.table.focal(0);
  for (int i = focal.first; i < focal.end(); ++i) {
    const double f = fit.shared[static_cast<std::size_t>(i)];
    const double sigma = std::sqrt(c(i, i));
    if (sigma > kWorstFocalSigma * f) {
      // About xi = 0 another xi does what f and alpha do, whatever the views show.
      if (relative_axis_sigma(fit, parameterization, c, i) < kWorstFocalSigma) {
        return inseparable(parameterization);
      }
      return degenerate(fmt::format(
          "The views do not determine the focal length ({:.0f} +- {:.0f} px): the board is too "
          "nearly parallel to the image, or always tilted the same way.",
          f, sigma));
    }
  }
  const ParameterRange center = parameterization.table.center(0);
  for (int i = center.first; i < center.end(); ++i) {
    if (std::sqrt(c(i, i)) > kWorstCenterSigma * size.width) {
      return degenerate(fmt::format(
          "The views do not determine the principal point (+- {:.0f} px): the board is always "
          "tilted the same way.",
          std::sqrt(c(i, i))));
    }
  }
  return {};
}

// The sum of the squared distances of the corners in use, px^2.
double squares_of(const Fit& fit, std::size_t v) {
  double sum = 0;
  for (std::size_t i = 0; i < fit.squares[v].size(); ++i) {
    if (fit.views[v].weight[i] > 0) sum += fit.squares[v][i];
  }
  return sum;
}

ViewRecord record(const Fit& fit, std::size_t v) {
  const PointSet& view = fit.views[v];
  ViewRecord r;
  r.timestamp = view.timestamp;
  r.points = static_cast<int>(view.used());
  r.camera_from_board = to_pose(fit.camera_from_board[v]);
  r.rms = std::sqrt(squares_of(fit, v) / r.points);
  return r;
}

void add_corners(Solution& solution, const Fit& fit) {
  Calibration& calibration = solution.calibration;
  std::vector<Pixel> corners;
  corners.reserve(fit.views.empty() ? 0 : fit.views.size() * fit.views.front().size());
  double squares = 0;
  for (std::size_t v = 0; v < fit.views.size(); ++v) {
    const PointSet& view = fit.views[v];
    if (!fit.used[v]) {
      solution.rejected.push_back({view.index, Reason::kOutlier});
      continue;
    }
    calibration.views.push_back(record(fit, v));
    squares += squares_of(fit, v);
    for (std::size_t i = 0; i < view.size(); ++i) {
      if (view.weight[i] > 0) {
        corners.push_back(view.uv[i]);
      } else {
        solution.rejected_corners.push_back({view.index, view.ids[i]});
      }
    }
  }
  calibration.rms = std::sqrt(squares / static_cast<double>(corners.size()));
  calibration.covered = convex_hull(std::move(corners));
}

// The columns of projection_grids() for the camera's part of the unknowns.
std::vector<int> grid_columns(const Parameterization& parameterization) {
  std::vector<int> columns;
  const ParameterTable& table = parameterization.table;
  for (int i = 0; i < table.intrinsics(0).count; ++i) columns.push_back(i);
  if (!table.skew(0).empty()) columns.push_back(kSkewColumn);
  return columns;
}

// Copies the promises, and returns what the one of the covered region is made of. `noise` is the
// part of the residuals' variance that the detector knew of.
PromiseParts add_promise(Calibration& calibration, const ProjectionGrids& grids,
                         const Eigen::MatrixXd& promised, const Eigen::MatrixXd& by_noise,
                         double noise) {
  const auto promise = promise_of(grids, promised);
  // Where nothing but noise was found the two are one.
  const auto least = promise && promised == by_noise ? std::optional(promise->covered)
                                                     : error_over(grids.covered, by_noise);
  if (!promise || !least || !(promise->covered > 0)) return {};
  calibration.expected_error = promise->covered;
  calibration.expected_error_anywhere = promise->anywhere;
  calibration.worst_place = promise->worst;
  const double share = *least / promise->covered;
  calibration.systematic = std::clamp(1 - noise * share * share, 0.0, 1.0);
  return {promise->covered, *least, {}};
}

void add_held_out(Solution& solution, const FitDiagnostics& found) {
  Calibration& calibration = solution.calibration;
  solution.held_out = found.held_out;
  double sum = 0;
  double corners = 0;
  for (std::size_t v = 0; v < found.held_out.size(); ++v) {
    sum += found.held_out[v] * calibration.views[v].points;
    corners += calibration.views[v].points;
  }
  if (std::isfinite(sum)) calibration.held_out_rms = std::sqrt(sum / corners);
}

// The variance of a residual of weight 1, px^2, and the part of it that the detector knew of.
struct Variance {
  double all = 1;
  double noise = 1;
};

// What the promises are made of.
struct Promised {
  Eigen::MatrixXd covariance;  // of all unknowns
  double of_board = 1;         // times the noise: the variance of a measured board
};

// The promises and the verdict.
Promised add_checks(Solution& solution, const FinishedFit& from, const Camera& camera,
                    const Eigen::MatrixXd& by_noise, const Variance& variance,
                    const std::stop_token& stop) {
  Calibration& calibration = solution.calibration;
  const Parameterization& parameterization = from.parameterization;
  const ProjectionGrids grids =
      projection_grids(camera, grid_columns(parameterization), calibration.covered);
  const FitDiagnostics found = diagnose(from.fit, camera, from.shape, parameterization,
                                        grids.covered, by_noise, variance.all, stop);
  if (stop.stop_requested()) return {by_noise};
  const Eigen::MatrixXd promised = with_rivals(
      honest_covariance(from.fit, from.shape, parameterization, found, by_noise, variance.all),
      from.fit, variance.all);
  const ParameterRange own = parameterization.table.camera(0);
  const auto of_camera = [&own](const Eigen::MatrixXd& c) -> Eigen::MatrixXd {
    return c.block(own.first, own.first, own.count, own.count);
  };
  PromiseParts promise =
      add_promise(calibration, grids, of_camera(promised), of_camera(by_noise), variance.noise);
  if (found.board_known) {
    promise.board_known = error_over(
        grids.covered,
        of_camera(with_rivals(congruent(*found.board_known, parameterization.basis.transpose()),
                              from.fit, variance.all)));
  }
  solution.misfit = misfit(found, calibration.chi, degrees_of_freedom(from.fit, parameterization),
                           calibration.rms.value_or(0), promise);
  if (solution.misfit.noticed != Misfit::Cause::kNone) {
    calibration.remarks.push_back(explain(solution.misfit, found, calibration.chi, promise));
  }
  if (from.fit.board && from.fit.board->estimated && found.board_pattern) {
    calibration.remarks.push_back(
        measured_otherwise(from.fit.board->offsets, *found.board_pattern));
  }
  calibration.misfit = to_string(solution.misfit.cause);
  // One view has no halves.
  if (calibration.views.size() > 1) {
    calibration.split_half_ratio = solution.misfit.split_half_ratio;
  }
  add_held_out(solution, found);
  return {promised, board_excess(found)};
}

Result<Solution> solution_of(const FinishedFit& from, ImageSize size, const SolveOptions& options,
                             const std::stop_token& stop) {
  const Fit& fit = from.fit;
  const Parameterization& parameterization = from.parameterization;
  const ParameterTable& table = parameterization.table;
  if (fit.cancelled) return make_error(ErrorCode::kCancelled, kStopped);
  if (const Status status =
          check_equations(fit.views, fit.used, parameterization, parameterization.model);
      !status) {
    return tl::unexpected<Error>(status.error());
  }
  if (!fit.converged) {
    return degenerate("The views do not determine the camera: the solve does not converge.");
  }
  if (const Status status = tilted_enough(fit, parameterization); !status) {
    return tl::unexpected<Error>(status.error());
  }
  const double left = fit.cost / degrees_of_cost(fit, parameterization);
  const double by_detector = from.scale.sigma * from.scale.sigma;
  const double variance = from.scale.known ? std::max(left, by_detector) : left;
  const auto c = covariance(fit, parameterization, variance);
  if (!c) return inseparable(parameterization);
  if (const Status status = determined(fit, parameterization, *c, size); !status) {
    return tl::unexpected<Error>(status.error());
  }
  if (!fit.sound) {
    return degenerate(fmt::format(
        "The solve leads to a lens that folds back among the corners: take a model with fewer "
        "coefficients than {}.",
        parameterization.model));
  }
  const auto own = values_of(fit.shared, table.intrinsics(0));
  const auto camera = Camera::make(parameterization.model, size, {own.begin(), own.end()},
                                   table.skew_at(0, fit.shared));
  if (!camera) return degenerate("The solve leads to an impossible camera.");
  Solution solution;
  solution.iterations = fit.iterations;
  solution.calibration = camera->to_calibration();
  auto& parameters = solution.calibration.parameters;
  if (!table.skew(0).empty() && parameters.size() == own.size()) {
    parameters.push_back({"skew", 0, {}});
  }
  add_corners(solution, fit);
  if (from.scale.known) solution.calibration.chi = from.chi;
  const double noise = from.scale.known ? by_detector / variance : 1;
  const Promised promised =
      options.checks ? add_checks(solution, from, *camera, *c, {variance, noise}, stop)
                     : Promised{with_rivals(
                           honest_covariance(fit, from.shape, parameterization, {}, *c, variance),
                           fit, variance)};
  add_estimates(solution, fit, table, promised.covariance);
  if (fit.board) add_board(solution, fit, *from.shape.offsets, promised.of_board * variance);
  if (options.checks) add_remarks(solution, promised.covariance, *camera, parameterization);
  if (stop.stop_requested()) return make_error(ErrorCode::kCancelled, kStopped);
  return solution;
}

}  // namespace

Status check_equations(const std::vector<PointSet>& views, const std::vector<bool>& used,
                       const Parameterization& parameterization, std::string_view model) {
  const auto n = static_cast<int>(std::count(used.begin(), used.end(), true));
  if (n == 0) {
    return degenerate(
        "There is no view to calibrate from: none shows at least 4 corners of the board that do "
        "not lie on one line.");
  }
  // A plane gives two equations for the pinhole, points in space all that there are.
  bool in_space = false;
  for (std::size_t v = 0; v < views.size(); ++v) in_space |= used[v] && spans_space(views[v]);
  if (!in_space && 2 * n < parameterization.pinhole_directions()) {
    const bool is_flat = std::ranges::all_of(views, [](const PointSet& view) {
      return std::ranges::all_of(view.points, [](const auto& p) { return p.z() == 0; });
    });
    return degenerate(fmt::format(
        "{} view{} cannot determine the camera model {}{}.", n, n == 1 ? "" : "s", model,
        is_flat ? "" : ": fewer than 6 points are seen, or they lie too near to a plane"));
  }
  std::size_t corners = 0;
  for (std::size_t v = 0; v < views.size(); ++v) corners += used[v] ? views[v].used() : 0;
  const auto unknowns = static_cast<std::size_t>(6 * n + parameterization.basis.cols());
  if (2 * corners <= unknowns) {
    return degenerate(fmt::format("{} corners give {} equations for {} unknowns: too few.", corners,
                                  2 * corners, unknowns));
  }
  return {};
}

Result<Solution> make_solution(const FinishedFit& from, ImageSize size, const SolveOptions& options,
                               const std::stop_token& stop) {
  auto solution = solution_of(from, size, options, stop);
  const std::size_t views = from.fit.views.size();
  if (!solution && solution.error().code == ErrorCode::kDegenerate && views > 1 &&
      in_one_place(from.fit, size)) {
    return degenerate(fmt::format(
        "All {} views show the board in the same place, which counts as one: move and tilt it.",
        views));
  }
  return solution;
}

}  // namespace calvin
