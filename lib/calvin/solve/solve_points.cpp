// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// From points to a calibration: what is enough to begin, the solve, and whether its result means
// anything.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "calvin/camera/camera.hpp"
#include "calvin/geometry/convex_hull.hpp"
#include "calvin/solve/fit.hpp"
#include "calvin/solve/scaled_solve.hpp"
#include "calvin/solve/uncertainty.hpp"

namespace calvin {

namespace {

// Beyond these a camera is not determined, whatever the least squares says.
constexpr double kWorstFocalSigma = 0.1;   // of the focal length
constexpr double kWorstCenterSigma = 0.1;  // of the image width

// Boards closer to parallel than this count as parallel, rad.
constexpr double kParallel = 0.0175;

constexpr const char* kAdvice =
    "Show the board in at least 3 views, tilted differently (30 to 45 degrees, to the left, to the "
    "right, up and down).";

tl::unexpected<Error> degenerate(std::string what) {
  return make_error(ErrorCode::kDegenerate, fmt::format("{} {}", what, kAdvice));
}

Status enough(const std::vector<PointSet>& views, const std::vector<bool>& used,
              const Freedom& freedom, std::string_view model) {
  const auto n = static_cast<int>(std::count(used.begin(), used.end(), true));
  if (n == 0) {
    return degenerate(
        "There is no view to calibrate from: none shows at least 4 corners of the board that do "
        "not lie on one line.");
  }
  if (2 * n < freedom.pinhole_directions()) {
    return degenerate(fmt::format("{} view{} cannot determine the camera model {}.", n,
                                  n == 1 ? "" : "s", model));
  }
  std::size_t corners = 0;
  for (std::size_t v = 0; v < views.size(); ++v) corners += used[v] ? views[v].used() : 0;
  const auto unknowns = static_cast<std::size_t>(6 * n + freedom.basis.cols());
  if (2 * corners <= unknowns) {
    return degenerate(fmt::format("{} corners give {} equations for {} unknowns: too few.", corners,
                                  2 * corners, unknowns));
  }
  return {};
}

// (J^T J)^-1 sigma^2 in the model's parameters. Absent where it does not exist.
std::optional<Eigen::MatrixXd> covariance(const Fit& fit, const Freedom& freedom) {
  double residuals = 0;
  for (std::size_t v = 0; v < fit.views.size(); ++v) {
    if (fit.used[v]) residuals += 2 * static_cast<double>(fit.views[v].used()) - 6;
  }
  const double variance = fit.cost / (residuals - static_cast<double>(freedom.basis.cols()));
  const Eigen::Index n = fit.information.rows();
  const auto inverse = scaled_solve(fit.information, Eigen::MatrixXd::Identity(n, n), 1e-14);
  if (!inverse) return std::nullopt;
  const Eigen::MatrixXd c = variance * restrict_to(freedom.basis.transpose(), *inverse);
  if (!c.allFinite() || c.diagonal().minCoeff() < 0) return std::nullopt;
  return c;
}

// Each orientation of the plane gives two equations for fx fy cx cy and parallel planes the same
// two (Zhang 2000, section 4.4). The covariance alone would believe a still board seen a hundred
// times.
int orientations(const Fit& fit) {
  std::vector<Eigen::Vector3d> normals;
  for (std::size_t v = 0; v < fit.views.size(); ++v) {
    if (!fit.used[v]) continue;
    const Eigen::Vector3d normal = fit.camera_from_board[v].rotation.col(2);
    const auto parallel = [&normal](const Eigen::Vector3d& other) {
      return normal.cross(other).norm() < std::sin(kParallel);
    };
    if (std::none_of(normals.begin(), normals.end(), parallel)) normals.push_back(normal);
  }
  return static_cast<int>(normals.size());
}

// Whether the covariance leaves a camera to speak of.
Status determined(const Fit& fit, const Eigen::MatrixXd& c, ImageSize size) {
  for (const int i : {0, 1}) {
    const double f = fit.shared[static_cast<std::size_t>(i)];
    const double sigma = std::sqrt(c(i, i));
    if (sigma > kWorstFocalSigma * f) {
      return degenerate(fmt::format(
          "The views do not determine the focal length ({:.0f} +- {:.0f} px): the board is too "
          "nearly parallel to the image, or always tilted the same way.",
          f, sigma));
    }
  }
  for (const int i : {2, 3}) {
    if (std::sqrt(c(i, i)) > kWorstCenterSigma * size.width) {
      return degenerate(fmt::format(
          "The views do not determine the principal point (+- {:.0f} px): the board is always "
          "tilted the same way.",
          std::sqrt(c(i, i))));
    }
  }
  return {};
}

ViewRecord record(const Fit& fit, std::size_t v) {
  const PointSet& view = fit.views[v];
  ViewRecord r;
  r.timestamp = view.timestamp;
  r.points = static_cast<int>(view.used());
  r.camera_from_board = to_pose(fit.camera_from_board[v]);
  r.rms = std::sqrt(fit.squares[v] / r.points);
  return r;
}

// `c` is over all unknowns; those of the camera come first.
void add_sigmas(Calibration& calibration, const Eigen::MatrixXd& c, const Freedom& freedom) {
  const std::vector<bool>& estimated = freedom.estimated;
  const auto count =
      static_cast<std::size_t>(4 + freedom.layout.coefficients + (freedom.layout.skew ? 1 : 0));
  for (std::size_t i = 0; i < count; ++i) {
    if (!estimated[i]) continue;
    const auto row = static_cast<Eigen::Index>(i);
    calibration.parameters[i].sigma = std::sqrt(c(row, row));
    for (std::size_t j = 0; j < count; ++j) {
      if (estimated[j]) {
        calibration.covariance.push_back(c(row, static_cast<Eigen::Index>(j)));
      }
    }
  }
}

Solution describe(const Fit& fit, const Camera& camera, const Eigen::MatrixXd& c,
                  const Freedom& freedom, const SolveOptions& options) {
  Solution solution;
  solution.iterations = fit.iterations;
  Calibration& calibration = solution.calibration;
  calibration = camera.to_calibration();
  if (freedom.layout.skew &&
      calibration.parameters.size() == static_cast<std::size_t>(4 + freedom.layout.coefficients)) {
    calibration.parameters.push_back({"skew", 0, {}});
  }
  add_sigmas(calibration, c, freedom);
  std::vector<Pixel> corners;
  double squares = 0;
  for (std::size_t v = 0; v < fit.views.size(); ++v) {
    const PointSet& view = fit.views[v];
    if (!fit.used[v]) {
      solution.rejected.push_back({view.index, Reason::kOutlier});
      continue;
    }
    calibration.views.push_back(record(fit, v));
    squares += fit.squares[v];
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
  if (options.checks) calibration.expected_error = expected_error(calibration);
  return solution;
}

Result<Solution> conclude(const Fit& fit, ImageSize size, const Freedom& freedom,
                          const SolveOptions& options) {
  const std::string& model = options.model;
  if (fit.cancelled) return make_error(ErrorCode::kCancelled, "The solve was stopped.");
  if (const Status status = enough(fit.views, fit.used, freedom, model); !status) {
    return tl::unexpected<Error>(status.error());
  }
  if (fit.converged && 2 * orientations(fit) < freedom.pinhole_directions()) {
    return degenerate("The board is parallel to itself in all views, which determines no camera.");
  }
  const auto c = fit.converged ? covariance(fit, freedom) : std::nullopt;
  if (!c) return degenerate("The views do not determine the camera: the solve does not converge.");
  if (const Status status = determined(fit, *c, size); !status) {
    return tl::unexpected<Error>(status.error());
  }
  const auto count = static_cast<std::ptrdiff_t>(4 + freedom.layout.coefficients);
  const auto camera = Camera::make(model, size, {fit.shared.begin(), fit.shared.begin() + count},
                                   freedom.row_point(fit.shared).skew);
  if (!camera) return degenerate("The solve leads to an impossible camera.");
  return describe(fit, *camera, *c, freedom, options);
}

}  // namespace

Result<Solution> solve_points(std::vector<PointSet> views, ImageSize image_size,
                              const SolveOptions& options, const std::stop_token& stop) {
  const auto freedom = make_freedom(options, image_size);
  if (!freedom) return tl::unexpected<Error>(freedom.error());
  if (const Status status =
          enough(views, std::vector<bool>(views.size(), true), *freedom, options.model);
      !status) {
    return tl::unexpected<Error>(status.error());
  }
  normalise_weights(views);
  const Fit fit = fit_camera(std::move(views), {}, image_size, *freedom, options, stop);
  return conclude(fit, image_size, *freedom, options);
}

}  // namespace calvin
