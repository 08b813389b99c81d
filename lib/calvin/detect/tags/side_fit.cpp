// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Damped Gauss-Newton steps over the pixels along a side, without those that something covers.

#include "calvin/detect/tags/side_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Core>

#include "calvin/detect/small_factor.hpp"
#include "calvin/detect/tags/side_pixels.hpp"

namespace calvin::detect {

namespace {

using SideVector = Eigen::Matrix<double, kSideUnknowns, 1>;
using SideFactor = SmallFactor<double, kSideUnknowns>;
using SideTriangle = std::array<double, kSideProducts>;  // the upper one of a matrix, row by row

constexpr double kLeastWidth = 0.3;               // px, about what a pixel itself has
constexpr double kFaintestSide = 8;               // grey levels
constexpr double kRounding = 1.0 / 12;            // grey levels^2
constexpr std::size_t kSegments = kSideSegments;  // of which something may cover some
constexpr int kFewestSegments = 4;
constexpr int kMostRough = 6;  // of so many lines of pixels across the side one is taken

class SideSteps {
 public:
  // `pixels` is memory.
  SideSteps(const ImageView& image, const SideGuess& guess, SidePixels& pixels)
      : image_(image), guess_(guess), frame_(guess), width_(guess.width), pixels_(pixels) {
    used_.fill(true);
  }

  [[nodiscard]] bool run();
  [[nodiscard]] SideFit result() const;

 private:
  [[nodiscard]] bool start();
  [[nodiscard]] bool fit_seen();
  [[nodiscard]] bool gather();
  [[nodiscard]] bool step();
  [[nodiscard]] bool converge();
  [[nodiscard]] bool drop_covered();
  void weigh();
  void accumulate(SideSums sums);
  [[nodiscard]] SideTriangle information() const;
  [[nodiscard]] SideModel model() const;

  [[nodiscard]] bool shows(std::size_t segment) const {
    return used_[segment] && pixels_in_[segment] > 0;
  }
  [[nodiscard]] int shown() const {
    int count = 0;
    for (std::size_t i = 0; i < kSegments; ++i) count += shows(i) ? 1 : 0;
    return count;
  }
  // Grey levels^2, of a pixel.
  [[nodiscard]] double variance() const {
    return square_ / std::max(count_ - int{kSideUnknowns}, 1) + kRounding;
  }
  [[nodiscard]] double bend_weight() const {
    return variance() / (guess_.bend_sigma * guess_.bend_sigma);
  }
  // px, in which pixels are taken, where so many are free.
  [[nodiscard]] double band(double free) const {
    constexpr double kWidths = 3.5;
    constexpr double kRoughWidths = 2.5;
    return std::min(0.8 * free, every_ > 1 ? kRoughWidths * width_ + 0.8 : kWidths * width_ + 1);
  }

  const ImageView& image_;
  const SideGuess& guess_;
  SideFrame frame_;
  SideCurve curve_;
  SideCurve gathered_;  // the curve near which pixels were taken
  double width_;        // px
  double gathered_width_ = 0;
  int every_ = 1;  // one in so many lines of pixels across the side
  double in_ = 0;
  double in_slope_ = 0;
  double out_ = 0;
  double out_slope_ = 0;
  SidePixels& pixels_;
  std::array<bool, kSegments> used_{};      // not covered
  std::array<int, kSegments> pixels_in_{};  // each segment, as drop_covered() saw it
  SideTriangle products_{};                 // of pixels alone
  SideVector gradient_;
  SideVector change_;
  SideFactor factor_;
  bool is_near_ = false;  // the next step takes the factor of one before
  double square_ = 0;
  int count_ = 0;
};

bool SideSteps::start() {
  constexpr double kRoughLines = 14;  // across the side
  curve_.bend = guess_.bend;
  if (guess_.care != SideCare::kAgain) {
    const auto line = coarse_side(image_, frame_, guess_);
    if (!line) return false;
    curve_ = *line;
    every_ = std::clamp(static_cast<int>(2 * frame_.half() / kRoughLines), 1, kMostRough);
  }
  if (!gather()) return false;
  // Grey levels at the ends of the band.
  double sums[2] = {0, 0};
  int counts[2] = {0, 0};
  // They need not be exact: a few hundred pixels tell them.
  const std::size_t every = 1 + static_cast<std::size_t>(pixels_.count) / 256;
  for (std::size_t i = 0; i < static_cast<std::size_t>(pixels_.count); i += every) {
    const double s =
        static_cast<double>(pixels_.n[i]) - curve_.at(static_cast<double>(pixels_.t[i]));
    if (std::abs(s) < 0.5) continue;
    sums[s > 0 ? 1 : 0] += static_cast<double>(pixels_.grey[i]);
    ++counts[s > 0 ? 1 : 0];
  }
  if (counts[0] == 0 || counts[1] == 0) return false;
  in_ = sums[0] / counts[0];
  out_ = sums[1] / counts[1];
  return true;
}

bool SideSteps::gather() {
  // Near a corner the edge is none of one side alone.
  const double from_corner = (1.7 * width_ + 0.7) / frame_.half();
  constexpr double kLeastEnd = 0.5;
  const double end = std::max(1 - from_corner, kLeastEnd);
  const SideBand near{band(room_inside(guess_)), band(room_outside(guess_)), end, width_, every_};
  gather_side(image_, frame_, guess_, curve_, near, pixels_);
  count_ = pixels_.count;
  // All of them have a weight yet.
  if (std::ranges::find(used_, false) != used_.end()) weigh();
  is_near_ = false;
  gathered_ = curve_;
  gathered_width_ = width_;
  return pixels_.count >= 3 * kSideUnknowns;
}

// Gives a weight to the pixels of segments that are used.
void SideSteps::weigh() {
  count_ = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(pixels_.count); ++i) {
    const bool is_used = used_[pixels_.segment_of(i)];
    pixels_.weight[i] = is_used ? 1 : 0;
    count_ += is_used ? 1 : 0;
  }
}

SideModel SideSteps::model() const {
  const auto numbers = [](const NextEdge& edge, float* to) {
    to[0] = static_cast<float>(edge.at);
    to[1] = static_cast<float>(edge.slope);
  };
  SideModel model;
  model.offset = static_cast<float>(curve_.offset);
  model.slope = static_cast<float>(curve_.slope);
  model.bend = static_cast<float>(curve_.bend);
  model.width = static_cast<float>(width_);
  model.in = static_cast<float>(in_);
  model.in_slope = static_cast<float>(in_slope_);
  model.out = static_cast<float>(out_);
  model.out_slope = static_cast<float>(out_slope_);
  numbers(guess_.border, model.border);
  numbers(guess_.second, model.second);
  numbers(guess_.gap, model.gap);
  return model;
}

void SideSteps::accumulate(SideSums sums) {
  SideNormal normal;
  accumulate_side(pixels_, model(), sums, normal);
  for (int p = 0; p < kSideUnknowns; ++p) gradient_[p] = static_cast<double>(normal.gradient[p]);
  square_ = static_cast<double>(normal.square);
  gradient_[kSideBend] -= bend_weight() * (curve_.bend - guess_.bend);
  if (sums == SideSums::kGradient) return;
  std::copy_n(normal.products, kSideProducts, products_.begin());
}

// Of all that is known: the width and the bend are hardly told by a short side.
SideTriangle SideSteps::information() const {
  constexpr double kWidthPrior = 0.5;  // of the logarithm, 1 sigma
  SideTriangle all = products_;
  all[SideFactor::diagonal(kSideWidth)] += variance() / (kWidthPrior * kWidthPrior);
  all[SideFactor::diagonal(kSideBend)] += bend_weight();
  return all;
}

bool SideSteps::step() {
  constexpr double kLongest = 1;   // px, and of the width's logarithm half of that
  constexpr double kSmall = 0.06;  // px, and of the contrast: after such a step its factor is good
  accumulate(is_near_ ? SideSums::kGradient : SideSums::kAll);
  if (count_ < 2 * kSideUnknowns) return false;
  if (!is_near_) {
    SideTriangle damped = information();
    for (int p = 0; p < kSideUnknowns; ++p) damped[SideFactor::diagonal(p)] *= 1 + 1e-6;
    if (!factor_.compute(damped.data())) return false;
  }
  change_ = gradient_;
  factor_.solve(change_.data());
  if (!change_.allFinite()) return false;
  const double largest =
      std::max({std::abs(change_[kSideOffset]), std::abs(change_[kSideSlope]),
                std::abs(change_[kSideBend]), 2 * std::abs(change_[kSideWidth])});
  // The derivatives of the place grow with the contrast.
  const double levels = std::max(std::abs(change_[kSideIn]), std::abs(change_[kSideOut]));
  is_near_ = largest < kSmall && levels < kSmall * std::abs(out_ - in_);
  const double share = std::min(1.0, kLongest / std::max(largest, 1e-12));
  change_ *= share;
  // What the step leaves of the squares: it may be the last one, and a first one that finds the
  // side in its place may still have changed the levels by many times the noise.
  square_ = std::max(square_ - (2 - share) * gradient_.dot(change_), 0.0);
  curve_.offset += change_[kSideOffset];
  curve_.slope += change_[kSideSlope];
  curve_.bend += change_[kSideBend];
  width_ = std::clamp(width_ * std::exp(change_[kSideWidth]), kLeastWidth, 0.5 * frame_.half() + 1);
  in_ += change_[kSideIn];
  in_slope_ += change_[kSideInSlope];
  out_ += change_[kSideOut];
  out_slope_ += change_[kSideOutSlope];
  return true;
}

bool SideSteps::converge() {
  constexpr int kSteps = 12;
  const double converged = every_ > 1 ? 1e-2 : 3e-3;  // px
  const double far = every_ > 1 ? 0.8 : 0.4;          // px, after which other pixels are near
  for (int i = 0; i < kSteps; ++i) {
    if (!step()) return false;
    const double moved = std::max({std::abs(curve_.at(-1) - gathered_.at(-1)),
                                   std::abs(curve_.at(1) - gathered_.at(1)),
                                   std::abs(curve_.at(0) - gathered_.at(0))});
    if (moved > far || std::abs(std::log(width_ / gathered_width_)) > 0.2) {
      if (!gather()) return false;
      continue;
    }
    if (std::max({std::abs(change_[kSideOffset]), std::abs(change_[kSideSlope]),
                  std::abs(change_[kSideBend])}) < converged) {
      break;
    }
  }
  return std::abs(curve_.offset) <= guess_.reach + 1 && std::abs(curve_.slope) <= guess_.reach + 2;
}

// Leaves out segments that do not look like the others; whether there were any.
bool SideSteps::drop_covered() {
  const SegmentSums sums = sums_of_segments(pixels_);
  std::ranges::transform(sums.count, pixels_in_.begin(),
                         [](float count) { return static_cast<int>(count); });
  const auto rms_of = [&](std::size_t i) {
    return std::sqrt(static_cast<double>(sums.square[i]) / pixels_in_[i]);
  };
  std::vector<double> rms;
  for (std::size_t i = 0; i < kSegments; ++i) {
    if (shows(i)) rms.push_back(rms_of(i));
  }
  if (rms.empty()) return false;
  std::ranges::sort(rms);
  constexpr double kUnlike = 3;
  constexpr double kLeast = 0.06;  // of the contrast
  // The better third tells what is usual: a hand may cover nearly as much.
  const double usual = rms[rms.size() / 3];
  const double limit = std::max(kUnlike * usual, 2 + kLeast * std::abs(out_ - in_));
  bool any = false;
  for (std::size_t i = 0; i < kSegments; ++i) {
    if (pixels_in_[i] == 0) continue;
    const bool keep = rms_of(i) <= limit;
    any = any || keep != used_[i];
    used_[i] = keep;
  }
  if (!any) return false;
  weigh();
  is_near_ = false;
  return true;
}

// To the pixels that were taken, without what something covers.
bool SideSteps::fit_seen() {
  if (!converge()) return false;
  constexpr int kRounds = 3;
  for (int i = 0; i < kRounds && drop_covered(); ++i) {
    if (shown() < kFewestSegments || !converge()) return false;
  }
  return shown() >= kFewestSegments;
}

bool SideSteps::run() {
  if (!start() || !fit_seen()) return false;
  if (every_ > 1 && guess_.care == SideCare::kFull) {
    every_ = 1;
    if (!gather() || !fit_seen()) return false;
  }
  const double contrast = (out_ - in_) * (guess_.inverted ? -1 : 1);
  return contrast >= kFaintestSide && count_ > 2 * kSideUnknowns;
}

SideFit SideSteps::result() const {
  SideFit fit;
  fit.width = width_;
  constexpr double kUnknown = std::numeric_limits<double>::infinity();
  SideFactor factor;
  const bool is_known = factor.compute(information().data());
  for (const int end : {0, 1}) {
    const double t = end == 0 ? -1 : 1;
    SideVector place = SideVector::Zero();  // by the unknowns
    place[kSideOffset] = 1;
    place[kSideSlope] = t;
    SideVector spread = place;
    factor.solve(spread.data());
    fit.offset[end] = curve_.at(t);
    fit.slope[end] = (curve_.slope - 2 * curve_.bend * t) / frame_.half();
    const double square = variance() / every_ * place.dot(spread);
    fit.sigma[end] = is_known ? std::sqrt(std::max(square, 0.0)) : kUnknown;
    const std::size_t last = end == 0 ? 0 : kSegments - 1;
    const std::size_t next = end == 0 ? 1 : kSegments - 2;
    fit.seen[end] = shows(last) || shows(next);
  }
  return fit;
}

}  // namespace

std::optional<SideFit> fit_side(const ImageView& image, const SideGuess& guess) {
  if (image.width < 8 || image.height < 8) return std::nullopt;
  // Sides are fitted by the hundred in a picture.
  thread_local SidePixels pixels;
  SideSteps steps(image, guess, pixels);
  if (!steps.run()) return std::nullopt;
  const SideFit fit = steps.result();
  if (!std::isfinite(fit.sigma[0]) || !std::isfinite(fit.sigma[1])) return std::nullopt;
  return fit;
}

}  // namespace calvin::detect
