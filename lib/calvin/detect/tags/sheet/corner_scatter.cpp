// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Linear fits to the distances of corners from a map: a polynomial, and a growth of all tags.

#include "calvin/detect/tags/sheet/corner_scatter.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "calvin/geometry/median.hpp"

namespace calvin::detect {

namespace {

constexpr std::size_t kFewestToCompare = 12;  // corners
constexpr double kCertain = 5;                // sigmas, by which a corner is off
constexpr int kDegree = 5;                    // of what a lens leaves of a map

// A column of two numbers for each corner, without what a polynomial over the image has of it.
class Column {
 public:
  Column(const std::vector<SheetCorner>& corners, std::vector<Point> values)
      : values_(std::move(values)) {
    std::vector<Pixel> at;
    Eigen::MatrixX2d used(static_cast<Eigen::Index>(corners.size()), 2);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      if (corners[i].is_off) continue;
      used.row(static_cast<Eigen::Index>(at.size())) = values_[i].transpose();
      at.push_back(corners[i].image);
    }
    const Polynomial smooth(at, used.topRows(static_cast<Eigen::Index>(at.size())), kDegree);
    numbers_ = smooth.numbers();
    for (std::size_t i = 0; i < corners.size(); ++i) values_[i] -= smooth.at(corners[i].image);
  }

  // Of the polynomial, for each of the two numbers.
  [[nodiscard]] int numbers() const { return numbers_; }
  [[nodiscard]] const Point& operator[](std::size_t i) const { return values_[i]; }
  [[nodiscard]] double dot(const Column& other, const std::vector<SheetCorner>& corners) const {
    double sum = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      if (!corners[i].is_off) {
        sum += values_[i].dot(other.values_[i]) / (corners[i].sigma * corners[i].sigma);
      }
    }
    return sum;
  }

 private:
  std::vector<Point> values_;
  int numbers_ = 0;
};

// A growth that explains most of what is rough.
struct Growth {
  Point SheetCorner::*of = nullptr;
  double amount = 0;  // px
  double gain = 0;    // of the sum of squares, in sigmas
};

Growth growth_of(const std::vector<SheetCorner>& corners, const Column& rough,
                 Point SheetCorner::*of, double most) {
  std::vector<Point> values;
  for (const SheetCorner& c : corners) values.push_back(c.*of);
  const Column column(corners, std::move(values));
  const double square = column.dot(column, corners);
  Growth growth{of, 0, 0};
  // Few tags do not tell a growth from what a lens does: it has to be known by far better than a
  // corner is.
  constexpr double kLeast = 4;  // the square of how many times better
  std::vector<double> sigmas;
  for (const SheetCorner& c : corners) sigmas.push_back(c.sigma);
  const double sigma = median_of(std::move(sigmas));
  if (!(square * sigma * sigma > kLeast)) return growth;
  const double product = column.dot(rough, corners);
  growth.amount = product / square;
  growth.gain = product * growth.amount;
  if (std::abs(growth.amount) > most) growth = {of, 0, 0};
  return growth;
}

// How far each corner is from where the map has it, px.
std::vector<Point> distances_from(const LensMap& map, const std::vector<SheetCorner>& corners) {
  std::vector<Point> off;
  for (const SheetCorner& c : corners) {
    const Pixel expected = map.image_of(c.plane);
    off.emplace_back(c.image.u - expected.u, c.image.v - expected.v);
  }
  return off;
}

// The growth of either kind that explains more, of each corner.
std::vector<Point> growth_of(const std::vector<SheetCorner>& corners, const std::vector<Point>& off,
                             double most) {
  const Column rough(corners, off);
  const Growth in_image = growth_of(corners, rough, &SheetCorner::outwards, most);
  const Growth on_board = growth_of(corners, rough, &SheetCorner::outwards_plane, most);
  const Growth growth = on_board.gain > in_image.gain ? on_board : in_image;
  std::vector<Point> all;
  for (const SheetCorner& c : corners) all.push_back(growth.amount * (c.*growth.of));
  return all;
}

// Marks the corners that are off by far more than the others, in their sigmas. Absent where too few
// are left to tell; else whether a mark has changed.
std::optional<bool> mark_off(std::vector<SheetCorner>& corners, const std::vector<double>& errors) {
  constexpr double kMedian = 1.1774;  // of the length of a vector with two errors of 1 sigma
  constexpr double kFinest = 0.005;   // px, that a map may lack
  std::vector<double> usual;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (!corners[i].is_off) usual.push_back(errors[i] / corners[i].sigma);
  }
  if (usual.size() < kFewestToCompare) return std::nullopt;
  const double scale = std::max(median_of(std::move(usual)) / kMedian, 1.0);
  bool changed = false;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const bool is_off = errors[i] > kCertain * (scale * corners[i].sigma + kFinest);
    changed = changed || is_off != corners[i].is_off;
    corners[i].is_off = is_off;
  }
  return changed;
}

// The errors of corners over their sigmas, of which a fit with so many numbers has taken a part.
double factor_of(const std::vector<SheetCorner>& corners, const std::vector<double>& errors,
                 double numbers) {
  constexpr double kPrior = 20;  // as if so many more were as they should be: few tell little
  double square = 0;
  double count = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (corners[i].is_off) continue;
    square += std::pow(errors[i] / corners[i].sigma, 2);
    count += 2;
  }
  return std::sqrt((square + kPrior) / (std::max(count - numbers, 1.0) + kPrior));
}

}  // namespace

std::optional<CornerScatter> corner_scatter(std::vector<SheetCorner>& corners, const LensMap& map,
                                            double most) {
  constexpr int kRounds = 4;
  if (corners.size() < kFewestToCompare) return std::nullopt;
  const std::vector<Point> off = distances_from(map, corners);
  CornerScatter scatter;
  std::vector<double> errors(corners.size());  // px
  double numbers = 0;
  for (int round = 0; round < kRounds; ++round) {
    scatter.growth = growth_of(corners, off, most);
    std::vector<Point> left = off;
    for (std::size_t i = 0; i < corners.size(); ++i) left[i] -= scatter.growth[i];
    const Column rest(corners, std::move(left));
    numbers = 2 * rest.numbers() + 1;
    for (std::size_t i = 0; i < corners.size(); ++i) errors[i] = rest[i].norm();
    const auto changed = mark_off(corners, errors);
    if (!changed) return std::nullopt;
    if (!*changed) break;
  }
  scatter.factor = factor_of(corners, errors, numbers);
  return scatter;
}

}  // namespace calvin::detect
