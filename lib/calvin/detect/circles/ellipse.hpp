// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The ellipse as which a camera sees a disc.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include <Eigen/Core>

namespace calvin::detect {

struct Ellipse {
  double x = 0;  // px, the centre
  double y = 0;
  // px^2: the rim are the points p from the centre with p^T [xx xy; xy yy]^-1 p = 1.
  double xx = 1;
  double xy = 0;
  double yy = 1;
  float inside = 0;  // grey levels
  float outside = 0;

  [[nodiscard]] double determinant() const { return xx * yy - xy * xy; }
  // Of the circle of the same area, px.
  [[nodiscard]] double radius() const { return std::sqrt(std::sqrt(determinant())); }
  // The square of the distance of a point from the centre, in radii along its direction.
  [[nodiscard]] double square_distance(double dx, double dy) const {
    return (yy * dx * dx - 2 * xy * dx * dy + xx * dy * dy) / determinant();
  }
  [[nodiscard]] double square_distance_of(const Ellipse& other) const {
    return square_distance(other.x - x, other.y - y);
  }
  // Half axes squared, the longer one first.
  [[nodiscard]] double longest_square() const {
    return 0.5 * (xx + yy) + std::hypot(0.5 * (xx - yy), xy);
  }
  [[nodiscard]] double shortest_square() const { return determinant() / longest_square(); }

  [[nodiscard]] bool is_light() const { return inside > outside; }
};

// Points of the unit circle, from (1, 0) on, computed once.
template <std::size_t kPoints>
[[nodiscard]] const std::array<Eigen::Vector2d, kPoints>& unit_circle() {
  static const auto kCircle = [] {
    std::array<Eigen::Vector2d, kPoints> circle;
    for (std::size_t k = 0; k < kPoints; ++k) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(k) / kPoints;
      circle[k] = {std::cos(angle), std::sin(angle)};
    }
    return circle;
  }();
  return kCircle;
}

}  // namespace calvin::detect
