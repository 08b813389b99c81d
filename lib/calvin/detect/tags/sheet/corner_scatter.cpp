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

// Two numbers for each corner.
using Column = std::vector<Point>;

// The distances of corners from the map, and how both kinds of growth move them, without what a
// polynomial over the image has of each.
struct RoughParts {
  Column off;
  Column in_image;
  Column on_board;
  int numbers = 0;  // of the polynomial, for each of the two numbers
};

RoughParts rough_parts(const std::vector<SheetCorner>& corners, const Column& off) {
  const auto count = static_cast<Eigen::Index>(corners.size());
  Eigen::MatrixXd all(count, Polynomial::kMostValues);
  std::vector<Pixel> at;
  Eigen::MatrixXd used(count, Polynomial::kMostValues);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const SheetCorner& c = corners[i];
    auto row = all.row(static_cast<Eigen::Index>(i));
    row << off[i].transpose(), c.outwards.transpose(), c.outwards_plane.transpose();
    if (c.is_off) continue;
    used.row(static_cast<Eigen::Index>(at.size())) = row;
    at.push_back(c.image);
  }
  const Polynomial smooth(at, used.topRows(static_cast<Eigen::Index>(at.size())), kDegree);
  RoughParts parts;
  parts.numbers = smooth.numbers();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Polynomial::Values rough =
        all.row(static_cast<Eigen::Index>(i)) - smooth.all_at(corners[i].image);
    parts.off.emplace_back(rough[0], rough[1]);
    parts.in_image.emplace_back(rough[2], rough[3]);
    parts.on_board.emplace_back(rough[4], rough[5]);
  }
  return parts;
}

// The sum over the corners that count of the products of two columns, in sigmas.
double product(const Column& a, const Column& b, const std::vector<SheetCorner>& corners) {
  double sum = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (!corners[i].is_off) sum += a[i].dot(b[i]) / (corners[i].sigma * corners[i].sigma);
  }
  return sum;
}

// A growth that explains most of what is rough.
struct Growth {
  Point SheetCorner::*of = nullptr;
  const Column* rough = nullptr;  // what is rough of it
  double amount = 0;              // px
  double gain = 0;                // of the sum of squares, in sigmas
};

Growth growth_of(const std::vector<SheetCorner>& corners, const Column& off, const Column& rough,
                 Point SheetCorner::*of, double most) {
  const double square = product(rough, rough, corners);
  Growth growth{of, &rough, 0, 0};
  // Few tags do not tell a growth from what a lens does: it has to be known by far better than a
  // corner is.
  constexpr double kLeast = 4;  // the square of how many times better
  std::vector<double> sigmas;
  for (const SheetCorner& c : corners) sigmas.push_back(c.sigma);
  const double sigma = median_of(std::move(sigmas));
  if (!(square * sigma * sigma > kLeast)) return growth;
  const double both = product(rough, off, corners);
  growth.amount = both / square;
  growth.gain = both * growth.amount;
  if (std::abs(growth.amount) > most) growth = {of, &rough, 0, 0};
  return growth;
}

// The growth of either kind that explains more.
Growth growth_of(const std::vector<SheetCorner>& corners, const RoughParts& parts, double most) {
  const Growth in_image =
      growth_of(corners, parts.off, parts.in_image, &SheetCorner::outwards, most);
  const Growth on_board =
      growth_of(corners, parts.off, parts.on_board, &SheetCorner::outwards_plane, most);
  return on_board.gain > in_image.gain ? on_board : in_image;
}

// How far each corner is from where the map has it, px.
Column distances_from(const LensMap& map, const std::vector<SheetCorner>& corners) {
  Column off;
  for (const SheetCorner& c : corners) {
    const Pixel expected = map.image_of(c.plane);
    off.emplace_back(c.image.u - expected.u, c.image.v - expected.v);
  }
  return off;
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
  const Column off = distances_from(map, corners);
  CornerScatter scatter;
  scatter.growth.resize(corners.size());
  std::vector<double> errors(corners.size());  // px
  double numbers = 0;
  for (int round = 0; round < kRounds; ++round) {
    const RoughParts parts = rough_parts(corners, off);
    const Growth growth = growth_of(corners, parts, most);
    numbers = 2 * parts.numbers + 1;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      scatter.growth[i] = growth.amount * (corners[i].*growth.of);
      errors[i] = (parts.off[i] - growth.amount * (*growth.rough)[i]).norm();
    }
    const auto changed = mark_off(corners, errors);
    if (!changed) return std::nullopt;
    if (!*changed) break;
  }
  scatter.factor = factor_of(corners, errors, numbers);
  return scatter;
}

}  // namespace calvin::detect
