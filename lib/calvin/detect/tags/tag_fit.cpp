// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Fits four sides, and lets neighbouring ones meet.

#include "calvin/detect/tags/tag_fit.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/LU>

#include "calvin/detect/tags/side_pixels.hpp"

namespace calvin::detect {

namespace {

constexpr double kMostSigma = 0.5;  // px

// An end of a side: the tangent there.
struct Tangent {
  Point at;
  Point normal;
  double sigma = 0;  // px, along the normal
};

Tangent tangent_of(const SideGuess& guess, const SideFit& fit, int end) {
  const Point along = (guess.to - guess.from).normalized();
  const Point outwards(along.y(), -along.x());
  const Point& corner = end == 0 ? guess.from : guess.to;
  const Point direction = along + fit.slope[end] * outwards;
  return {corner + fit.offset[end] * outwards, Point(direction.y(), -direction.x()).normalized(),
          fit.sigma[end]};
}

// Where two sides meet, and 1 sigma per coordinate; absent where they hardly do.
struct Meeting {
  Point at;
  double sigma = 0;
};
std::optional<Meeting> meet(const Tangent& a, const Tangent& b) {
  Eigen::Matrix2d normals;
  normals << a.normal.transpose(), b.normal.transpose();
  constexpr double kParallel = 0.08;
  if (std::abs(normals.determinant()) < kParallel) return std::nullopt;
  const Eigen::Matrix2d inverse = normals.inverse();
  const Point at = inverse * Point(a.normal.dot(a.at), b.normal.dot(b.at));
  const Eigen::Matrix2d covariance =
      inverse * Point(a.sigma * a.sigma, b.sigma * b.sigma).asDiagonal() * inverse.transpose();
  return Meeting{at, std::sqrt(0.5 * covariance.trace())};
}

// A side of a tag and what is beside it.
class SideOf {
 public:
  SideOf(const Quad& corners, const TagPattern& pattern, std::size_t side)
      : pattern_(pattern), side_(side), map_(from_cells(corners, pattern.cells())) {
    guess_.from = corners[side];
    guess_.to = corners[(side + 1) % 4];
    guess_.inverted = pattern.inverted;
    guess_.beyond = pattern.neighbours[side];
    const SideFrame frame(guess_);
    guess_.border = edge(frame, pattern.border);
    guess_.second = edge(frame, pattern.border + 1);
    guess_.gap = edge(frame, -pattern.gap);
    for (int i = 0; i <= pattern.side; ++i) {
      guess_.cuts.push_back(frame.along(at(pattern.border + i, pattern.border + 0.5)));
      if (i == pattern.side) break;
      guess_.first.push_back(bit(i, 0));
      guess_.behind.push_back(bit(i, 1));
    }
    add_outer_bits(frame);
  }

  [[nodiscard]] const SideGuess& guess() const { return guess_; }

 private:
  void add_outer_bits(const SideFrame& frame) {
    const int outside = pattern_.outside();
    const int end = pattern_.cells() + outside;
    for (int i = -outside; outside > 0 && i <= end; ++i) {
      guess_.outer_cuts.push_back(frame.along(at(i, -pattern_.gap - 0.5)));
      if (i < end) guess_.outer.push_back(1 - cell(i, -static_cast<int>(pattern_.gap) - 1));
    }
  }
  [[nodiscard]] Point at(double along, double inwards) const {
    const Point place = pattern_.place(side_, along, inwards);
    const Eigen::Vector3d p = map_ * Eigen::Vector3d(place.x(), place.y(), 1);
    return p.head<2>() / p.z();
  }
  // The line so many cells inwards.
  [[nodiscard]] NextEdge edge(const SideFrame& frame, double inwards) const {
    const Point from = at(0, inwards);
    const Point to = at(pattern_.cells(), inwards);
    const double t0 = frame.along(from);
    const double t1 = frame.along(to);
    const double n0 = frame.across(from);
    const double slope = (frame.across(to) - n0) / std::max(t1 - t0, 1e-6);
    return {n0 - slope * t0, slope};
  }
  [[nodiscard]] float bit(int along, int row) const {
    return cell(pattern_.border + along, pattern_.border + row);
  }
  [[nodiscard]] float cell(int along, int inwards) const {
    const Point middle = pattern_.place(side_, along + 0.5, inwards + 0.5);
    const auto line = [](double x) { return static_cast<int>(std::floor(x)); };
    return pattern_.is_light(line(middle.x()), line(middle.y())) ? 1.0F : 0.0F;
  }

  const TagPattern& pattern_;
  std::size_t side_;
  Eigen::Matrix3d map_;
  SideGuess guess_;
};

// The sides of a tag where they can be fitted.
struct FittedSides {
  std::array<SideGuess, 4> guesses;
  std::array<std::optional<SideFit>, 4> sides;
};

FittedSides fit_sides(const ImageView& image, const TagGuess& tag, const TagPattern& pattern) {
  FittedSides fitted;
  for (std::size_t i = 0; i < 4; ++i) {
    SideGuess& guess = fitted.guesses[i];
    guess = SideOf(tag.corners, pattern, i).guess();
    // Not as far as the next edge.
    guess.reach = std::min({tag.reach, 0.6 * room_inside(guess), 0.6 * room_outside(guess)});
    guess.bend = tag.bends.at[i];
    guess.bend_sigma = tag.bends.sigma[i];
    guess.width = tag.width;
    guess.care = tag.care;
    fitted.sides[i] = fit_side(image, guess);
  }
  return fitted;
}

// Where the sides before and from a corner on meet; absent where one is missing, or they meet
// elsewhere.
std::optional<Meeting> meet_at(const FittedSides& fitted, const Quad& corners, std::size_t i,
                               double reach) {
  const std::size_t before = (i + 3) % 4;
  if (!fitted.sides[before] || !fitted.sides[i]) return std::nullopt;
  const auto meeting = meet(tangent_of(fitted.guesses[before], *fitted.sides[before], 1),
                            tangent_of(fitted.guesses[i], *fitted.sides[i], 0));
  if (!meeting || (meeting->at - corners[i]).norm() > 2 * reach + 2) return std::nullopt;
  return meeting;
}

TagFit fit_once(const ImageView& image, const TagGuess& guess, const TagPattern& pattern) {
  const FittedSides fitted = fit_sides(image, guess, pattern);
  const Quad& corners = guess.corners;
  TagFit tag;
  tag.corners = corners;
  tag.is_rough = guess.care == SideCare::kRough;
  for (const auto& side : fitted.sides) {
    if (!side) continue;
    ++tag.sides;
    tag.width += side->width;
  }
  if (tag.sides > 0) tag.width /= tag.sides;
  Point moved = Point::Zero();
  std::array<bool, 4> met{};
  for (std::size_t i = 0; i < 4; ++i) {
    const auto meeting = meet_at(fitted, corners, i, guess.reach);
    if (!meeting) continue;
    met[i] = true;
    tag.corners[i] = meeting->at;
    moved += meeting->at - corners[i];
    const bool is_seen =
        fitted.sides[(i + 3) % 4]->seen[1] && fitted.sides[i]->seen[0] && is_in(image, meeting->at);
    if (is_seen && meeting->sigma <= kMostSigma) tag.sigma[i] = meeting->sigma;
  }
  // A corner that was not fitted moves as the others do.
  const auto count = static_cast<double>(std::ranges::count(met, true));
  for (std::size_t i = 0; i < 4 && count > 0; ++i) {
    if (!met[i]) tag.corners[i] += moved / count;
  }
  return tag;
}
}  // namespace

int TagFit::seen() const {
  return static_cast<int>(std::ranges::count_if(sigma, [](double s) { return s > 0; }));
}

TagBends unknown_bends(const Quad& corners) {
  constexpr double kUnknown = 0.02;  // of the length
  TagBends bends;
  for (std::size_t i = 0; i < 4; ++i) {
    bends.sigma[i] = kUnknown * std::max((corners[(i + 1) % 4] - corners[i]).norm(), 1.0);
  }
  return bends;
}

TagFit fit_tag(const ImageView& image, const TagGuess& guess, const TagPattern& pattern) {
  if (guess.care != SideCare::kFull) return fit_once(image, guess, pattern);
  // What is beside a side is thought to be where the guess has it: it has to be a good one.
  TagGuess better = guess;
  better.care = SideCare::kRough;
  const TagFit rough = fit_once(image, better, pattern);
  if (rough.seen() == 4) {
    better = {rough.corners, 1, guess.bends, rough.width, SideCare::kAgain};
    const TagFit fit = fit_once(image, better, pattern);
    if (fit.seen() == 4) return fit;
  }
  return fit_once(image, guess, pattern);
}

}  // namespace calvin::detect
