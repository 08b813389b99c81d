// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Differences and residuals of a lattice laid flat, compared with the sigmas of its corners.

#include "calvin/detect/checkerboard/fits/scatter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "calvin/geometry/dense.hpp"

namespace calvin::detect {

namespace {

using Homography = Eigen::Matrix<double, 8, 1>;  // row by row, the last number is 1

struct Place {
  double x = 0;
  double y = 0;

  // Places are px: their squares do not overflow, which std::hypot() takes time to avoid.
  [[nodiscard]] double length() const { return std::sqrt(x * x + y * y); }
};

Place image_of(const Homography& h, Place p) {
  const double w = h[6] * p.x + h[7] * p.y + 1;
  return {(h[0] * p.x + h[1] * p.y + h[2]) / w, (h[3] * p.x + h[4] * p.y + h[5]) / w};
}

// A one-parameter model of a wide lens, equidistant: a place r px from the middle of the image is
// seen at an angle of `bend` r radians to the axis. It makes a plane of a board before most
// fisheyes.
struct Lens {
  Place middle;     // px
  double bend = 0;  // rad/px; 0: a pinhole

  [[nodiscard]] Place from_middle(const Node& node) const {
    return {static_cast<double>(node.x) - middle.x, static_cast<double>(node.y) - middle.y};
  }
  // The place, from the middle, where a lens without distortion would show a node.
  [[nodiscard]] Place straight(const Node& node) const {
    const Place p = from_middle(node);
    const double angle = bend * p.length();
    const double scale = angle > 0 ? std::tan(angle) / angle : 1;
    return {scale * p.x, scale * p.y};
  }
  // A small way between straightened places, in px of the image around a node.
  [[nodiscard]] Place seen(Place way, const Node& node) const {
    const Place p = from_middle(node);
    const double radius = p.length();
    const double angle = bend * radius;
    if (!(angle > 0)) return way;
    const double across = angle / std::tan(angle);
    // The radial part of the way; lengths change more along the radius than across it.
    const double outwards = (way.x * p.x + way.y * p.y) / (radius * radius);
    const double more = outwards * (std::cos(angle) * std::cos(angle) - across);
    return {across * way.x + more * p.x, across * way.y + more * p.y};
  }
};

// A grid, and its places in the straightened image (px) with the homography between them. Both are
// taken from the middle of the lattice, which keeps the normal equations well conditioned.
class Flattened {
 public:
  Flattened(const Lattice& lattice, const Lens& lens) : lattice_(lattice), lens_(lens) {
    lattice.for_each([&](Cell c, const Node& node) {
      const double n = ++count_;
      const Place at = lens_.straight(node);
      const LatticePlace place = lattice.place(c);
      middle_.x += (place.col - middle_.x) / n;
      middle_.y += (place.row - middle_.y) / n;
      origin_.x += (at.x - origin_.x) / n;
      origin_.y += (at.y - origin_.y) / n;
    });
    Eigen::Matrix<double, 8, 8> normal = Eigen::Matrix<double, 8, 8>::Identity() * 1e-9;
    Homography right = Homography::Zero();
    lattice.for_each([&](Cell c, const Node& node) {
      const Place p = from_middle(c);
      const Place q = straight(node);
      Homography u;
      Homography v;
      u << p.x, p.y, 1, 0, 0, 0, -q.x * p.x, -q.x * p.y;
      v << 0, 0, 0, p.x, p.y, 1, -q.y * p.x, -q.y * p.y;
      normal += u * u.transpose() + v * v.transpose();
      right += q.x * u + q.y * v;
    });
    homography_ = solve_symmetric(normal, right);
  }

  // How far a node is from where the homography has it, px of the image.
  [[nodiscard]] Place off(Cell c) const {
    const Node& node = lattice_.at(c);
    const Place at = straight(node);
    const Place expected = image_of(homography_, from_middle(c));
    return lens_.seen({at.x - expected.x, at.y - expected.y}, node);
  }
  // The sum over the nodes of the square of off().
  [[nodiscard]] double square_off() const {
    double sum = 0;
    lattice_.for_each([&](Cell c, const Node& /*node*/) {
      const Place o = off(c);
      sum += o.x * o.x + o.y * o.y;
    });
    return sum;
  }

  // Whether the root mean square of off() is a part of the squares that only wide lenses reach.
  [[nodiscard]] bool is_strongly_bent() const {
    constexpr double kStrongly = 0.04;  // of a square's side
    const auto& h = homography_;
    const double square = std::abs(h[0] * h[4] - h[1] * h[3]);  // px^2, in the middle
    return square_off() > kStrongly * kStrongly * square * count_;
  }

 private:
  [[nodiscard]] Place from_middle(Cell c) const {
    const LatticePlace place = lattice_.place(c);
    return {place.col - middle_.x, place.row - middle_.y};
  }
  [[nodiscard]] Place straight(const Node& node) const {
    const Place at = lens_.straight(node);
    return {at.x - origin_.x, at.y - origin_.y};
  }

  const Lattice& lattice_;
  Lens lens_;
  int count_ = 0;
  Place middle_;
  Place origin_;
  Homography homography_;
};

// The lens before which the lattice is most like a plane, by a search over its bend.
Lens lens_of(const Lattice& lattice, ImageSize image) {
  constexpr double kWidest = 1.45;  // rad, of the farthest node
  constexpr int kSteps = 15;
  constexpr int kRounds = 8;
  const Place middle = {0.5 * (image.width - 1), 0.5 * (image.height - 1)};
  double farthest = 1;
  lattice.for_each([&](Cell /*c*/, const Node& node) {
    const Place p = Lens{middle}.from_middle(node);
    farthest = std::max(farthest, p.length());
  });
  const double widest = kWidest / farthest;
  Lens best = {middle, 0};
  double least = Flattened(lattice, best).square_off();
  const auto consider = [&](double bend) {
    if (!(bend > 0 && bend <= widest)) return;
    const double off = Flattened(lattice, {middle, bend}).square_off();
    if (!(off < least)) return;
    least = off;
    best.bend = bend;
  };
  for (int i = 1; i <= kSteps; ++i) consider(widest * i / kSteps);
  double step = widest / kSteps;
  for (int round = 0; round < kRounds; ++round) {
    step /= 2;
    const double from = best.bend;
    consider(from - step);
    consider(from + step);
  }
  return best;
}

// The weights of divided differences over so many lines: from an even one on, and from an odd one.
template <std::size_t kLines>
using Weights = std::array<std::array<double, kLines>, 2>;

template <std::size_t kLines>
std::array<double, kLines> difference_over(const Lattice& lattice, int first, bool is_col) {
  std::array<double, kLines> weights{};
  const auto place = [&](std::size_t i) {
    return static_cast<double>(lattice.place(first + static_cast<int>(i), is_col));
  };
  for (std::size_t i = 0; i < kLines; ++i) {
    weights[i] = 1;
    for (std::size_t k = 0; k < kLines; ++k) {
      if (k != i) weights[i] /= place(i) - place(k);
    }
  }
  return weights;
}

template <std::size_t kLines>
Weights<kLines> weights_of(const Lattice& lattice, bool is_col) {
  return {difference_over<kLines>(lattice, 0, is_col), difference_over<kLines>(lattice, 1, is_col)};
}

// The sum of the squares of mixed differences, each over its variance by the corners' sigmas.
class Squares {
 public:
  Squares(const Lattice& lattice, const Flattened& flat)
      : lattice_(lattice), extent_(lattice.extent()) {
    errors_.resize(static_cast<std::size_t>(std::max(extent_.cols() * extent_.rows(), 0)));
    lattice.for_each([&](Cell c, const Node& node) {
      const auto sigma = static_cast<double>(node.sigma);
      errors_[index(c)] = {flat.off(c), sigma * sigma};
    });
  }

  // Takes every place where the lattice has all corners of a difference over so many lines along
  // the rows and along the columns, in both directions.
  template <std::size_t kAlong, std::size_t kAside>
  void take() {
    sum_ = count_ = 0;
    const auto long_cols = weights_of<kAlong>(lattice_, true);
    const auto long_rows = weights_of<kAlong>(lattice_, false);
    const auto short_cols = weights_of<kAside>(lattice_, true);
    const auto short_rows = weights_of<kAside>(lattice_, false);
    lattice_.for_each([&](Cell c, const Node& /*node*/) {
      add(c, long_cols, short_rows);
      add(c, short_cols, long_rows);
    });
  }
  [[nodiscard]] double sum() const { return sum_; }
  [[nodiscard]] double count() const { return count_; }

 private:
  // The difference that begins in a cell.
  template <std::size_t kCols, std::size_t kRows>
  void add(Cell first, const Weights<kCols>& all_cols, const Weights<kRows>& all_rows) {
    const auto& cols = all_cols[static_cast<std::size_t>(first.col & 1)];
    const auto& rows = all_rows[static_cast<std::size_t>(first.row & 1)];
    Place difference;
    double variance = 0;
    for (std::size_t i = 0; i < kCols; ++i) {
      for (std::size_t k = 0; k < kRows; ++k) {
        const Cell c = first + Cell{static_cast<int>(i), static_cast<int>(k)};
        if (!lattice_.has(c)) return;
        const double weight = cols[i] * rows[k];
        const Error& error = errors_[index(c)];
        difference.x += weight * error.off.x;
        difference.y += weight * error.off.y;
        variance += weight * weight * error.variance;
      }
    }
    sum_ += 0.5 * (difference.x * difference.x + difference.y * difference.y) / variance;
    ++count_;
  }

  // How far a node is from where the homography has it, px, and the variance of that.
  struct Error {
    Place off;
    double variance = 0;
  };
  [[nodiscard]] std::size_t index(Cell c) const {
    const Cell from = c - extent_.first;
    return static_cast<std::size_t>(from.row * extent_.cols() + from.col);
  }

  const Lattice& lattice_;
  CellRange extent_;
  std::vector<Error> errors_;  // of the cells of the extent
  double sum_ = 0;
  double count_ = 0;
};

// The ratio of the corners' errors to their sigmas, by differences.
double ratio_by(const Lattice& lattice, const Flattened& flat) {
  constexpr double kPresumed = 1;  // this many differences are added that say 1
  constexpr double kEnough = 6;    // differences over six corners by five, else five by four
  Squares squares(lattice, flat);
  squares.take<6, 5>();
  if (squares.count() < kEnough) squares.take<5, 4>();
  return std::sqrt((squares.sum() + kPresumed) / (squares.count() + kPresumed));
}

// For each axis a surface through the distances from the homography: a polynomial of total degree
// five, which follows what most lenses make of a grid.
constexpr int kDegree = 5;
constexpr int kTerms = (kDegree + 1) * (kDegree + 2) / 2;
using Terms = Eigen::Matrix<double, kTerms, 1>;

Terms terms_at(Place p) {
  Terms terms;
  int i = 0;
  double x_power = 1;
  for (int a = 0; a <= kDegree; ++a, x_power *= p.x) {
    double power = x_power;
    for (int b = 0; a + b <= kDegree; ++b, power *= p.y) terms[i++] = power;
  }
  return terms;
}

// The ratio by the residuals of the surface. It uses all corners, and so its standard deviation is
// a third of that by differences, unless a lens bends the board more than the surface. Absent where
// corners are few.
std::optional<double> ratio_beside_surface(const Lattice& lattice, const Flattened& flat) {
  constexpr int kFewestNodes = 2 * kTerms;
  if (lattice.count() < kFewestNodes) return std::nullopt;
  Box box;
  lattice.for_each([&](Cell /*c*/, const Node& node) { box.add(node.x, node.y); });
  // Over places in the image, where the distortion itself is nearly such a polynomial.
  const auto place = [&](const Node& node) {
    const double width = box.right - box.left;
    const double height = box.bottom - box.top;
    return Place{2 * (node.x - box.left) / width - 1, 2 * (node.y - box.top) / height - 1};
  };
  Eigen::Matrix<double, kTerms, kTerms> normal =
      Eigen::Matrix<double, kTerms, kTerms>::Identity() * 1e-9;
  Eigen::Matrix<double, kTerms, 2> right = Eigen::Matrix<double, kTerms, 2>::Zero();
  double sum = 0;
  lattice.for_each([&](Cell c, const Node& node) {
    const double weight = 1 / (static_cast<double>(node.sigma) * static_cast<double>(node.sigma));
    const Terms terms = terms_at(place(node));
    const Place off = flat.off(c);
    normal.selfadjointView<Eigen::Lower>().rankUpdate(terms, weight);
    right.col(0) += weight * off.x * terms;
    right.col(1) += weight * off.y * terms;
    sum += weight * (off.x * off.x + off.y * off.y);
  });
  const Eigen::Matrix<double, kTerms, 2> surface = solve_symmetric(normal, right);
  const double left = sum - surface.cwiseProduct(right).sum();
  return std::sqrt(std::max(left, 0.0) / (2.0 * (lattice.count() - kTerms)));
}

double mean_sigma(const Lattice& lattice) {
  double sum = 0;
  lattice.for_each([&](Cell /*c*/, const Node& node) { sum += static_cast<double>(node.sigma); });
  return sum / lattice.count();
}

// Whether the ratio by the surface is one of errors, and not of what the lens leaves beside the
// surface. `error`: of a corner by the surface, px, where a wide lens bends the board strongly;
// absent before any other.
bool is_believable(double by_surface, double by_differences, std::optional<double> error) {
  constexpr double kUsual = 1.25;  // up to this, whatever differences say
  // How many times smaller the ratio by differences may be by chance than that by the surface. A
  // board of 9x6 has about six independent differences: one board in two hundred gets a third.
  constexpr double kByChance = 3;
  // Where it may be the lens, that is the likelier reason from 1.7 on.
  constexpr double kBeforeAWideLens = 1.7;
  constexpr double kOfLens = 0.015;  // px
  const bool may_be_lens = error && *error < kOfLens;
  return by_surface <
         std::max(kUsual, (may_be_lens ? kBeforeAWideLens : kByChance) * by_differences);
}

}  // namespace

float scatter(const Lattice& lattice, ImageSize image) {
  constexpr int kFewestNodes = 15;
  constexpr double kMost = 10;     // no larger ratio is reported
  constexpr double kLikely = 1.1;  // up to this, a wide lens need not be looked for
  // Noise is the least that an error can be: what differences tell below that is chance.
  constexpr double kLeastByDifferences = 0.9;
  if (lattice.count() < kFewestNodes) return 1;
  const Flattened flat(lattice, {});
  double ratio = ratio_by(lattice, flat);
  auto beside = ratio_beside_surface(lattice, flat);
  const bool wide = flat.is_strongly_bent();
  if (wide && beside.value_or(ratio) > kLikely) {
    // What a wide lens does to the board is not error, and may be more than the surface follows.
    const Flattened straight(lattice, lens_of(lattice, image));
    ratio = std::min(ratio, ratio_by(lattice, straight));
    if (beside) beside = std::min(*beside, *ratio_beside_surface(lattice, straight));
  }
  const auto error = wide && beside ? std::optional(*beside * mean_sigma(lattice)) : std::nullopt;
  const bool believed = beside && is_believable(*beside, ratio, error);
  ratio = believed ? *beside : std::max(ratio, kLeastByDifferences);
  return static_cast<float>(std::isfinite(ratio) ? std::min(ratio, kMost) : 1);
}

}  // namespace calvin::detect
