// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Peaks of darkness, the rings around them, and the nearest others along their lines.

#include "calvin/detect/grids/crossing_points.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>

#include <Eigen/Geometry>

#include "calvin/detect/checkerboard/corners/grey_at.hpp"

namespace calvin::detect {

namespace {

constexpr int kRing = 6;         // px, the radius
constexpr std::size_t kAt = 32;  // places on the ring

// Sums over 3 x 3 pixels, darker ones larger; 0 along the border.
class Darkness {
 public:
  Darkness(const ImageView& image, bool light)
      : width_(image.width),
        sums_(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height), 0) {
    for (int y = 1; y + 1 < image.height; ++y) {
      for (int x = 1; x + 1 < image.width; ++x) {
        int sum = 0;
        for (int dy = -1; dy <= 1; ++dy) {
          const std::uint8_t* row = image.data + (y + dy) * image.stride + x;
          sum += row[-1] + row[0] + row[1];
        }
        sums_[index(x, y)] = static_cast<std::uint16_t>(light ? sum : 9 * 255 - sum);
      }
    }
  }

  [[nodiscard]] int at(int x, int y) const { return sums_[index(x, y)]; }
  // Whether nothing within two pixels is darker; of equal ones the first.
  [[nodiscard]] bool is_peak(int x, int y) const {
    const int own = at(x, y);
    for (int dy = -2; dy <= 2; ++dy) {
      for (int dx = -2; dx <= 2; ++dx) {
        const int other = at(x + dx, y + dy);
        const bool earlier = dy < 0 || (dy == 0 && dx < 0);
        if (other > own || (other == own && earlier)) return false;
      }
    }
    return true;
  }

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x);
  }
  int width_;
  std::vector<std::uint16_t> sums_;
};

Eigen::Vector2d on_ring(std::size_t i) {
  const double angle = 2 * std::numbers::pi * static_cast<double>(i) / kAt;
  return {std::cos(angle), std::sin(angle)};
}

// The directions of the dark arcs of a ring, in their order; empty where one is too long for a
// line.
std::vector<Eigen::Vector2d> dark_arcs(const std::array<float, kAt>& dark, float half) {
  constexpr int kLongest = 9;  // places
  std::vector<Eigen::Vector2d> arcs;
  for (std::size_t i = 0; i < kAt; ++i) {
    if (dark[i] <= half || dark[(i + kAt - 1) % kAt] > half) continue;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    int length = 0;
    for (std::size_t k = i; dark[k % kAt] > half && length <= kLongest; ++k, ++length) {
      sum += static_cast<double>(dark[k % kAt] - half) * on_ring(k % kAt);
    }
    if (length > kLongest) return {};
    arcs.push_back(sum.normalized());
  }
  return arcs;
}

std::optional<CrossingPoint> crossing_at(const ImageView& image, int x, int y, bool light,
                                         float own) {
  constexpr float kContrast = 15;      // grey levels
  constexpr double kStraight = -0.9;   // cosine of the angle between opposite arcs
  constexpr double kLeastAngle = 0.5;  // sine of that between the lines
  constexpr std::size_t kNoise = 3;    // places of the ring that may be brighter than all others
  std::array<float, kAt> dark{};
  for (std::size_t i = 0; i < kAt; ++i) {
    const Eigen::Vector2d at = Eigen::Vector2d(x, y) + kRing * on_ring(i);
    const float grey =
        grey_at(image, static_cast<float>(at.x()), static_cast<float>(at.y())).value_or(0);
    dark[i] = light ? grey : 255 - grey;
  }
  std::array<float, kAt> sorted = dark;
  std::ranges::nth_element(sorted, sorted.begin() + kNoise);
  const float between = sorted[kNoise];
  if (own - between < kContrast) return std::nullopt;
  const auto arcs = dark_arcs(dark, (own + between) / 2);
  if (arcs.size() != 4 || arcs[0].dot(arcs[2]) > kStraight || arcs[1].dot(arcs[3]) > kStraight) {
    return std::nullopt;
  }
  CrossingPoint point;
  point.x = x;
  point.y = y;
  point.along = (arcs[0] - arcs[2]).normalized();
  point.down = (arcs[1] - arcs[3]).normalized();
  point.inside = light ? own : 255 - own;
  point.outside = light ? between : 255 - between;
  const double sine = point.along.x() * point.down.y() - point.along.y() * point.down.x();
  if (std::abs(sine) < kLeastAngle) return std::nullopt;
  return point;
}

// The way to the next crossing along a line, on the side where it is nearer.
std::optional<Eigen::Vector2d> way_to_next(const std::vector<CrossingPoint>& crossings,
                                           const CrossingPoint& from, const Eigen::Vector2d& line) {
  constexpr double kAside = 0.3;  // sine of the angle to the line
  std::optional<Eigen::Vector2d> way;
  double least = std::numeric_limits<double>::infinity();
  for (const CrossingPoint& to : crossings) {
    const Eigen::Vector2d d(to.x - from.x, to.y - from.y);
    const double square = d.squaredNorm();
    if (square >= least || square < kRing * kRing) continue;
    const double aside = line.x() * d.y() - line.y() * d.x();
    if (aside * aside > kAside * kAside * square) continue;
    least = square;
    way = d;
  }
  return way;
}

}  // namespace

std::vector<CrossingPoint> find_crossings(const ImageView& image, bool light, std::size_t most) {
  constexpr int kMargin = kRing + 1;
  struct Peak {
    int x, y, dark;
  };
  std::vector<Peak> peaks;
  const Darkness darkness(image, light);
  for (int y = kMargin; y < image.height - kMargin; ++y) {
    for (int x = kMargin; x < image.width - kMargin; ++x) {
      if (darkness.is_peak(x, y)) peaks.push_back({x, y, darkness.at(x, y)});
    }
  }
  std::ranges::stable_sort(peaks, std::ranges::greater{}, &Peak::dark);
  std::vector<CrossingPoint> found;
  for (const Peak& p : peaks) {
    if (found.size() == most) break;
    const float own = static_cast<float>(p.dark) / 9;
    if (const auto point = crossing_at(image, p.x, p.y, light, own)) found.push_back(*point);
  }
  return found;
}

std::vector<Ellipse> circles_about(const std::vector<CrossingPoint>& crossings) {
  constexpr double kOfStep = 1.0 / 4;  // the radius
  std::vector<Ellipse> circles;
  for (const CrossingPoint& c : crossings) {
    const auto along = way_to_next(crossings, c, c.along);
    const auto down = way_to_next(crossings, c, c.down);
    if (!along || !down) continue;
    Eigen::Matrix2d steps;
    steps << *along, *down;
    const Eigen::Matrix2d square = kOfStep * kOfStep * steps * steps.transpose();
    circles.push_back({c.x, c.y, square(0, 0), square(0, 1), square(1, 1), c.inside, c.outside});
  }
  return circles;
}

}  // namespace calvin::detect
