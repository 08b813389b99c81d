// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Centres of lines by their grey levels across them, and the crossing of two parabolas.

#include "calvin/detect/grids/crossing_fit.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "calvin/detect/checkerboard/corners/grey_at.hpp"

namespace calvin::detect {

namespace {

constexpr double kSample = 0.5;  // px, from a sample across a line to the next

// The darkness across a line, above that of the ground on both sides of it.
class Profile {
 public:
  // Samples `reach` px to both sides of a place; false where that leaves the image, or where there
  // is no line.
  bool take(const ImageView& image, const Eigen::Vector2d& at, const Eigen::Vector2d& way,
            double reach, bool light) {
    half_ = static_cast<int>(reach / kSample);
    dark_.clear();
    for (int i = -half_; i <= half_; ++i) {
      const Eigen::Vector2d p = at + kSample * i * way;
      const auto grey = grey_at(image, static_cast<float>(p.x()), static_cast<float>(p.y()));
      if (!grey) return false;
      dark_.push_back(static_cast<double>(light ? *grey : 255 - *grey));
    }
    return take_off_ground();
  }

  // How wide and dark the line is, grey levels times samples.
  [[nodiscard]] double ink() const {
    double sum = 0;
    for (const double dark : dark_) sum += std::max(dark - kFoot * peak_, 0.0);
    return sum;
  }

  // Of the line, px from the middle. A second time from where it was found first, so that what is
  // cut off is the same on both sides.
  [[nodiscard]] double centre() const {
    const double first = centroid(0, half_ * kSample);
    return centroid(first, half_ * kSample - std::abs(first));
  }

 private:
  static constexpr double kFoot = 0.2;  // of the peak: below it is noise

  // The ground is linear between the outermost samples, an eighth of them on each side.
  bool take_off_ground() {
    constexpr double kContrast = 10;  // grey levels
    const std::size_t count = dark_.size();
    const std::size_t outermost = count / 8;
    if (outermost < 1) return false;
    const auto median_from = [&](std::size_t first) {
      std::vector<double> outer(dark_.begin() + static_cast<std::ptrdiff_t>(first),
                                dark_.begin() + static_cast<std::ptrdiff_t>(first + outermost));
      std::ranges::nth_element(outer, outer.begin() + static_cast<std::ptrdiff_t>(outermost / 2));
      return outer[outermost / 2];
    };
    const double left = median_from(0);
    const double right = median_from(count - outermost);
    peak_ = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const double share = static_cast<double>(i) / static_cast<double>(count - 1);
      dark_[i] -= left + share * (right - left);
      peak_ = std::max(peak_, dark_[i]);
    }
    return peak_ > kContrast;
  }

  [[nodiscard]] double centroid(double middle, double reach) const {
    double sum = 0;
    double moment = 0;
    for (int i = -half_; i <= half_; ++i) {
      const double s = kSample * i;
      // The outermost samples count in part, so that the reach need not be a whole number of them.
      const double weight = std::clamp((reach - std::abs(s - middle)) / kSample + 0.5, 0.0, 1.0);
      const double dark = dark_[static_cast<std::size_t>(i + half_)] - kFoot * peak_;
      if (!(dark > 0)) continue;
      sum += weight * dark;
      moment += weight * dark * s;
    }
    return sum > 0 ? moment / sum : 0;
  }

  int half_ = 0;
  double peak_ = 0;
  std::vector<double> dark_;
};

// A line about a crossing: off(t) = c0 + c1 t + c2 t^2 px along the normal, t px along the line.
struct Parabola {
  Eigen::Vector2d from;
  Eigen::Vector2d direction;
  Eigen::Vector2d normal;
  Eigen::Vector3d c = Eigen::Vector3d::Zero();
  double variance = 0;  // px^2, of c0
  double residual = 0;  // px, RMS of the centres

  // How far a place is from the line, px, and the slope of the line there.
  [[nodiscard]] double off(const Eigen::Vector2d& p) const {
    const double t = direction.dot(p - from);
    return normal.dot(p - from) - (c[0] + t * (c[1] + t * c[2]));
  }
  [[nodiscard]] Eigen::RowVector2d gradient(const Eigen::Vector2d& p) const {
    const double t = direction.dot(p - from);
    return normal.transpose() - (c[1] + 2 * t * c[2]) * direction.transpose();
  }
};

struct Centre {
  double t = 0;    // px along the line
  double off = 0;  // px along the normal
};

// The least squares fit; false for too few centres.
bool fit(const std::vector<Centre>& centres, Parabola& line) {
  constexpr std::size_t kFewest = 6;
  if (centres.size() < kFewest) return false;
  Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const Centre& c : centres) {
    const Eigen::Vector3d by(1, c.t, c.t * c.t);
    m += by * by.transpose();
    right += c.off * by;
  }
  const auto factor = m.ldlt();
  line.c = factor.solve(right);
  double square = 0;
  for (const Centre& c : centres) {
    square += std::pow(c.off - line.c.dot(Eigen::Vector3d(1, c.t, c.t * c.t)), 2);
  }
  line.residual = std::sqrt(square / static_cast<double>(centres.size()));
  const Eigen::Vector3d column = factor.solve(Eigen::Vector3d::UnitX());
  line.variance = column[0] * square / static_cast<double>(centres.size() - 3);
  return line.c.allFinite() && std::isfinite(line.variance);
}

// Drops centres that are far off the others.
void drop_strays(std::vector<Centre>& centres, const Parabola& line) {
  constexpr double kFar = 4;       // of the median
  constexpr double kAlways = 0.1;  // px
  const auto off = [&](const Centre& c) {
    return std::abs(c.off - line.c.dot(Eigen::Vector3d(1, c.t, c.t * c.t)));
  };
  std::vector<double> all;
  for (const Centre& c : centres) all.push_back(off(c));
  std::ranges::nth_element(all, all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2));
  const double most = kFar * all[all.size() / 2] + kAlways;
  std::erase_if(centres, [&](const Centre& c) { return off(c) > most; });
}

// The line through a place, by its centres between the line across and the next ones.
std::optional<Parabola> line_through(const ImageView& image, const Eigen::Vector2d& from,
                                     const Eigen::Vector2d& step, const Eigen::Vector2d& across,
                                     bool light) {
  constexpr double kFirst = 0.2;  // of the step
  constexpr double kLast = 0.45;
  constexpr double kReach = 0.4;      // of the distance to the next line
  constexpr double kLeastApart = 11;  // px: closer lines leave no ground between them
  constexpr int kLeast = 5;
  constexpr int kMost = 16;          // centres on a side
  constexpr double kScatter = 0.04;  // of the step: more is none of a line
  constexpr double kEven = 0.6;      // the least of the ink on one half of an arm, of the other's
  const double length = step.norm();
  Parabola line;
  line.from = from;
  line.direction = step / length;
  line.normal = {-line.direction.y(), line.direction.x()};
  // Across the line along the other one, which is as far away from all samples then.
  const Eigen::Vector2d beside = across.normalized();
  const double reach = kReach * across.norm();
  if (!(std::abs(line.normal.dot(across)) >= kLeastApart) || !(length < 1e4)) return std::nullopt;
  const int count = std::clamp(static_cast<int>((kLast - kFirst) * length), kLeast, kMost);
  std::vector<Centre> centres;
  Profile profile;
  for (const int side : {-1, 1}) {
    int seen = 0;
    double inner = 0;
    double outer = 0;
    for (int i = 0; i < count; ++i) {
      const double t = side * length * (kFirst + (kLast - kFirst) * (i + 0.5) / count);
      if (!profile.take(image, from + t * line.direction, beside, reach, light)) continue;
      const Eigen::Vector2d off = t * line.direction + profile.centre() * beside;
      centres.push_back({line.direction.dot(off), line.normal.dot(off)});
      (2 * i < count ? inner : outer) += profile.ink();
      ++seen;
    }
    // The dark squares of a checkerboard become narrow towards their corners.
    if (2 * seen < count || outer < kEven * inner) return std::nullopt;
  }
  if (!fit(centres, line)) return std::nullopt;
  drop_strays(centres, line);
  if (!fit(centres, line) || line.residual > kScatter * length) return std::nullopt;
  return line;
}

// Newton's steps to where two lines meet.
std::optional<Eigen::Vector2d> meeting(const Parabola& a, const Parabola& b) {
  constexpr int kSteps = 4;
  Eigen::Vector2d at = a.from;
  for (int i = 0; i < kSteps; ++i) {
    Eigen::Matrix2d by;
    by << a.gradient(at), b.gradient(at);
    if (std::abs(by.determinant()) < 0.1) return std::nullopt;
    at -= by.inverse() * Eigen::Vector2d(a.off(at), b.off(at));
  }
  if (!at.allFinite()) return std::nullopt;
  return at;
}

}  // namespace

std::optional<CrossingFit> fit_crossing(const ImageView& image, const Pixel& start,
                                        const Eigen::Vector2d& along, const Eigen::Vector2d& down,
                                        bool light) {
  constexpr int kRounds = 2;         // the second one from where the first one ended
  constexpr double kFarthest = 0.2;  // of a step, from the start
  constexpr double kFloor = 0.003;   // px: what a fit of few pixels may be off without showing it
  const Eigen::Vector2d from(start.u, start.v);
  Eigen::Vector2d at = from;
  CrossingFit result;
  for (int i = 0; i < kRounds; ++i) {
    const auto a = line_through(image, at, along, down, light);
    const auto b = a ? line_through(image, at, down, along, light) : std::nullopt;
    const auto met = b ? meeting(*a, *b) : std::nullopt;
    if (!met || (*met - from).norm() > kFarthest * std::min(along.norm(), down.norm())) {
      return std::nullopt;
    }
    at = *met;
    result.sigma = std::hypot(std::sqrt((a->variance + b->variance) / 2), kFloor);
  }
  result.at = {at.x(), at.y()};
  return result;
}

}  // namespace calvin::detect
