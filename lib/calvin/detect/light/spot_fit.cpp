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

namespace calvin::detect {

namespace {

constexpr int kUnknowns = 7;
using Vector = Eigen::Matrix<double, kUnknowns, 1>;
using Matrix = Eigen::Matrix<double, kUnknowns, kUnknowns>;

// Grey levels: what is as bright as the brightest pixel, where that is so bright, is cut off. A
// camera may cut off at 235, and lossy video is uneven there.
constexpr int kBright = 200;
constexpr int kUneven = 2;
// Pixels along a side of the window, of which more would only cost time.
constexpr int kMostSamples = 28;
constexpr int kFewestSamples = kUnknowns + 5;

struct Sample {
  double x = 0;  // px, from the middle of the blob
  double y = 0;
  double above = 0;  // grey levels above the background
  bool cut_off = false;
};

// The unknowns: centre (px from the middle of the blob), logarithm of the height, offset, and the
// inverse covariance p, q, r (1/px^2).
enum { kX, kY, kLogHeight, kOffset, kP, kQ, kR };

// The mean of the Gaussian over a pixel by four points, which is exact up to third order.
constexpr double kPoint = 0.28867513459481287;  // px from the middle, 1 / sqrt(12)

struct Value {
  double grey = 0;
  Vector slope = Vector::Zero();
};

Value model_at(const Vector& fit, const Sample& sample) {
  Value value;
  value.grey = fit[kOffset];
  value.slope[kOffset] = 1;
  const double height = std::exp(fit[kLogHeight]);
  for (const double dx : {-kPoint, kPoint}) {
    for (const double dy : {-kPoint, kPoint}) {
      const double x = sample.x + dx - fit[kX];
      const double y = sample.y + dy - fit[kY];
      const double square = fit[kP] * x * x + 2 * fit[kQ] * x * y + fit[kR] * y * y;
      const double part = height / 4 * std::exp(-square / 2);
      value.grey += part;
      value.slope[kX] += part * (fit[kP] * x + fit[kQ] * y);
      value.slope[kY] += part * (fit[kQ] * x + fit[kR] * y);
      value.slope[kLogHeight] += part;
      value.slope[kP] -= part * x * x / 2;
      value.slope[kQ] -= part * x * y;
      value.slope[kR] -= part * y * y / 2;
    }
  }
  return value;
}

// The pixels of a window, and what they say of a fit.
class SpotProblem {
 public:
  SpotProblem(const ImageView& image, const LightBackground& background, const LightBlob& blob);

  [[nodiscard]] bool is_enough() const { return samples_.size() - cut_off_ >= kFewestSamples; }
  [[nodiscard]] Vector start(const LightBlob& blob) const;
  // The normal equations at a fit; returns the sum of squares.
  double linearise(const Vector& fit, Matrix& information, Vector& right) const;
  [[nodiscard]] double cost(const Vector& fit) const;

  [[nodiscard]] Pixel middle() const { return middle_; }
  [[nodiscard]] double noise() const { return noise_; }
  // Grey levels above the background that a pixel may have.
  [[nodiscard]] double limit() const { return limit_; }
  // Residuals that count, less the unknowns.
  [[nodiscard]] double freedom() const {
    return static_cast<double>(samples_.size() - cut_off_) - kUnknowns;
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
  const PixelBox window = blob.box.grown(3 + blob.longer_side() / 2, image.size());
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
      xx / determinant;
  return fit;
}

double SpotProblem::linearise(const Vector& fit, Matrix& information, Vector& right) const {
  information.setZero();
  right.setZero();
  double sum = 0;
  for (const Sample& s : samples_) {
    const Value value = model_at(fit, s);
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
    const double residual = s.above - model_at(fit, s).grey;
    if (!s.cut_off || residual > 0) sum += residual * residual;
  }
  return sum;
}

bool is_gaussian(const Vector& fit) {
  return fit.allFinite() && fit[kP] > 0 && fit[kP] * fit[kR] > fit[kQ] * fit[kQ] &&
         fit[kLogHeight] < 20;
}

// What is cut off leaves height and width nearly free together: the height is held a little.
constexpr double kHeightPrior = 1e-3;  // of the information that the height has by itself

void damp(Matrix& information, double damping) {
  for (int i = 0; i < kUnknowns; ++i) information(i, i) *= 1 + damping;
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
    damp(damped, damping);
    const Vector step = damped.selfadjointView<Eigen::Lower>().llt().solve(right);
    const Vector next = fit + step;
    const double after = is_gaussian(next) ? problem.cost(next) : HUGE_VAL;
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

std::optional<SpotFit> conclude(const SpotProblem& problem, const Vector& fit, double cost) {
  Matrix information;
  Vector right;
  (void)problem.linearise(fit, information, right);
  damp(information, 0);
  const auto inverse = information.selfadjointView<Eigen::Lower>().llt();
  if (inverse.info() != Eigen::Success) return std::nullopt;
  const double determinant = fit[kP] * fit[kR] - fit[kQ] * fit[kQ];
  const Axes axes = axes_of(fit[kR] / determinant, -fit[kQ] / determinant, fit[kP] / determinant);
  SpotFit spot;
  spot.centre = {problem.middle().u + fit[kX], problem.middle().v + fit[kY]};
  spot.height = std::exp(fit[kLogHeight]);
  spot.longer = std::sqrt(axes.longer);
  spot.shorter = std::sqrt(std::max(axes.shorter, 0.0));
  spot.noise = problem.noise();
  spot.seen = std::min(spot.height, problem.limit());
  // Rounding to whole grey levels is noise, too.
  constexpr double kRounding = 1.0 / 12;
  const double variance = std::max(cost / problem.freedom(), kRounding);
  spot.residual = std::sqrt(variance);
  Vector along = Vector::Zero();
  along.head<2>() = axes.along;
  Vector across = Vector::Zero();
  across.head<2>() << -axes.along.y(), axes.along.x();
  spot.sigma_along = std::sqrt(variance * along.dot(inverse.solve(along)));
  spot.sigma_across = std::sqrt(variance * across.dot(inverse.solve(across)));
  return spot;
}

}  // namespace

std::optional<SpotFit> fit_spot(const ImageView& image, const LightBackground& background,
                                const LightBlob& blob) {
  const SpotProblem problem(image, background, blob);
  if (!problem.is_enough()) return std::nullopt;
  Vector fit = problem.start(blob);
  if (!is_gaussian(fit)) return std::nullopt;
  const auto cost = descend(problem, fit);
  if (!cost) return std::nullopt;
  const auto spot = conclude(problem, fit, *cost);
  if (!spot || !std::isfinite(spot->sigma_along) || !std::isfinite(spot->sigma_across)) {
    return std::nullopt;
  }
  const bool is_inside =
      spot->centre.u >= blob.box.left - 0.5 && spot->centre.u <= blob.box.right + 0.5 &&
      spot->centre.v >= blob.box.top - 0.5 && spot->centre.v <= blob.box.bottom + 0.5;
  return is_inside ? spot : std::nullopt;
}

}  // namespace calvin::detect
