// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Damped Gauss-Newton steps for one disc.

#include "calvin/detect/circles/disc_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "calvin/detect/circles/disc_sums.hpp"

namespace calvin::detect {

namespace {

constexpr double kLeastWidth = 0.2;     // px
constexpr double kDamping = 1e-3;       // Levenberg's, of the diagonal
constexpr double kWidthPrior = 0.5;     // 1 sigma of a step of the width's logarithm
constexpr double kLongestStep = 0.4;    // of the radius
constexpr double kMostDrift = 0.6;      // of the radius, from where the fit began
constexpr double kConverged = 0.01;     // px, of a step of the centre
constexpr double kShape = 0.05;         // px, of the rim, or of the width's logarithm
constexpr double kRounding = 1.0 / 12;  // grey levels^2, the variance of a whole number's rounding
constexpr double kFaintest = 4;         // grey levels

// px, along the border of an image, where what cameras do to their pictures goes wrong.
constexpr int kBorder = 2;

using Matrix = Eigen::Matrix<double, kDiscUnknowns, kDiscUnknowns>;
using Vector = Eigen::Matrix<double, kDiscUnknowns, 1>;

// The half of a row of pixels that an ellipse of `factor` times the half axes covers; negative
// where it covers none.
double half_row(const Ellipse& e, double factor, double dy, double& middle) {
  middle = e.xy / e.yy * dy;
  const double square = e.determinant() / e.yy * (factor * factor - dy * dy / e.yy);
  return square < 0 ? -1 : std::sqrt(square);
}

// Takes the pixels within `band` px of the rim of an ellipse about a pixel, in an order that is
// point-symmetric where they are all in the image. The band is made narrower where the window
// cannot hold its pixels. False where too many are beyond the border.
bool gather_rim(const ImageView& image, int x, int y, const Ellipse& e, double band, double room,
                Window& window) {
  const double radius = e.radius();
  const double circumference = 2 * M_PI * std::sqrt(0.5 * (e.xx + e.yy));
  band = std::min(band, 0.4 * kMostPixels / (circumference + 8));
  const double share = band / std::sqrt(e.shortest_square());
  const double outer = 1 + share;
  const double inner = 1 - std::min(share, room);
  const int reach = static_cast<int>(outer * std::sqrt(e.yy)) + 1;
  const int aside = static_cast<int>(outer * std::sqrt(e.xx)) + 1;
  window.count = 0;
  if (!(radius < 1e4) || x < 0 || y < 0 || x >= image.width || y >= image.height) return false;
  window.whole = x - aside >= kBorder && y - reach >= kBorder &&
                 x + aside < image.width - kBorder && y + reach < image.height - kBorder;
  int missing = 0;
  const auto append = [&](int first, int last, int dy) {
    const bool row_is_there = y + dy >= kBorder && y + dy < image.height - kBorder;
    const int from = row_is_there ? std::max(first, kBorder - x) : last + 1;
    const int to = row_is_there ? std::min(last, image.width - 1 - kBorder - x) : last;
    missing += std::max(last - first + 1, 0) - std::max(to - from + 1, 0);
    const std::uint8_t* row = image.data + (y + dy) * image.stride + x;
    const int count = std::min(to - from + 1, kMostPixels - window.count);
    append_row(row, from, from + count - 1, image.width - x, static_cast<float>(dy), window);
  };
  for (int dy = -reach; dy <= reach; ++dy) {
    double middle = 0;
    const double out = half_row(e, outer, dy, middle);
    if (out < 0) continue;
    const double in = inner > 0 ? half_row(e, inner, dy, middle) : -1;
    const auto up = [](double v) { return static_cast<int>(std::ceil(v)); };
    const auto down = [](double v) { return static_cast<int>(std::floor(v)); };
    if (in < 0 || inner <= 0) {
      append(up(middle - out), down(middle + out), dy);
      continue;
    }
    append(up(middle - out), down(middle - in), dy);
    append(std::max(up(middle + in), down(middle - in) + 1), down(middle + out), dy);
  }
  std::fill_n(window.x + window.count, kBeyond, 0.0F);
  std::fill_n(window.y + window.count, kBeyond, 0.0F);
  std::fill_n(window.grey + window.count, kBeyond, 0.0F);
  constexpr int kLeastInView = 3;  // times what is beyond the border
  return window.count < kMostPixels && window.count >= kLeastInView * missing;
}

// A fit in a window, of which the centre is at (x, y) from the middle.
class DiscSteps {
 public:
  DiscSteps(Window& window, DiscFit& fit, double x, double y)
      : window_(window), fit_(fit), x_(x), y_(y) {}

  [[nodiscard]] bool take();
  [[nodiscard]] bool have_converged() const {
    return std::hypot(change_[kDiscX], change_[kDiscY]) < kConverged && largest() < kShape;
  }
  void finish();

  [[nodiscard]] double x() const { return x_; }
  [[nodiscard]] double y() const { return y_; }

 private:
  [[nodiscard]] bool apply();
  void sum(DiscSums sums) {
    accumulate_disc(window_, fit_, static_cast<float>(x_), static_cast<float>(y_), sums, normal_);
  }
  [[nodiscard]] Vector gradient() const;
  // The largest part of the last step, px, or of the width's logarithm.
  [[nodiscard]] double largest() const { return change_.head<kDiscInside>().cwiseAbs().maxCoeff(); }

  Window& window_;
  DiscFit& fit_;
  double x_;
  double y_;
  DiscNormal normal_{};
  Eigen::LLT<Matrix> factor_;
  Vector change_ = Vector::Zero();
  bool is_near_ = false;  // the next step takes the factor of the last one
  float least_ = std::numeric_limits<float>::infinity();  // sum of squares
  DiscFit before_;                                        // the last step
  double before_x_ = 0;
  double before_y_ = 0;
};

bool DiscSteps::take() {
  constexpr double kSmall = 0.12;  // after such a step the factor is still good
  if (is_near_) {
    // The factor of the step before is still good.
    sum(DiscSums::kGradient);
    is_near_ = false;
    change_ = factor_.solve(gradient());
    return change_.allFinite() && apply();
  }
  sum(DiscSums::kAll);
  // A step that has gone too far is taken back by half.
  constexpr float kMuchWorse = 1.05F;
  if (normal_.square > kMuchWorse * least_) {
    change_ *= 0.5;
    fit_ = before_;
    x_ = before_x_;
    y_ = before_y_;
    return apply();
  }
  least_ = normal_.square;
  before_ = fit_;
  before_x_ = x_;
  before_y_ = y_;
  Matrix m;
  int k = 0;
  for (int p = 0; p < kDiscUnknowns; ++p) {
    for (int q = p; q < kDiscUnknowns; ++q) {
      m(p, q) = m(q, p) = static_cast<double>(normal_.products[k++]);
    }
  }
  const double variance = static_cast<double>(normal_.square) / window_.count + 1;
  m(kDiscWidth, kDiscWidth) += variance / (kWidthPrior * kWidthPrior);
  m.diagonal() *= 1 + kDamping;
  factor_.compute(m);
  if (factor_.info() != Eigen::Success) return false;
  change_ = factor_.solve(gradient());
  is_near_ = largest() < kSmall;
  return change_.allFinite() && apply();
}

Vector DiscSteps::gradient() const {
  Vector right;
  for (int p = 0; p < kDiscUnknowns; ++p) right[p] = static_cast<double>(normal_.gradient[p]);
  return right;
}

bool DiscSteps::apply() {
  Ellipse& e = fit_.ellipse;
  const double radius = e.radius();
  const double largest =
      std::max({std::hypot(change_[kDiscX], change_[kDiscY]), std::abs(change_[kDiscXX]),
                std::abs(change_[kDiscXY]), std::abs(change_[kDiscYY])});
  const double share = std::min(1.0, kLongestStep * radius / std::max(largest, 1e-9));
  const Vector step = share * change_;
  const double unit = 2 / (radius * radius * radius);
  const double determinant = e.determinant();
  const double a = e.yy / determinant + unit * step[kDiscXX];
  const double b = -e.xy / determinant + unit * step[kDiscXY];
  const double c = e.xx / determinant + unit * step[kDiscYY];
  const double inverse = a * c - b * b;
  if (!(inverse > 0) || !(a > 0)) return false;
  e.xx = c / inverse;
  e.xy = -b / inverse;
  e.yy = a / inverse;
  x_ += step[kDiscX];
  y_ += step[kDiscY];
  e.inside += static_cast<float>(step[kDiscInside]);
  e.outside += static_cast<float>(step[kDiscOutside]);
  fit_.width = std::clamp(fit_.width * std::exp(std::clamp(step[kDiscWidth], -0.7, 0.7)),
                          kLeastWidth, std::max(e.radius(), 2 * kLeastWidth));
  return std::hypot(x_, y_) < kMostDrift * radius + 1;
}

void DiscSteps::finish() {
  const double pixels = window_.count;
  const double square = static_cast<double>(normal_.square);
  fit_.residual = std::sqrt(square / pixels);
  // What differs between opposite pixels: what the model lacks is mostly alike in both.
  constexpr int kOddUnknowns = 2;
  const double alike = square / std::max(pixels - int{kDiscUnknowns}, 1.0);
  const double odd =
      0.5 * static_cast<double>(odd_square(window_)) / std::max(0.5 * pixels - kOddUnknowns, 1.0);
  const double variance = std::max(window_.whole ? odd : alike, kRounding);
  fit_.noise = std::sqrt(variance);
  const auto variance_of = [&](int unknown) {
    return factor_.matrixL().solve(Vector::Unit(unknown)).squaredNorm();
  };
  fit_.sigma = std::sqrt(variance * 0.5 * (variance_of(kDiscX) + variance_of(kDiscY)));
}

}  // namespace

namespace {

enum class Outcome { kFailed, kMoved, kDone };

// A fit in the window about the rim where it is thought to be; kMoved where the rim was further off
// than the window has room for.
Outcome fit_in_window(const ImageView& image, int steps, DiscFit& fit) {
  constexpr double kNearRim = 3.2;  // widths, and as many px as the rim is uncertain
  const bool is_fitted = fit.sigma > 0;
  const double near_px = is_fitted ? 0.5 : fit.off;
  constexpr double kMoved = 1;  // px
  Ellipse& e = fit.ellipse;
  const Ellipse before = e;
  const double width = fit.width;
  const int x = static_cast<int>(std::lround(e.x));
  const int y = static_cast<int>(std::lround(e.y));
  Window window;
  const double band = std::min(kNearRim * fit.width + near_px, e.radius());
  if (!gather_rim(image, x, y, e, band, fit.room, window)) return Outcome::kFailed;
  if (window.count < 2 * kDiscUnknowns) return Outcome::kFailed;
  DiscSteps taken(window, fit, e.x - x, e.y - y);
  for (int i = 0; i < steps; ++i) {
    if (!taken.take()) return Outcome::kFailed;
    if (taken.have_converged()) break;
  }
  taken.finish();
  e.x = x + taken.x();
  e.y = y + taken.y();
  const auto change = [](double from, double to) {
    return std::abs(std::sqrt(to) - std::sqrt(from));
  };
  const bool moved = std::max({std::abs(e.x - before.x), std::abs(e.y - before.y),
                               change(before.longest_square(), e.longest_square()),
                               change(before.shortest_square(), e.shortest_square())}) > kMoved ||
                     fit.width > 1.5 * width;
  return moved ? Outcome::kMoved : Outcome::kDone;
}

}  // namespace

bool fit_disc(const ImageView& image, int steps, DiscFit& fit) noexcept {
  constexpr int kMostWindows = 4;
  for (int i = 0; i < kMostWindows; ++i) {
    const Ellipse& e = fit.ellipse;
    if (!(std::abs(e.x) < 1e6) || !(std::abs(e.y) < 1e6) || !(e.determinant() > 0)) return false;
    const Outcome outcome = fit_in_window(image, steps, fit);
    if (outcome == Outcome::kFailed) return false;
    if (outcome == Outcome::kMoved) continue;
    return std::abs(static_cast<double>(e.outside - e.inside)) >= kFaintest &&
           std::isfinite(fit.sigma);
  }
  return false;
}

}  // namespace calvin::detect
