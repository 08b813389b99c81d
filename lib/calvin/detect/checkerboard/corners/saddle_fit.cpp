// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Damped Gauss-Newton steps for one corner, and the tests that end them.

#include "calvin/detect/checkerboard/corners/saddle_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calvin/detect/checkerboard/corners/fit_window.hpp"
#include "calvin/detect/checkerboard/corners/saddle_sums.hpp"
#include "calvin/detect/small_factor.hpp"

namespace calvin::detect {

namespace {

constexpr float kFewestPixels = 12;       // of a fit, by their weights
constexpr float kLeastSwing = 3;          // grey levels
constexpr float kLeastWidth = 0.2F;       // px
constexpr float kLargestWidth = 8;        // px
constexpr float kWidthPrior = 0.5F;       // 1 sigma of a step of a width's logarithm
constexpr float kGainPrior = 2;           // px, 1 sigma of a step of the gain
constexpr float kMostGain = 5;            // px
constexpr float kLongestStep = 1.2F;      // px
constexpr float kGainTolerance = 0.05F;   // px, of a step
constexpr float kWidthTolerance = 0.75F;  // of a step of its logarithm, by px of the place's
constexpr float kGainsWidth = 0.015F;     // likewise, beside a gain, which goes with the widths
constexpr float kPointsWidth = 0.3F;      // likewise, of points: of them, the place alone counts
constexpr float kLongestTurn = 0.3F;      // rad, in a step
constexpr float kDamping = 1e-3F;         // Levenberg's, of the diagonal
constexpr float kMostDrift = 0.6F;        // of the radius, from where the fit began
constexpr double kOffMiddle = 0.9;        // px, from where a window is gathered anew
constexpr double kRoughOffMiddle = 1.5;   // likewise, for a rough fit
constexpr float kLeastSine = 0.15F;       // between the edges
// px, the tolerance from which on a fit is rough: a better one follows, to which an error of about
// the square of it makes no difference.
constexpr float kRoughTolerance = 0.1F;
// A window takes pixels up to this far from an edge: kNearEdge widths of its blur, and as many px
// as its place is uncertain, before a fit or after one.
constexpr float kNearEdge = 3;          // widths
constexpr float kNearEdgePx = 2.5F;     // before a fit
constexpr float kNearFittedEdgePx = 1;  // after a fit
constexpr float kRounding = 1.0F / 12;  // grey levels^2, the variance of a whole number's rounding

// The first level and contrast; the pixels decide the sign of the contrast.
void start(const Window& window, SaddleFit& fit, float x, float y) {
  const SquareMeans mean = square_means(window, fit.along, fit.down, x, y);
  fit.level = 0.5F * (mean.between + mean.beside);
  fit.contrast = 0.6F * (mean.between - mean.beside);
}

Direction turned(Direction direction, float angle) {
  const Direction to = {direction.x - angle * direction.y, direction.y + angle * direction.x};
  const float inverse = 1 / std::sqrt(to.x * to.x + to.y * to.y);
  return {to.x * inverse, to.y * inverse};
}

// `step`: of the width's logarithm, so that it stays positive.
float widened(float width, float step) {
  return std::clamp(width * std::exp(std::clamp(step, -0.5F, 0.5F)), kLeastWidth, kLargestWidth);
}

// The variance of the noise, from the differences between pixels on opposite sides of the corner: a
// saddle looks the same turned by 180 degrees, whatever optics, ink or exposure did to it. `pixels`
// is the sum of their weights: those on the rim, where the next edge may lie, count as little as in
// the fit.
float noise_variance(const Window& window, float square, float pixels) {
  constexpr int kOddUnknowns = 2;  // the place
  if (!window.whole) return square / std::max(pixels - static_cast<float>(kUnknowns), 1.0F);
  // A whole window lists its pixels in an order that is point-symmetric about its middle, which is
  // the corner to half a pixel.
  const float sum = odd_square(window);
  return 0.5F * sum / std::max(0.5F * pixels - kOddUnknowns, 1.0F);
}

// The factors of the information about the unknowns; a gain that is not estimated is left out.
class Factors {
 public:
  [[nodiscard]] bool compute(const Normal& normal, bool has_gain) {
    has_gain_ = has_gain;
    return has_gain ? all_.compute(normal.products)
                    : without_gain_.compute(normal.products + diagonal(kGain + 1));
  }
  void solve(const float* right, float* x) const {
    std::copy_n(right, kUnknowns, x);
    if (has_gain_) return all_.solve(x);
    x[kGain] = 0;
    without_gain_.solve(x + kGain + 1);
  }
  // The mean of the variances of x and of y.
  [[nodiscard]] float place_variance() const {
    return has_gain_ ? all_.mean_of_last_variances() : without_gain_.mean_of_last_variances();
  }

 private:
  SmallFactor<float, kUnknowns> all_;
  SmallFactor<float, kUnknowns - 1> without_gain_;
  bool has_gain_ = false;
};

// `pixels` is the sum of their weights.
bool factorise(Normal& normal, bool has_gain, float pixels, Factors& factors) {
  const float variance = normal.square / pixels + 1;
  for (const int width : {kAlongWidth, kDownWidth}) {
    normal.products[diagonal(width)] += variance / (kWidthPrior * kWidthPrior);
  }
  normal.products[diagonal(kGain)] += variance / (kGainPrior * kGainPrior);
  for (int p = 0; p < kUnknowns; ++p) normal.products[diagonal(p)] *= 1 + kDamping;
  return factors.compute(normal, has_gain);
}

// The largest numbers of a step.
struct StepSize {
  float shift = 0;    // px
  float turned = 0;   // rad
  float widened = 0;  // of the widths' logarithms
  float gained = 0;   // px

  StepSize() = default;
  explicit StepSize(const float* change)
      : shift(std::sqrt(change[kX] * change[kX] + change[kY] * change[kY])),
        turned(std::max(std::abs(change[kAlong]), std::abs(change[kDown]))),
        widened(std::max(std::abs(change[kAlongWidth]), std::abs(change[kDownWidth]))),
        gained(std::abs(change[kGain])) {}
  [[nodiscard]] bool is_within(float place, float width) const {
    return shift < place && widened < width && gained < kGainTolerance;
  }
  // Whether the factor of the normal equations is still good where the step leads, for a fit to
  // `place` px.
  [[nodiscard]] bool is_small(float place) const {
    constexpr float kSmallMove = 0.15F;
    constexpr float kSmallTurn = 0.02F;
    constexpr float kSmallWidening = 0.1F;
    const float more = place < kRoughTolerance ? 1 : 2;
    return shift < more * kSmallMove && turned < more * kSmallTurn &&
           widened < more * kSmallWidening;
  }
};

// By how much more the rounding of grey levels tells in a place than noise of its variance would.
// Along an edge that is nearly a row, a column or a diagonal of pixels, grey changes by so little
// that many pixels are rounded alike, unless noise of half a level mixes them. `variance` is that
// of noise and rounding.
float rounding_in_common(const SaddleFit& fit, float variance) {
  constexpr float kMostNoise = 0.15F;  // grey levels^2: exp(-4 pi^2 kMostNoise) is .003
  constexpr float kMixing = 39.478F;   // 4 pi^2
  constexpr float kSteepest = 0.798F;  // the slope of an edge in its middle, swings per width
  const float noise = std::max(variance - kRounding, 0.0F);
  if (noise > kMostNoise) return 0;
  float alike = 0;  // pixels, of both edges
  for (const bool is_along : {true, false}) {
    const Direction way = is_along ? fit.along : fit.down;
    const float low = std::min(std::abs(way.x), std::abs(way.y));
    const float high = std::max(std::abs(way.x), std::abs(way.y));
    const float slope = kSteepest * fit.swing() / (is_along ? fit.along_width : fit.down_width);
    const float change = slope * std::min(low, high - low) / high;  // grey levels in a pixel
    alike += std::clamp(1 / std::max(change, 1e-3F), 1.0F, 2 * fit.radius) - 1;
  }
  // Each edge tells of one of the two coordinates.
  return 0.5F * alike * kRounding * std::exp(-kMixing * noise);
}

// A fit in a window, of which the corner is at (x, y) from the middle.
class Steps {
 public:
  Steps(Window& window, float radius, float tolerance, SaddleFit& fit, float x, float y,
        Pixels pixels)
      : window_(window),
        radius_(radius),
        tolerance_(tolerance),
        fit_(fit),
        x_(x),
        y_(y),
        expected_x_(static_cast<float>(fit.expected.x - fit.x) + x),
        expected_y_(static_cast<float>(fit.expected.y - fit.y) + y),
        taken_for_(pixels),
        before_(fit) {}

  // Takes one step. False where the fit has run away, or there is no saddle.
  [[nodiscard]] bool take(bool last);
  [[nodiscard]] bool have_converged() const {
    return !is_taken_back_ && size_.is_within(tolerance_, most_widening());
  }
  // Writes what the last step has told into the fit.
  void finish();

  [[nodiscard]] float x() const { return x_; }
  [[nodiscard]] float y() const { return y_; }

 private:
  void sum(Sums sums) { accumulate(window_, fit_, radius_, x_, y_, sums, is_sharp(), normal_); }
  [[nodiscard]] bool is_sharp() const {
    // A pixel's square blurred to this width and a Gaussian of it differ by .006 of the contrast.
    constexpr float kSharp = 0.6F;  // px
    return taken_for_ == Pixels::kSquares && std::min(fit_.along_width, fit_.down_width) < kSharp;
  }
  [[nodiscard]] float most_widening() const {
    if (fit_.has_gain) return kGainsWidth;
    return taken_for_ == Pixels::kPoints ? kPointsWidth : kWidthTolerance * tolerance_;
  }
  [[nodiscard]] bool has_gone_too_far() const;
  [[nodiscard]] bool find_change(bool last);
  // Adds the information of what is expected of the edges to the sums.
  void add_expected();
  void apply();

  Window& window_;
  float radius_;
  float tolerance_;  // px
  SaddleFit& fit_;
  float x_;
  float y_;
  float expected_x_;
  float expected_y_;
  Pixels taken_for_;
  Normal normal_{};
  float pixels_ = 0;  // the sum of their weights
  Factors factors_;
  float change_[kUnknowns] = {};
  StepSize size_;
  bool is_taken_back_ = false;  // by half, in place of a new one
  bool is_near_ = false;        // the next step takes the factor of the last one
  float least_ = std::numeric_limits<float>::infinity();  // mean square
  SaddleFit before_;                                      // the last step
  float before_x_ = 0;
  float before_y_ = 0;
};

bool Steps::take(bool last) {
  if (is_near_) {
    sum(Sums::kGradient);
    if (fit_.has_expected) add_expected();
    factors_.solve(normal_.gradient, change_);
    is_near_ = false;
  } else {
    if (!find_change(last)) return false;
    is_near_ = !fit_.has_gain && StepSize(change_).is_small(tolerance_);
  }
  size_ = StepSize(change_);
  apply();
  return std::abs(x_) <= kMostDrift * radius_ && std::abs(y_) <= kMostDrift * radius_ &&
         std::abs(cross(fit_.along, fit_.down)) >= kLeastSine;
}

// With a gain, level and contrast are loosely determined, so that any larger error counts. Without
// one, a step fails only far from a saddle; where much is cut off, pixels come and go between steps
// and their mean error says little.
bool Steps::has_gone_too_far() const {
  constexpr float kFarOff = 0.3F;  // of the contrast, RMS
  constexpr float kMuchWorse = 2;
  constexpr float kMostCut = 0.1F;
  const float mean = normal_.square / pixels_;
  if (fit_.has_gain) return mean > least_;
  const float far = kFarOff * fit_.contrast;
  return mean > kMuchWorse * least_ && mean > far * far &&
         normal_.count > (1 - kMostCut) * static_cast<float>(window_.count);
}

// Finds the next step, or half of the way back where the last step went too far.
bool Steps::find_change(bool last) {
  sum(fit_.has_gain ? Sums::kParted : Sums::kPlain);
  pixels_ = normal_.products[diagonal(kLevel)];
  if (pixels_ < kFewestPixels) return false;
  is_taken_back_ = !last && has_gone_too_far();
  if (is_taken_back_) {
    fit_ = before_;
    x_ = before_x_;
    y_ = before_y_;
    for (float& c : change_) c *= 0.5F;
    return true;
  }
  least_ = normal_.square / pixels_;
  before_ = fit_;
  before_x_ = x_;
  before_y_ = y_;
  if (fit_.has_expected) add_expected();
  if (!factorise(normal_, fit_.has_gain, pixels_, factors_)) return false;
  factors_.solve(normal_.gradient, change_);
  return std::all_of(change_, change_ + kUnknowns, [](float c) { return std::isfinite(c); });
}

void Steps::add_expected() {
  constexpr float kTurned = 0.08F;   // rad, 1 sigma
  constexpr float kWidened = 0.25F;  // 1 sigma of a width's logarithm
  const float variance = normal_.square / pixels_ + kRounding;
  const auto add = [&](int unknown, float off, float sigma) {
    normal_.products[diagonal(unknown)] += variance / (sigma * sigma);
    normal_.gradient[unknown] += variance / (sigma * sigma) * off;
  };
  const ExpectedEdges& expected = fit_.expected;
  add(kAlong, cross(fit_.along, expected.along), kTurned);
  add(kDown, cross(fit_.down, expected.down), kTurned);
  add(kAlongWidth, std::log(expected.along_width / fit_.along_width), kWidened);
  add(kDownWidth, std::log(expected.down_width / fit_.down_width), kWidened);
  if (expected.sigma == 0) return;
  add(kX, expected_x_ - x_, expected.sigma);
  add(kY, expected_y_ - y_, expected.sigma);
}

void Steps::apply() {
  const float share = std::min({1.0F, kLongestStep / std::max(size_.shift, 1e-6F),
                                kLongestTurn / std::max(size_.turned, 1e-6F)});
  x_ += share * change_[kX];
  y_ += share * change_[kY];
  fit_.along = turned(fit_.along, share * change_[kAlong]);
  fit_.down = turned(fit_.down, share * change_[kDown]);
  fit_.level += share * change_[kLevel];
  fit_.contrast += share * change_[kContrast];
  fit_.along_width = widened(fit_.along_width, share * change_[kAlongWidth]);
  fit_.down_width = widened(fit_.down_width, share * change_[kDownWidth]);
  if (fit_.has_gain) {
    fit_.gain = std::clamp(fit_.gain + share * change_[kGain], -kMostGain, kMostGain);
  }
}

void Steps::finish() {
  fit_.radius = radius_;
  fit_.residual = std::sqrt(normal_.square / pixels_);
  fit_.cut = 1 - normal_.count / static_cast<float>(window_.count);
  const float variance = std::max(noise_variance(window_, normal_.square, pixels_), kRounding);
  const float in_common = rounding_in_common(fit_, variance);
  fit_.noise = std::sqrt(variance);
  fit_.at_border = !window_.whole;
  fit_.sigma = std::sqrt((variance + in_common) * factors_.place_variance());
  fit_.rounding = std::sqrt(in_common * factors_.place_variance());
}

// Takes steps in a window about the pixel in which the corner is.
bool fit_in_window(const ImageView& image, float radius, int steps, float tolerance, Pixels pixels,
                   SaddleFit& fit) {
  const int middle_x = static_cast<int>(std::lround(fit.x));
  const int middle_y = static_cast<int>(std::lround(fit.y));
  if (middle_x < 0 || middle_y < 0 || middle_x >= image.width || middle_y >= image.height) {
    return false;
  }
  Window window;
  const bool is_fitted = fit.contrast != 0;
  const float near = kNearEdge * std::max(fit.along_width, fit.down_width) +
                     (is_fitted ? kNearFittedEdgePx : kNearEdgePx) + std::abs(fit.gain);
  const float band = std::min(near, fit.room);
  radius = gather(image, middle_x, middle_y, radius, band, fit.along, fit.down, window);
  if (window.count < 2 * kUnknowns) return false;
  const auto x = static_cast<float>(fit.x - middle_x);
  const auto y = static_cast<float>(fit.y - middle_y);
  if (!is_fitted) {
    start(window, fit, x, y);
  } else if (fit.dots.count > 0) {
    remove_dots(fit, x, y, window);
  }
  Steps taken(window, radius, tolerance, fit, x, y, pixels);
  for (int i = 0; i < steps; ++i) {
    if (!taken.take(i + 1 == steps)) return false;
    // Of a fit that begins with a rough level and contrast, the errors that the first step sees
    // tell nothing yet.
    if (taken.have_converged() && (is_fitted || i > 0)) break;
  }
  taken.finish();
  fit.x = middle_x + static_cast<double>(taken.x());
  fit.y = middle_y + static_cast<double>(taken.y());
  return fit.swing() >= kLeastSwing && std::isfinite(fit.sigma);
}

}  // namespace

bool fit_saddle(const ImageView& image, float radius, int steps, SaddleFit& fit, float tolerance,
                Pixels pixels) noexcept {
  radius = std::min(radius, static_cast<float>(kMaxFitRadius));
  if (!(std::abs(fit.x) < 1e6) || !(std::abs(fit.y) < 1e6)) return false;
  const double u = fit.x;
  const double v = fit.y;
  if (!fit_in_window(image, radius, steps, tolerance, pixels, fit)) return false;
  // The corner was in another pixel: a window about that is symmetric, which gives the noise.
  const auto off = [](double from, double to) { return std::abs(to - std::round(from)); };
  const double most_off = tolerance < kRoughTolerance ? kOffMiddle : kRoughOffMiddle;
  if (std::max(off(u, fit.x), off(v, fit.y)) < most_off) return true;
  return fit_in_window(image, radius, steps, tolerance, pixels, fit) &&
         std::max(off(u, fit.x), off(v, fit.y)) <= static_cast<double>(kMostDrift * radius);
}

}  // namespace calvin::detect
