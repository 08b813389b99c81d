// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#include "calvin/detect/scatter.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>

namespace calvin::detect {

namespace {

using Homography = Eigen::Matrix<double, 8, 1>;  // row by row, the last number is 1

struct Place {
  double x = 0;
  double y = 0;
};

Place image_of(const Homography& h, Place p) {
  const double w = h[6] * p.x + h[7] * p.y + 1;
  return {(h[0] * p.x + h[1] * p.y + h[2]) / w, (h[3] * p.x + h[4] * p.y + h[5]) / w};
}

// A grid and where it is in the image, both from the middle of the lattice so that numbers are
// small; px.
class Flattened {
 public:
  explicit Flattened(const Lattice& lattice) : lattice_(lattice) {
    lattice.for_each([&](Cell c, const Node& node) {
      const double n = ++count_;
      middle_.x += (c.col - middle_.x) / n;
      middle_.y += (c.row - middle_.y) / n;
      origin_.x += (static_cast<double>(node.x) - origin_.x) / n;
      origin_.y += (static_cast<double>(node.y) - origin_.y) / n;
    });
    Eigen::Matrix<double, 8, 8> normal = Eigen::Matrix<double, 8, 8>::Identity() * 1e-9;
    Homography right = Homography::Zero();
    lattice.for_each([&](Cell c, const Node& node) {
      const Place p = from_middle(c);
      const Place q = seen(node);
      Homography u;
      Homography v;
      u << p.x, p.y, 1, 0, 0, 0, -q.x * p.x, -q.x * p.y;
      v << 0, 0, 0, p.x, p.y, 1, -q.y * p.x, -q.y * p.y;
      normal += u * u.transpose() + v * v.transpose();
      right += q.x * u + q.y * v;
    });
    homography_ = normal.ldlt().solve(right);
  }

  // How far a node is from where the homography has it.
  [[nodiscard]] Place off(Cell c) const {
    const Place at = seen(lattice_.at(c));
    const Place expected = image_of(homography_, from_middle(c));
    return {at.x - expected.x, at.y - expected.y};
  }

 private:
  [[nodiscard]] Place from_middle(Cell c) const { return {c.col - middle_.x, c.row - middle_.y}; }
  [[nodiscard]] Place seen(const Node& node) const {
    return {static_cast<double>(node.x) - origin_.x, static_cast<double>(node.y) - origin_.y};
  }

  const Lattice& lattice_;
  int count_ = 0;
  Place middle_;
  Place origin_;
  Homography homography_;
};

constexpr std::array<double, 4> kThird = {1, -3, 3, -1};
constexpr std::array<double, 5> kFourth = {1, -4, 6, -4, 1};
constexpr std::array<double, 6> kFifth = {1, -5, 10, -10, 5, -1};

// The squares of differences beside what the corners' sigmas have them be.
struct Squares {
  double sum = 0;
  double count = 0;

  // Of all places where the lattice has the corners of a difference, in both directions.
  template <std::size_t kLong, std::size_t kShort>
  Squares(const Lattice& lattice, const Flattened& flat, const std::array<double, kLong>& along,
          const std::array<double, kShort>& aside) {
    lattice.for_each([&](Cell c, const Node& /*node*/) {
      add(lattice, flat, c, along, aside);
      add(lattice, flat, c, aside, along);
    });
  }

 private:
  // `cols`, `rows`: the weights of the difference that begins in a cell.
  template <std::size_t kCols, std::size_t kRows>
  void add(const Lattice& lattice, const Flattened& flat, Cell first,
           const std::array<double, kCols>& cols, const std::array<double, kRows>& rows) {
    Place difference;
    double variance = 0;
    for (std::size_t i = 0; i < kCols; ++i) {
      for (std::size_t k = 0; k < kRows; ++k) {
        const Cell c = first + Cell{static_cast<int>(i), static_cast<int>(k)};
        if (!lattice.has(c)) return;
        const double weight = cols[i] * rows[k];
        const Place off = flat.off(c);
        const auto sigma = static_cast<double>(lattice.at(c).sigma);
        difference.x += weight * off.x;
        difference.y += weight * off.y;
        variance += weight * weight * sigma * sigma;
      }
    }
    sum += 0.5 * (difference.x * difference.x + difference.y * difference.y) / variance;
    ++count;
  }
};

}  // namespace

float scatter(const Lattice& lattice) {
  constexpr double kPresumed = 1;  // difference of a scatter of 1
  constexpr int kFewestNodes = 15;
  constexpr double kMost = 10;
  constexpr double kEnough = 6;  // differences over six corners by five
  if (lattice.count() < kFewestNodes) return 1;
  const Flattened flat(lattice);
  Squares squares(lattice, flat, kFifth, kFourth);
  if (squares.count < kEnough) squares = Squares(lattice, flat, kFourth, kThird);
  const double ratio = std::sqrt((squares.sum + kPresumed) / (squares.count + kPresumed));
  return static_cast<float>(std::isfinite(ratio) ? std::min(ratio, kMost) : 1);
}

}  // namespace calvin::detect
