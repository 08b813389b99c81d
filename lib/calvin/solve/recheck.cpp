// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Gathers what single views say of the parameters, and tests the step that they ask for.

#include "calvin/solve/recheck.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "calvin/camera/image_transform.hpp"
#include "calvin/geometry/convex_hull.hpp"
#include "calvin/geometry/dense.hpp"
#include "calvin/solve/judge/contradiction.hpp"
#include "calvin/solve/judge/projection_grid.hpp"
#include "calvin/solve/linear/scaled_solve.hpp"
#include "calvin/solve/pose.hpp"
#include "calvin/solve/residuals/board_shape.hpp"
#include "calvin/solve/residuals/bundle_problem.hpp"

namespace calvin {

namespace {

constexpr std::size_t kMostViews = 30;  // the latest ones
constexpr double kPriorWidth = 0.02;    // of the image width, 1 sigma of a parameter's effect
constexpr double kSimilar = 0.02;  // of the image diagonal: boards nearer than this are one view
constexpr double kLeast = 0.3;     // px, of a displacement that matters
constexpr double kSigmas = 2;      // a change that is less likely by chance is one

// The columns of the parameters with a sigma; of all parameters where none has one.
std::vector<int> columns_of(const Camera& camera, const Calibration& calibration) {
  auto estimated = estimated_columns(calibration).value_or(std::vector<int>());
  if (!estimated.empty()) return estimated;
  std::vector<int> all(camera.parameters().size());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

// The calibration's covariance in px of the frames; zero where it has none of the right size.
Eigen::MatrixXd covariance_of(const Camera& camera, const Calibration& calibration,
                              const std::vector<int>& columns) {
  const auto n = static_cast<Eigen::Index>(columns.size());
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(n, n);
  const Parameter* fx = calibration.find("fx");
  const Parameter* fy = calibration.find("fy");
  if (fx == nullptr || fy == nullptr ||
      calibration.covariance.size() != columns.size() * columns.size()) {
    return covariance;
  }
  const auto all = parameter_names(camera.model());
  std::vector<std::string_view> names;
  for (const int column : columns) {
    names.push_back(column == kSkewColumn ? "skew" : all[static_cast<std::size_t>(column)]);
  }
  covariance = Eigen::Map<const Eigen::MatrixXd>(calibration.covariance.data(), n, n).transpose();
  return scaled_covariance(covariance, names, camera.fx() / fx->value, camera.fy() / fy->value);
}

// How much more than their noise the views of the calibration contradicted each other: the inverse
// of the share of its error that was noise.
double contradiction_of(const Calibration& calibration) {
  constexpr double kUsual = 4;  // where nobody looked
  constexpr double kMost = 100;
  if (!calibration.systematic) return kUsual;
  return 1 / std::clamp(1 - *calibration.systematic, 1 / kMost, 1.0);
}

// Each parameter by itself moves the picture by `width` px at the most.
Eigen::MatrixXd prior_of(const ProjectionGrid& grid, Eigen::Index parameters, double width) {
  Eigen::VectorXd reach = Eigen::VectorXd::Zero(parameters);
  for (const auto& cell : grid) reach = reach.cwiseMax(cell.colwise().norm().transpose());
  return (reach / width).cwiseAbs2().asDiagonal();
}

// The corners of the box around the points.
std::vector<Pixel> box_of(const std::vector<Pixel>& points) {
  Pixel low = points.front();
  Pixel high = low;
  for (const Pixel& p : points) {
    low = {std::min(low.u, p.u), std::min(low.v, p.v)};
    high = {std::max(high.u, p.u), std::max(high.v, p.v)};
  }
  return {low, high};
}

// The normal equations of one view over all parameters of the model and its skew, and behind them
// its readout where that is given; the pose eliminated.
std::optional<BundleProblem::Reduced> equations_of(const PointSet& view, const Camera& camera,
                                                   const SE3& pose,
                                                   const std::optional<ReadoutTime>& readout) {
  TableCamera of{std::string(camera.model()), true};
  of.has_readout = readout.has_value();
  const ParameterTable table({of}, {BoardUnknowns{}});
  std::vector<double> shared = camera.parameters();
  shared.resize(static_cast<std::size_t>(table.count()));
  shared[static_cast<std::size_t>(table.skew(0).first)] = camera.skew();
  if (readout) shared[static_cast<std::size_t>(table.readout(0).first)] = readout->value;
  const ViewPoints points(view, {});
  BundleProblem problem({{{&points}}, {}, {}}, {&table, table.basis(), {}},
                        {std::move(shared), {pose}, {}, {}}, Loss{});
  if (!problem.valid()) return std::nullopt;
  auto reduced = problem.reduced();
  if (!reduced || !reduced->information.allFinite()) return std::nullopt;
  return reduced;
}

// Whether a displacement matters and is of more than so many sigma.
bool is_certain(const RecheckReport& report, double sigmas) {
  return report.displacement > std::max(sigmas * report.displacement_sigma, kLeast);
}

// One more unknown, which no other depends on.
void append(Eigen::MatrixXd& matrix, double diagonal) {
  const Eigen::Index n = matrix.rows();
  matrix.conservativeResizeLike(Eigen::MatrixXd::Zero(n + 1, n + 1));
  matrix(n, n) = diagonal;
}

}  // namespace

Recheck::Recheck(const Camera& camera, const Calibration& calibration,
                 std::optional<ReadoutTime> readout)
    : camera_(camera),
      columns_(columns_of(camera, calibration)),
      readout_(readout),
      covariance_(covariance_of(camera, calibration, columns_)),
      contradiction_before_(contradiction_of(calibration)),
      board_(calibration.board),
      warp_(calibration.warp.value_or(BoardWarp{})) {
  prior_ = prior_of(projection_grid(camera, columns_), static_cast<Eigen::Index>(columns_.size()),
                    kPriorWidth * camera.image_size().width);
  if (!has_readout()) return;
  const double variance = readout_->sigma * readout_->sigma;
  append(prior_, 1 / variance);
  append(covariance_, variance);
}

Result<RecheckReport> Recheck::add(const View& view) {
  auto report = gather(view);
  if (report) judge(*report);
  return report;
}

RecheckReport Recheck::add(std::span<const View> views) {
  const std::size_t step = (views.size() + kMostViews - 1) / kMostViews;
  for (std::size_t i = 0; i < views.size(); i += step) {
    if (views[i].observation.found()) (void)gather(views[i]);
  }
  RecheckReport report;
  judge(report);
  return report;
}

Result<RecheckReport> Recheck::gather(const View& view) {
  PoseQuality quality;
  const BoardWarp warp = view.board.text() == board_ ? warp_ : BoardWarp{};
  const auto pose = solve_pose(camera_, view.board, view.observation, &quality, warp);
  if (!pose) return tl::unexpected<Error>(pose.error());
  PointSet points = to_points(view.board, bent_points(view.board, warp), view.observation);
  if (readout_) points.motion = row_motion(view.observation, camera_.image_size().height);
  if (auto condensed = condense(view, points, *pose)) keep(*std::move(condensed));
  RecheckReport report;
  report.camera_from_board = to_pose(*pose);
  report.rms = quality.rms;
  report.points = static_cast<int>(points.used());
  return report;
}

std::optional<Recheck::Condensed> Recheck::condense(const View& view, const PointSet& points,
                                                    const SE3& pose) const {
  const auto normal = equations_of(points, camera_, pose, readout_);
  if (!normal) return std::nullopt;
  const CameraUnknowns order = CameraUnknowns::of(camera_.parameters().size(), true);
  std::vector<int> rows = columns_;
  std::replace(rows.begin(), rows.end(), kSkewColumn, order.skew().first);
  if (has_readout()) rows.push_back(order.all().count);
  Condensed condensed;
  condensed.board = view.board.text();
  condensed.corners = box_of(view.observation.uv);
  condensed.hull = convex_hull(view.observation.uv);
  condensed.information = normal->information(rows, rows);
  condensed.gradient = normal->gradient(rows);
  condensed.cost = normal->cost;
  condensed.degrees = 2 * static_cast<double>(points.used()) - 6;
  return condensed;
}

// Replaces a view of the same board in the same place, or else the oldest: a still board adds no
// information from frame to frame, because its errors are the same in all of them.
void Recheck::keep(Condensed view) {
  const ImageSize size = camera_.image_size();
  const double near = kSimilar * std::hypot(size.width, size.height);
  const auto same = std::find_if(views_.begin(), views_.end(), [&](const Condensed& other) {
    bool close = other.board == view.board;
    for (std::size_t i = 0; close && i < view.corners.size(); ++i) {
      close = std::hypot(view.corners[i].u - other.corners[i].u,
                         view.corners[i].v - other.corners[i].v) < near;
    }
    return close;
  });
  if (same != views_.end()) {
    view.corners = std::move(same->corners);  // a board that moves on leaves views behind it
    views_.erase(same);
  } else if (views_.size() == kMostViews) {
    views_.erase(views_.begin());
  }
  views_.push_back(std::move(view));
}

// What the views say together of the camera: a Gauss-Newton step, and how far noise alone takes it.
struct Recheck::Step {
  Eigen::VectorXd by;        // of the parameters
  Eigen::MatrixXd variance;  // of `by` while the camera is the one that was calibrated
};

// How much more the views contradict each other than corners without a common error would: the
// mean square of their gradients over what it were then, at least 1. While there are few views the
// calibration says it, whose views had the same camera and board.
double Recheck::contradiction(const Eigen::MatrixXd& inverse, const Eigen::VectorXd& step,
                              double variance) const {
  const Eigen::Index n = inverse.rows();
  double found = contradiction_before_ * static_cast<double>(n);
  double expected = static_cast<double>(n);
  for (const Condensed& view : views_) {
    const Eigen::VectorXd left = view.gradient + view.information.lazyProduct(step);
    const Eigen::MatrixXd share = inverse.lazyProduct(view.information);
    found += left.dot(inverse.lazyProduct(left)) / variance;
    expected += share.trace() - share.cwiseProduct(share.transpose()).sum();
  }
  return std::max(found / expected, 1.0);
}

std::optional<Recheck::Step> Recheck::step() const {
  const Eigen::Index n = prior_.rows();
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(n);
  double cost = 0;
  double degrees = 0;
  for (const Condensed& view : views_) {
    information += view.information;
    gradient += view.gradient;
    cost += view.cost;
    degrees += view.degrees;
  }
  if (!(degrees > 0)) return std::nullopt;
  // Two rounds: the noise is estimated by the residuals after the step, and the step depends on the
  // noise by the prior.
  double variance = cost / degrees;
  std::optional<Eigen::MatrixXd> by;
  Eigen::MatrixXd total;
  for (int round = 0; round < 2; ++round) {
    total = information + variance * prior_;
    by = scaled_solve(total, -gradient, 0);
    if (!by) return std::nullopt;
    const Eigen::VectorXd change = information.lazyProduct(*by);
    const double left = cost + (2 * gradient + change).dot(by->col(0));
    variance = std::max(left, 0.0) / degrees;
  }
  const auto gain = scaled_solve(total, information, 0);
  const auto inverse = scaled_solve(total, Eigen::MatrixXd::Identity(n, n), 0);
  if (!gain || !inverse) return std::nullopt;
  const double more = variance > 0 ? contradiction(*inverse, by->col(0), variance) : 1;
  const Eigen::MatrixXd known = gain->lazyProduct(covariance_);
  const Eigen::MatrixXd spread =
      more * variance * gain->lazyProduct(*inverse) + known.lazyProduct(gain->transpose());
  const auto parameters = static_cast<Eigen::Index>(columns_.size());
  return Step{by->col(0).head(parameters), spread.topLeftCorner(parameters, parameters)};
}

// By the mean square of the change over the region, of which noise alone would make a sum of
// squares with as many degrees of freedom as have its mean and variance (F. Satterthwaite, 1946).
void Recheck::judge(const Step& step, const PlacedGrid& region, RecheckReport& report) {
  if (region.at.empty()) return;  // no ray leads to the picture: nothing can be told of it
  const Eigen::VectorXd du = product(region.u, step.by);
  const Eigen::VectorXd dv = product(region.v, step.by);
  const PlacedVariances of_places = variances(region, step.variance);
  double farthest = 0;
  double sigma = 0;  // of the farthest change, along its way
  double most = 0;   // variance of any change
  for (Eigen::Index i = 0; i < du.size(); ++i) {
    most = std::max(most, of_places.largest(i));
    const Eigen::Vector2d change(du[i], dv[i]);
    if (!(change.norm() > farthest)) continue;
    farthest = change.norm();
    sigma = std::sqrt(std::max(of_places.along(i, change / farthest), 0.0));
  }
  const Eigen::MatrixXd by_noise =
      product(transposed_product(region.u, region.u) + transposed_product(region.v, region.v),
              step.variance);
  const double mean = by_noise.trace();
  const double squares = by_noise.cwiseProduct(by_noise.transpose()).sum();
  const double degrees = squares > 0 ? mean * mean / squares : 0;
  const double found = du.squaredNorm() + dv.squaredNorm();
  const bool beyond_chance =
      !(degrees > 0) || ChiSquare{found / mean * degrees, degrees}.deviations() > kSigmas;
  const bool moved = std::isfinite(farthest) && farthest > kSigmas * sigma && beyond_chance;
  report.region_sigma = std::sqrt(std::max(most, 0.0));
  report.displacement = moved ? farthest : 0;
  report.displacement_sigma = moved ? sigma : report.region_sigma;
}

void Recheck::judge(RecheckReport& report) const {
  if (views_.empty() || columns_.empty()) return;
  const auto by = step();
  if (!by) return;
  std::vector<Pixel> seen;
  for (const Condensed& view : views_) seen.insert(seen.end(), view.hull.begin(), view.hull.end());
  judge(*by, projection_grids(camera_, columns_, convex_hull(std::move(seen))).covered, report);
}

std::string advice(const RecheckReport& report) {
  constexpr double kCertain = 4;  // sigma: it is asked at every frame
  if (!is_certain(report, kCertain)) return "";
  return fmt::format(
      "The lens has moved: the picture is off by {:.2g} +- {:.1g} px where the board was seen. "
      "Calibrate the camera again.",
      report.displacement, report.displacement_sigma);
}

std::optional<RecheckReport> proved_displacement(const Camera& camera,
                                                 const Calibration& calibration,
                                                 std::span<const View> views,
                                                 std::optional<ReadoutTime> readout) {
  const RecheckReport report = Recheck(camera, calibration, readout).add(views);
  constexpr double kCertain = 3;  // sigma
  return is_certain(report, kCertain) ? std::optional(report) : std::nullopt;
}

void judge_held_camera(Solution& solution, std::span<const View> views,
                       const SolveOptions& options) {
  constexpr double kFarOff = 5;  // times the noise
  const auto camera = Camera::make(*options.initial);
  if (!camera) return;
  Calibration& calibration = solution.calibration;
  const auto moved = proved_displacement(*camera, *options.initial, views, options.readout);
  const double rms = calibration.rms.value_or(0);
  const double chi = calibration.chi.value_or(0);
  const bool is_off = moved || (chi > kFarOff && rms > kLeast);
  solution.misfit.cause = is_off ? Misfit::Cause::kModel : Misfit::Cause::kNone;
  solution.misfit.noticed = solution.misfit.cause;
  calibration.misfit = to_string(solution.misfit.cause);
  if (!is_off) return;
  const std::string how_far =
      moved ? fmt::format(
                  "The picture is {:.2g} +- {:.1g} px from where the camera that is "
                  "held has it",
                  moved->displacement, moved->displacement_sigma)
            : fmt::format(
                  "Corners are {:.2g} px (RMS) from where the camera that is held has "
                  "them, {:.2g} times their noise",
                  rms, chi);
  calibration.remarks.push_back(how_far +
                                ": these views are of another camera, of a lens that has moved, or "
                                "of another board.");
}

}  // namespace calvin
