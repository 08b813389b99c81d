// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Solves each view of a zooming lens by itself, and what they share over all of them.

#include "calvin/rig/zoom/solve_zooming.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/geometry/dense.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/geometry/symmetric.hpp"
#include "calvin/solve/linear/scaled_solve.hpp"
#include "calvin/solve/methods/sturm_maybank.hpp"
#include "calvin/solve/residuals/points.hpp"
#include "calvin/solve/solve.hpp"

namespace calvin {

namespace {

// cx, cy (px) and the logarithm of the aspect, as far as they are not held.
using Shared = Eigen::VectorXd;

struct Fit {
  double cost = 0;  // squared residuals over their sigmas
  std::vector<Calibration> calibrations;
};

double sigma_of(const Observation& seen, std::size_t i) {
  return i < seen.sigma.size() && is_known_sigma(seen.sigma[i]) ? seen.sigma[i] : 1;
}

// The squared residuals of a view over their sigmas.
double cost_of(const View& view, const Calibration& calibration) {
  const auto camera = Camera::make(calibration);
  const SE3 pose = to_se3(calibration.views.front().camera_from_board);
  const auto points = view.board.points();
  double sum = 0;
  for (std::size_t i = 0; camera && i < view.observation.ids.size(); ++i) {
    const auto index = view.board.index_of(view.observation.ids[i]);
    const auto at = index ? camera->project(pose * points[*index]) : std::nullopt;
    if (!at) continue;
    const Pixel seen = view.observation.uv[i];
    const double sigma = sigma_of(view.observation, i);
    sum += (std::pow(at->u - seen.u, 2) + std::pow(at->v - seen.v, 2)) / (sigma * sigma);
  }
  return sum;
}

// `found`: what was made of it all the same, in brackets; or nothing.
tl::unexpected<Error> weak_view(std::size_t view, std::string_view found) {
  return make_error(
      ErrorCode::kDegenerate,
      fmt::format(
          "View {} of the zooming lens does not tell its focal length to a tenth{}: its plane "
          "is nearly parallel to the image, or too small in it. Tilt it by 20 degrees and "
          "more, and let it fill the picture.",
          view, found));
}

class Zooming {
 public:
  Zooming(std::span<const View> views, ImageSize size, const ZoomingOptions& options)
      : views_(views), size_(size), options_(options) {}

  [[nodiscard]] Eigen::Index count() const {
    return (options_.centered ? 0 : 2) + (options_.square ? 0 : 1);
  }
  [[nodiscard]] Shared shared_of(const ZoomingPinhole& pinhole) const {
    Shared q(count());
    Eigen::Index at = 0;
    if (!options_.centered) {
      q[at++] = pinhole.center.u;
      q[at++] = pinhole.center.v;
    }
    if (!options_.square) q[at] = std::log(pinhole.aspect);
    return q;
  }

  // Each view by itself with these numbers held, from these focal lengths on.
  [[nodiscard]] Result<Fit> fit(const Shared& q, const std::vector<double>& fx) const {
    Fit fit;
    for (std::size_t v = 0; v < views_.size(); ++v) {
      SolveOptions options;
      options.model = "brown4";
      options.camera = options_.camera;
      options.initial = initial(q, fx[v]);
      options.fix = {"center", "aspect", "k2", "p1", "p2"};
      options.warp = options.checks = options.reject_outliers = false;
      auto solved = solve(views_.subspan(v, 1), size_, options);
      if (!solved && solved.error().code == ErrorCode::kDegenerate) return weak_view(v, "");
      if (!solved) return tl::unexpected<Error>(solved.error());
      fit.cost += cost_of(views_[v], solved->calibration);
      fit.calibrations.push_back(std::move(solved->calibration));
    }
    return fit;
  }

 private:
  [[nodiscard]] Calibration initial(const Shared& q, double fx) const {
    const Pixel middle = image_center(size_);
    const double cx = options_.centered ? middle.u : q[0];
    const double cy = options_.centered ? middle.v : q[1];
    const double aspect = options_.square ? 1 : std::exp(q[count() - 1]);
    return Camera::make("brown4", size_, {fx, fx / aspect, cx, cy, 0, 0, 0, 0})
        .value()
        .to_calibration();
  }

  std::span<const View> views_;
  ImageSize size_;
  const ZoomingOptions& options_;
};

std::vector<double> focal_lengths(const Fit& fit) {
  std::vector<double> fx;
  for (const Calibration& c : fit.calibrations) fx.push_back(c.find("fx")->value);
  return fx;
}

// The cost about some shared numbers: a parabola by differences, and how focal lengths go along.
struct Parabola {
  Eigen::VectorXd gradient;
  Eigen::MatrixXd hessian;
  Eigen::MatrixXd fx_by_shared;  // a row for each view
};

Result<Parabola> parabola_at(const Zooming& zooming, const Shared& q, const Fit& at,
                             const Eigen::VectorXd& steps) {
  const Eigen::Index n = q.size();
  const std::vector<double> fx = focal_lengths(at);
  Parabola p = {Eigen::VectorXd(n), Eigen::MatrixXd(n, n),
                Eigen::MatrixXd(static_cast<Eigen::Index>(fx.size()), n)};
  Eigen::VectorXd ahead(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::VectorXd step = steps[i] * Eigen::VectorXd::Unit(n, i);
    const auto plus = zooming.fit(q + step, fx);
    const auto minus = zooming.fit(q - step, fx);
    if (!plus) return tl::unexpected<Error>(plus.error());
    if (!minus) return tl::unexpected<Error>(minus.error());
    ahead[i] = plus->cost;
    p.gradient[i] = (plus->cost - minus->cost) / (2 * steps[i]);
    p.hessian(i, i) = (plus->cost - 2 * at.cost + minus->cost) / (steps[i] * steps[i]);
    const auto up = focal_lengths(*plus);
    const auto down = focal_lengths(*minus);
    for (std::size_t v = 0; v < fx.size(); ++v) {
      p.fx_by_shared(static_cast<Eigen::Index>(v), i) = (up[v] - down[v]) / (2 * steps[i]);
    }
    for (Eigen::Index k = 0; k < i; ++k) {
      const auto both = zooming.fit(q + step + steps[k] * Eigen::VectorXd::Unit(n, k), fx);
      if (!both) return tl::unexpected<Error>(both.error());
      p.hessian(i, k) = p.hessian(k, i) =
          (both->cost - ahead[i] - ahead[k] + at.cost) / (steps[i] * steps[k]);
    }
  }
  return p;
}

Error left_open() {
  return {
      ErrorCode::kDegenerate,
      "The views of the zooming lens leave its principal point or its aspect open: take more of "
      "them, tilted to all sides, or hold what they leave open (--fix center,aspect)."};
}

struct Optimum {
  Fit fit;
  Eigen::MatrixXd covariance;  // of the shared numbers
  Eigen::MatrixXd fx_by_shared;
};

// Newton's step, and downhill also where the parabola is none: along its axes, by the size of their
// curvature. Absent where one of them has none.
std::optional<Eigen::VectorXd> downhill(const Parabola& p, const Eigen::VectorXd& steps) {
  constexpr double kFlat = 1e-9;  // of the largest curvature
  const Eigen::MatrixXd scaled = steps.asDiagonal() * p.hessian * steps.asDiagonal();
  const auto eigen = symmetric_eigen(scaled);
  if (!eigen) return std::nullopt;
  const double most = eigen->values.cwiseAbs().maxCoeff();
  Eigen::VectorXd step = eigen->vectors.transpose() * (-p.gradient.cwiseProduct(steps));
  for (Eigen::Index i = 0; i < step.size(); ++i) {
    const double curvature = std::abs(eigen->values[i]);
    if (!(curvature > kFlat * most)) return std::nullopt;
    step[i] /= curvature;
  }
  return Eigen::VectorXd(steps.cwiseProduct(eigen->vectors * step));
}

// Goes along a step as far as the views agree better there. Whether they do anywhere.
bool go(const Zooming& zooming, Eigen::VectorXd step, Shared& q, Fit& at) {
  constexpr int kMost = 5;
  for (int i = 0; i < kMost; ++i, step /= 4) {
    auto there = zooming.fit(q + step, focal_lengths(at));
    if (!there || !(there->cost < at.cost)) continue;
    q += step;
    at = *std::move(there);
    return true;
  }
  return false;
}

// Newton's steps on the shared numbers, each no longer than a twentieth of the image, until one is
// a small part of their sigmas where differences are taken over as little.
Result<Optimum> refine(const Zooming& zooming, Shared q, Fit at, ImageSize size, double freedom) {
  constexpr int kMost = 40;
  constexpr double kLongest = 12;    // steps
  constexpr double kSettled = 0.03;  // sigmas
  constexpr double kFine = 0.3;      // sigmas, over which differences are taken at last
  const Eigen::Index n = q.size();
  Eigen::VectorXd steps(n);
  for (Eigen::Index i = 0; i < n; ++i) steps[i] = n != 2 && i + 1 == n ? 2e-3 : 4e-3 * size.width;
  const Eigen::VectorXd first = steps;
  Parabola p;
  bool is_fine = false;
  for (int i = 0; i < kMost && n > 0; ++i) {
    auto next = parabola_at(zooming, q, at, steps);
    if (!next) return tl::unexpected<Error>(next.error());
    p = *std::move(next);
    auto step = downhill(p, steps);
    if (!step) return tl::unexpected<Error>(left_open());
    const double longest = step->cwiseQuotient(first).cwiseAbs().maxCoeff();
    if (longest > kLongest) *step *= kLongest / longest;
    const double variance = at.cost / std::max(freedom, 1.0);
    const bool is_settled = -p.gradient.dot(*step) < kSettled * kSettled * 2 * variance;
    const bool is_better = go(zooming, *step, q, at);
    if (is_settled && is_fine) break;
    if (is_settled) {
      steps =
          steps.cwiseMin(kFine * (2 * variance * p.hessian.diagonal().cwiseInverse()).cwiseSqrt());
      is_fine = true;
    } else if (!is_better || longest < 1) {
      steps *= 0.5;
    }
  }
  Optimum optimum = {std::move(at), Eigen::MatrixXd::Zero(n, n), p.fx_by_shared};
  if (n == 0) return optimum;
  const auto inverse = scaled_solve(p.hessian, Eigen::MatrixXd::Identity(n, n), 1e-6);
  if (!inverse) return tl::unexpected<Error>(left_open());
  optimum.covariance = 2 * optimum.fit.cost / std::max(freedom, 1.0) * *inverse;
  return optimum;
}

// Adds to the sigmas of a view what the shared numbers are uncertain by.
void add_sigmas(const Optimum& optimum, const ZoomingOptions& options, std::size_t view,
                Calibration& calibration) {
  calibration.covariance.clear();
  const Eigen::MatrixXd& c = optimum.covariance;
  if (c.size() == 0) return;
  const Eigen::RowVectorXd g = optimum.fx_by_shared.row(static_cast<Eigen::Index>(view));
  const double of_shared = (g * c * g.transpose())(0);
  for (Parameter& p : calibration.parameters) {
    if (p.name == "fx" || p.name == "fy") {
      p.sigma = std::sqrt(std::pow(p.sigma.value_or(0), 2) + of_shared);
    }
    if (options.centered) continue;
    if (p.name == "cx") p.sigma = std::sqrt(c(0, 0));
    if (p.name == "cy") p.sigma = std::sqrt(c(1, 1));
  }
}

Status check_focal_lengths(const std::vector<Calibration>& calibrations) {
  constexpr double kMost = 0.1;
  for (std::size_t v = 0; v < calibrations.size(); ++v) {
    const Parameter& fx = *calibrations[v].find("fx");
    if (fx.sigma && *fx.sigma < kMost * fx.value) continue;
    return weak_view(
        v, fmt::format(" ({:.0f} px, 1 sigma {:.0f} px)", fx.value, fx.sigma.value_or(fx.value)));
  }
  return {};
}

bool all_known(const std::vector<std::optional<double>>& fx) {
  return std::ranges::all_of(fx, [](const auto& f) { return f.has_value(); });
}

// Every focal length of it is known.
Result<ZoomingPinhole> start_of(std::span<const View> views, ImageSize size,
                                const ZoomingOptions& options) {
  std::vector<PointSet> sets;
  for (const View& view : views) {
    if (const Status good = check(view, size); !good) return tl::unexpected<Error>(good.error());
    sets.push_back(to_points(view.board, view.board.points(), view.observation));
  }
  if (sets.empty()) {
    return make_error(ErrorCode::kDegenerate, "There is no view to calibrate from.");
  }
  MethodInput input = {sets, size};
  input.centered = options.centered;
  input.square = options.square;
  auto found = sturm_maybank(input);
  if (!found || all_known(found->fx)) return found;
  std::vector<double> known;
  for (const auto& fx : found->fx) {
    if (fx) known.push_back(*fx);
  }
  std::ranges::sort(known);
  for (std::size_t v = 0; v < found->fx.size(); ++v) {
    if (found->fx[v]) continue;
    if (!options.refine || known.empty()) return tl::unexpected<Error>(no_focal_length(v));
    // The least squares begin with what other views have.
    found->fx[v] = known[known.size() / 2];
  }
  return found;
}

std::vector<Calibration> as_calibrations(const ZoomingPinhole& pinhole, ImageSize size,
                                         const std::string& camera) {
  std::vector<Calibration> all;
  for (const auto& known : pinhole.fx) {
    const double fx = *known;
    all.push_back(
        Camera::make("brown4", size,
                     {fx, fx / pinhole.aspect, pinhole.center.u, pinhole.center.v, 0, 0, 0, 0})
            .value()
            .to_calibration());
    all.back().camera = camera;
  }
  return all;
}

// Of the two starts the one that is nearer to the views.
Result<std::pair<Shared, Fit>> first_fit(const Zooming& zooming, const ZoomingPinhole& start,
                                         ImageSize size) {
  ZoomingPinhole middle = start;
  middle.center = image_center(size);
  middle.aspect = 1;
  std::optional<std::pair<Shared, Fit>> best;
  Error error;
  for (const ZoomingPinhole& from : {start, middle}) {
    const Shared q = zooming.shared_of(from);
    std::vector<double> fx;
    for (const auto& known : from.fx) fx.push_back(*known);
    auto fit = zooming.fit(q, fx);
    if (!fit) error = fit.error();
    if (fit && (!best || fit->cost < best->second.cost)) best = {q, *std::move(fit)};
  }
  if (!best) return tl::unexpected<Error>(error);
  return *std::move(best);
}

}  // namespace

Result<std::vector<Calibration>> solve_zooming(std::span<const View> views, ImageSize size,
                                               const ZoomingOptions& options) {
  if (const Status good = check_image_size(size); !good) return tl::unexpected<Error>(good.error());
  const auto start = start_of(views, size, options);
  if (!start) return tl::unexpected<Error>(start.error());
  ZoomingOptions named = options;
  if (named.camera.empty()) named.camera = views.front().observation.camera;
  if (!named.refine) return as_calibrations(*start, size, named.camera);
  const Zooming zooming(views, size, named);
  auto first = first_fit(zooming, *start, size);
  if (!first) return tl::unexpected<Error>(first.error());
  double freedom = -static_cast<double>(zooming.count());
  for (const View& view : views) {
    constexpr int kOwn = 8;  // f, k1 and the pose of each view
    freedom += 2.0 * static_cast<double>(view.observation.ids.size()) - kOwn;
  }
  auto optimum = refine(zooming, first->first, std::move(first->second), size, freedom);
  if (!optimum) return tl::unexpected<Error>(optimum.error());
  std::vector<Calibration> calibrations = std::move(optimum->fit.calibrations);
  for (std::size_t v = 0; v < calibrations.size(); ++v) {
    add_sigmas(*optimum, named, v, calibrations[v]);
  }
  if (const Status told = check_focal_lengths(calibrations); !told) {
    return tl::unexpected<Error>(told.error());
  }
  return calibrations;
}

}  // namespace calvin
