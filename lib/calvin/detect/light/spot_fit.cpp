// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Levenberg and Marquardt's steps over the pixels of a window, of a large light only every second
// or third of them.

#include "calvin/detect/light/spot_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "calvin/detect/light/spot_model.hpp"

namespace calvin::detect {

namespace {

using Vector = SpotVector;
using Matrix = SpotMatrix;

// Grey levels: what is as bright as the brightest pixel, where that is so bright, is cut off. A
// camera may cut off at 235, and lossy video is uneven there.
constexpr int kBright = 200;
constexpr int kUneven = 2;
// Pixels along a side of the window, of which more would only cost time.
constexpr int kMostSamples = 24;
constexpr int kFewestSamples = kSpotUnknowns + 4;

// Rounding to whole grey levels is noise, too.
constexpr double kRounding = 1.0 / 12;

struct Sample {
  double x = 0;  // px, from the middle of the blob
  double y = 0;
  double above = 0;  // grey levels above the background
  bool cut_off = false;
};

// The pixels of a window, and what they say of a fit.
class SpotProblem {
 public:
  SpotProblem(const ImageView& image, const LightBackground& background, const LightBlob& blob);

  [[nodiscard]] bool is_enough() const { return samples_.size() - cut_off_ >= kFewestSamples; }
  [[nodiscard]] Vector start(const LightBlob& blob) const;
  // The normal equations at a fit; returns the sum of squares.
  double linearise(const Vector& fit, Matrix& information, Vector& right) const;
  [[nodiscard]] double cost(const Vector& fit) const;
  // Whether the residuals of the flanks, which tell the place, are like those beside the light.
  [[nodiscard]] bool is_noise_left(const Vector& fit) const;
  // 1 sigma of the unknowns along a direction, where the residuals have that variance.
  [[nodiscard]] double sigma(const Vector& fit, const Eigen::LLT<Matrix>& inverse,
                             const Vector& direction, double variance) const;

  [[nodiscard]] Pixel middle() const { return middle_; }
  [[nodiscard]] double noise() const { return noise_; }
  // Grey levels above the background that a pixel may have.
  [[nodiscard]] double limit() const { return limit_; }
  // Residuals that count, less the unknowns.
  [[nodiscard]] double freedom() const {
    return static_cast<double>(samples_.size() - cut_off_) - kSpotUnknowns;
  }

 private:
  Pixel middle_;
  double noise_ = 0;
  double limit_ = 255;
  std::size_t cut_off_ = 0;
  std::vector<Sample> samples_;
};

SpotProblem::SpotProblem(const ImageView& image, const LightBackground& background,
                         const LightBlob& blob) {
  middle_ = {(blob.box.left + blob.box.right) / 2.0, (blob.box.top + blob.box.bottom) / 2.0};
  const PixelBox window = blob.box.grown(3 + blob.longer_side() / 3, image.size());
  int brightest = 0;
  for (int y = blob.box.top; y <= blob.box.bottom; ++y) {
    for (int x = blob.box.left; x <= blob.box.right; ++x) {
      brightest = std::max<int>(brightest, image.at(x, y));
    }
  }
  const int limit = brightest >= kBright ? brightest - kUneven : 256;
  const int step = 1 + (std::max(window.width(), window.height()) - 1) / kMostSamples;
  double levels = 0;
  for (int y = window.top + step / 2; y <= window.bottom; y += step) {
    for (int x = window.left + step / 2; x <= window.right; x += step) {
      const int level = background.level(x, y);
      // Where a lamp is as bright, nothing is seen of the light.
      if (level + background.threshold(x, y) >= limit) continue;
      const int grey = image.at(x, y);
      samples_.push_back(
          {x - middle_.u, y - middle_.v, static_cast<double>(grey - level), grey >= limit});
      cut_off_ += grey >= limit ? 1 : 0;
      noise_ += background.noise(x, y);
      levels += level;
    }
  }
  const auto count = static_cast<double>(std::max<std::size_t>(samples_.size(), 1));
  noise_ /= count;
  limit_ = limit - levels / count;
}

// By the moments of the pixels that are above a part of the peak.
Vector SpotProblem::start(const LightBlob& blob) const {
  double sum = 0;
  double x = 0;
  double y = 0;
  for (const Sample& s : samples_) {
    const double weight = std::max(0.0, s.above - blob.peak / 3.0);
    sum += weight;
    x += weight * s.x;
    y += weight * s.y;
  }
  if (!(sum > 0)) sum = 1;
  x /= sum;
  y /= sum;
  double xx = 0;
  double xy = 0;
  double yy = 0;
  for (const Sample& s : samples_) {
    const double weight = std::max(0.0, s.above - blob.peak / 3.0);
    xx += weight * (s.x - x) * (s.x - x);
    xy += weight * (s.x - x) * (s.y - y);
    yy += weight * (s.y - y) * (s.y - y);
  }
  constexpr double kLeast = 0.15;  // px^2: of one pixel alone
  xx = xx / sum + kLeast;
  yy = yy / sum + kLeast;
  xy /= sum;
  const double determinant = xx * yy - xy * xy;
  Vector fit;
  fit << x, y, std::log(1.2 * std::max(blob.peak, 1)), 0, yy / determinant, -xy / determinant,
      xx / determinant, 1;
  return fit;
}

double SpotProblem::linearise(const Vector& fit, Matrix& information, Vector& right) const {
  information.setZero();
  right.setZero();
  double sum = 0;
  for (const Sample& s : samples_) {
    const SpotValue value = spot_value(fit, s.x, s.y);
    const double residual = s.above - value.grey;
    if (s.cut_off && residual <= 0) continue;
    sum += residual * residual;
    information.selfadjointView<Eigen::Lower>().rankUpdate(value.slope);
    right += residual * value.slope;
  }
  return sum;
}

double SpotProblem::cost(const Vector& fit) const {
  double sum = 0;
  for (const Sample& s : samples_) {
    const double residual = s.above - spot_grey(fit, s.x, s.y);
    if (!s.cut_off || residual > 0) sum += residual * residual;
  }
  return sum;
}

bool SpotProblem::is_noise_left(const Vector& fit) const {
  constexpr double kAlike = 2.5;  // times the mean square, of some ten pixels
  constexpr double kBeside = 1;   // grey level that the light has there, at most
  double flanks = 0;
  double weights = 0;
  double beside = 0;
  int count = 0;
  for (const Sample& s : samples_) {
    const SpotValue value = spot_value(fit, s.x, s.y);
    const double residual = s.above - value.grey;
    if (s.cut_off && residual <= 0) continue;
    const double weight = value.slope.head<2>().squaredNorm();
    flanks += residual * residual * weight;
    weights += weight;
    if (value.grey - fit[kOffset] > kBeside) continue;
    beside += residual * residual;
    ++count;
  }
  return flanks * std::max(count, 1) < kAlike * weights * std::max(beside, count * kRounding);
}

// The larger of two: as if all residuals were noise of one variance, and as large as each of them
// is (H. White, A Heteroskedasticity-Consistent Covariance Matrix Estimator, Econometrica 48(4),
// 1980; each over what the fit leaves of it). A light that is no Gaussian has its residuals where
// the flanks are, which tell the place.
double SpotProblem::sigma(const Vector& fit, const Eigen::LLT<Matrix>& inverse,
                          const Vector& direction, double variance) const {
  const Vector weights = inverse.solve(direction);
  double sum = 0;
  for (const Sample& s : samples_) {
    const SpotValue value = spot_value(fit, s.x, s.y);
    const double residual = s.above - value.grey;
    if (s.cut_off && residual <= 0) continue;
    const double left = 1 - std::min(value.slope.dot(inverse.solve(value.slope)), 0.9);
    const double pull = weights.dot(value.slope);
    sum += residual * residual / left * pull * pull;
  }
  return std::sqrt(std::max(sum, variance * direction.dot(weights)));
}

bool is_spot(const Vector& fit) {
  constexpr double kFlattest = 8;  // whose flanks are steeper than any lens makes them
  return fit.allFinite() && fit[kP] > 0 && fit[kP] * fit[kR] > fit[kQ] * fit[kQ] &&
         fit[kLogHeight] < 20 && fit[kFlatness] >= 1 && fit[kFlatness] < kFlattest;
}

// What is cut off leaves height and width nearly free together: the height is held a little. A
// Gaussian stays one.
constexpr double kHeightPrior = 1e-3;  // of the information that the height has by itself

void damp(const Vector& fit, double damping, Matrix& information, Vector& right) {
  if (fit[kFlatness] == 1) {
    information.row(kFlatness).setZero();
    information.col(kFlatness).setZero();
    information(kFlatness, kFlatness) = 1;
    right[kFlatness] = 0;
  }
  information.diagonal() *= 1 + damping;
  information(kLogHeight, kLogHeight) *= 1 + kHeightPrior;
}

// Improves `fit`; its sum of squares.
std::optional<double> descend(const SpotProblem& problem, Vector& fit) {
  constexpr int kSteps = 20;
  constexpr double kStill = 1e-4;  // px: less than any sigma
  double damping = 1e-2;
  Matrix information;
  Vector right;
  double cost = problem.linearise(fit, information, right);
  for (int i = 0; i < kSteps; ++i) {
    Matrix damped = information;
    damp(fit, damping, damped, right);
    const Vector step = damped.selfadjointView<Eigen::Lower>().llt().solve(right);
    const Vector next = fit + step;
    const double after = is_spot(next) ? problem.cost(next) : HUGE_VAL;
    if (!(after < cost)) {
      if (step.head<2>().norm() < kStill || damping > 1e6) break;
      damping *= 8;
      continue;
    }
    fit = next;
    const bool still = step.head<2>().norm() < kStill && after > 0.999 * cost;
    cost = problem.linearise(fit, information, right);
    damping = std::max(damping / 8, 1e-6);
    if (still) break;
  }
  return std::isfinite(cost) ? std::optional(cost) : std::nullopt;
}

struct Axes {
  double longer = 0;  // of the ellipse, as variance, px^2
  double shorter = 0;
  Eigen::Vector2d along;  // the direction of the longer one
};

// Of a symmetric positive definite 2x2 matrix (a b; b c).
Axes axes_of(double a, double b, double c) {
  const double mean = (a + c) / 2;
  const double apart = std::hypot((a - c) / 2, b);
  const double angle = std::atan2(2 * b, a - c) / 2;
  return {mean + apart, mean - apart, {std::cos(angle), std::sin(angle)}};
}

// The standard deviation of a spot of that flatness along an axis, whose square is the mean of
// x^2 over it, for one that would be 1 as a Gaussian.
double spread_of(double flatness) {
  const double inverse = 1 / flatness;
  return std::sqrt(std::pow(2, inverse) * std::tgamma(2 * inverse) / std::tgamma(inverse) / 2);
}

// A light whose residuals are no noise is flatter than a Gaussian, if that is better.
void flatten(const SpotProblem& problem, Vector& fit, double& cost) {
  constexpr double kFirst = 1.5;  // flatness to begin with
  if (problem.is_noise_left(fit)) return;
  Vector flat = fit;
  flat[kFlatness] = kFirst;
  const auto after = descend(problem, flat);
  if (!after || !(*after < cost)) return;
  fit = flat;
  cost = *after;
}

// px that the centre may be off where next to nothing but the steep foot of a flank is seen, which
// is no longer that of a Gaussian: measured on discs of even brightness of 2 to 8 px that are cut
// off at a twentieth of it.
double hidden_error(const SpotFit& spot, const LightBlob& blob) {
  constexpr double kTall = 30;      // times what is seen, of the height
  constexpr double kError = 0.003;  // of the radius of the blob
  return spot.height > kTall * spot.seen ? kError * blob.longer_side() / 2 : 0;
}

std::optional<SpotFit> conclude(const SpotProblem& problem, const LightBlob& blob,
                                const Vector& fit, double cost) {
  Matrix information;
  Vector right;
  (void)problem.linearise(fit, information, right);
  damp(fit, 0, information, right);
  const auto inverse = information.selfadjointView<Eigen::Lower>().llt();
  if (inverse.info() != Eigen::Success) return std::nullopt;
  const double determinant = fit[kP] * fit[kR] - fit[kQ] * fit[kQ];
  const Axes axes = axes_of(fit[kR] / determinant, -fit[kQ] / determinant, fit[kP] / determinant);
  SpotFit spot;
  spot.centre = {problem.middle().u + fit[kX], problem.middle().v + fit[kY]};
  spot.height = std::exp(fit[kLogHeight]);
  const double wide = spread_of(fit[kFlatness]);
  spot.longer = wide * std::sqrt(axes.longer);
  spot.shorter = wide * std::sqrt(std::max(axes.shorter, 0.0));
  spot.noise = problem.noise();
  spot.seen = std::min(spot.height, problem.limit());
  const double variance = std::max(cost / problem.freedom(), kRounding);
  spot.residual = std::sqrt(variance);
  Vector along = Vector::Zero();
  along.head<2>() = axes.along;
  Vector across = Vector::Zero();
  across.head<2>() << -axes.along.y(), axes.along.x();
  const double hidden = hidden_error(spot, blob);
  spot.sigma_along = std::hypot(problem.sigma(fit, inverse, along, variance), hidden);
  spot.sigma_across = std::hypot(problem.sigma(fit, inverse, across, variance), hidden);
  return spot;
}

}  // namespace

std::optional<SpotFit> fit_spot(const ImageView& image, const LightBackground& background,
                                const LightBlob& blob) {
  const SpotProblem problem(image, background, blob);
  if (!problem.is_enough()) return std::nullopt;
  Vector fit = problem.start(blob);
  if (!is_spot(fit)) return std::nullopt;
  auto cost = descend(problem, fit);
  if (!cost) return std::nullopt;
  flatten(problem, fit, *cost);
  const auto spot = conclude(problem, blob, fit, *cost);
  if (!spot || !std::isfinite(spot->sigma_along) || !std::isfinite(spot->sigma_across)) {
    return std::nullopt;
  }
  const bool is_inside =
      spot->centre.u >= blob.box.left - 0.5 && spot->centre.u <= blob.box.right + 0.5 &&
      spot->centre.v >= blob.box.top - 0.5 && spot->centre.v <= blob.box.bottom + 0.5;
  return is_inside ? spot : std::nullopt;
}

}  // namespace calvin::detect
