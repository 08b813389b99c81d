// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Follows the edges of regions between pixels, and lays four lines through each.

#include "calvin/detect/tags/quads.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>

namespace calvin::detect {

namespace {

constexpr double kLeastSide = 6;      // px, of a quad
constexpr std::uint8_t kSeen = 0x10;  // of a pixel: the edge at its left was followed

// The four ways along the sides of pixels: up, right, down, left.
constexpr int kWayX[4] = {0, 1, 0, -1};
constexpr int kWayY[4] = {-1, 0, 1, 0};
// The pixels ahead of a corner of pixels, at the right and at the left of the way, from the pixel
// below and to the right of that corner.
constexpr int kRightX[4] = {0, 0, -1, -1};
constexpr int kRightY[4] = {-1, 0, 0, -1};
constexpr int kLeftX[4] = {-1, 0, 0, -1};
constexpr int kLeftY[4] = {-1, -1, 0, 0};

// A line through points: its normal and the distance of the origin.
struct Line {
  Point normal;
  double offset = 0;  // px
  double rms = 0;     // px
};

// The line from which the points are least far away, in the mean of their squares. Of the points
// from one to another one before it starts anew those at the ends are left out.
std::optional<Line> line_through(std::span<const Point> edge, std::size_t from, std::size_t to) {
  constexpr double kEnds = 0.1;  // of the points
  const std::size_t count = (to + edge.size() - from) % edge.size();
  const auto skipped = static_cast<std::size_t>(std::max(1.0, kEnds * static_cast<double>(count)));
  if (count < 2 * skipped + 3) return std::nullopt;
  const auto used = static_cast<double>(count - 2 * skipped);
  Point sum = Point::Zero();
  for (std::size_t k = skipped; k < count - skipped; ++k) sum += edge[(from + k) % edge.size()];
  const Point mean = sum / used;
  Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
  for (std::size_t k = skipped; k < count - skipped; ++k) {
    const Point d = edge[(from + k) % edge.size()] - mean;
    squares += d * d.transpose();
  }
  const double angle = 0.5 * std::atan2(2 * squares(0, 1), squares(0, 0) - squares(1, 1));
  Line line;
  line.normal = {-std::sin(angle), std::cos(angle)};
  line.offset = line.normal.dot(mean);
  line.rms = std::sqrt(std::max(line.normal.dot(squares * line.normal), 0.0) / used);
  return line;
}

std::optional<Point> crossing(const Line& a, const Line& b) {
  const double turn = cross(a.normal, b.normal);
  constexpr double kParallel = 0.05;
  if (std::abs(turn) < kParallel) return std::nullopt;
  return Point((a.offset * b.normal.y() - b.offset * a.normal.y()) / turn,
               (b.offset * a.normal.x() - a.offset * b.normal.x()) / turn);
}

// The place of the point of the edge for which `value` is largest.
template <typename Value>
std::size_t farthest(std::span<const Point> edge, Value value) {
  std::size_t best = 0;
  double most = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < edge.size(); ++i) {
    const double v = value(edge[i]);
    if (!(v > most)) continue;
    most = v;
    best = i;
  }
  return best;
}

// The places on an edge that is about a quad's where its corners are, in the order of the edge.
std::optional<std::array<std::size_t, 4>> corners_on(std::span<const Point> edge,
                                                     const Point& middle) {
  constexpr double kLeast = 0.05;  // of the distance of the first two corners
  const auto from = [](const Point& p) { return [p](const Point& q) { return (q - p).norm(); }; };
  const std::size_t a = farthest(edge, from(middle));
  const std::size_t b = farthest(edge, from(edge[a]));
  // Beside the line between these two are the others: one at either side, or both at one.
  const Point along = edge[b] - edge[a];
  const double length = along.norm();
  if (!(length > kLeastSide)) return std::nullopt;
  const auto beside = [&](const Point& p) { return cross(along, p - edge[a]) / length; };
  const std::size_t right = farthest(edge, beside);
  const std::size_t left = farthest(edge, [&](const Point& p) { return -beside(p); });
  std::array<std::size_t, 4> corners = {a, right, b, left};
  if (std::min(beside(edge[right]), -beside(edge[left])) < kLeast * length) {
    const double side = beside(edge[right]) > -beside(edge[left]) ? 1 : -1;
    const std::size_t third = side > 0 ? right : left;
    // How far a point is outside of the triangle of three corners.
    const auto outside = [&](const Point& p) {
      const Point to_a = edge[a] - edge[third];
      const Point to_b = edge[b] - edge[third];
      return std::max(-side * cross(to_a, p - edge[third]) / to_a.norm(),
                      side * cross(to_b, p - edge[third]) / to_b.norm());
    };
    corners = {a, third, b, farthest(edge, outside)};
  }
  std::ranges::sort(corners);
  for (std::size_t i = 0; i < 3; ++i) {
    if (corners[i] == corners[i + 1]) return std::nullopt;
  }
  return corners;
}

// Whether the points of the edge from a corner to the next lie along a line, but for a little bend.
bool is_straight(const Line& line, double side) {
  constexpr double kRough = 0.7;  // px
  constexpr double kBent = 0.02;  // of the side, RMS
  return side >= kLeastSide && line.rms < kRough + kBent * side;
}

std::optional<Quad> quad_of(std::span<const Point> edge) {
  Point middle = Point::Zero();
  for (const Point& p : edge) middle += p / static_cast<double>(edge.size());
  const auto corners = corners_on(edge, middle);
  if (!corners) return std::nullopt;
  std::array<Line, 4> lines;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto line = line_through(edge, (*corners)[i], (*corners)[(i + 1) % 4]);
    if (!line) return std::nullopt;
    lines[i] = *line;
  }
  Quad quad;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto at = crossing(lines[(i + 3) % 4], lines[i]);
    if (!at) return std::nullopt;
    quad[i] = *at;
    // A corner that is cut off is none.
    constexpr double kCut = 0.15;  // of the sides
    const double size = (edge[(*corners)[(i + 1) % 4]] - edge[(*corners)[(i + 3) % 4]]).norm();
    if ((quad[i] - edge[(*corners)[i]]).norm() > 2 + kCut * size) return std::nullopt;
  }
  for (std::size_t i = 0; i < 4; ++i) {
    if (!is_straight(lines[i], (quad[(i + 1) % 4] - quad[i]).norm())) return std::nullopt;
  }
  if (!is_convex(quad)) return std::nullopt;
  return quad;
}

}  // namespace

bool QuadSearch::follow(int x, int y, Tone tone) {
  const auto has = [&](int u, int v) { return (tones_.at(u, v) & 3) == tone; };
  const auto most = static_cast<std::size_t>(2 * (tones_.width() + tones_.height()));
  edge_.clear();
  // Corners of pixels: the pixel (x, y) is below and to the right of its corner (x, y).
  int u = x;
  int v = y + 1;
  int way = 0;
  Point least(x, y);
  Point largest(x, y);
  double area = 0;  // twice
  std::size_t count = 0;
  do {
    const Point at = Point(2 * u + kWayX[way] - 1, 2 * v + kWayY[way] - 1) / 2;
    if (++count <= most) {
      if (!edge_.empty()) area += cross(edge_.back(), at);
      edge_.push_back(at);
      least = least.cwiseMin(at);
      largest = largest.cwiseMax(at);
    }
    u += kWayX[way];
    v += kWayY[way];
    if (way == 0) tones_.at(u, v) |= kSeen;
    if (!has(u + kRightX[way], v + kRightY[way])) {
      way = (way + 1) % 4;
    } else if (has(u + kLeftX[way], v + kLeftY[way])) {
      way = (way + 3) % 4;
    }
  } while (u != x || v != y + 1 || way != 0);
  if (count > most) return false;
  area += cross(edge_.back(), edge_.front());
  // Around a convex region an edge is as long as that of the rectangle around it; noise adds a
  // little. What goes around the other way is a hole.
  constexpr double kRough = 1.35;
  const Point size = largest - least;
  const double around = 2 * (size.x() + size.y());
  return area > kLeastSide * kLeastSide && std::min(size.x(), size.y()) >= kLeastSide &&
         static_cast<double>(count) < kRough * around + 8;
}

const std::vector<Quad>& QuadSearch::find(bool light) {
  const Tone tone = light ? kLightTone : kDarkTone;
  quads_.clear();
  const auto width = static_cast<std::size_t>(tones_.width());
  begins_.resize(width);
  for (int y = 0; y < tones_.height(); ++y) {
    const std::uint8_t* row = tones_.row(y);
    const auto is_begin = [row, tone](std::size_t x) {
      return static_cast<std::uint8_t>(row[x] == tone) &
             static_cast<std::uint8_t>((*(row + x - 1) & 3) != tone);
    };
    for (std::size_t x = 0; x < width; ++x) begins_[x] = is_begin(x) != 0 ? 1 : 0;
    const auto end = begins_.begin() + static_cast<std::ptrdiff_t>(width);
    for (auto at = std::find(begins_.begin(), end, 1); at != end; at = std::find(at + 1, end, 1)) {
      const auto x = static_cast<std::size_t>(at - begins_.begin());
      // Another edge may have come by meanwhile.
      if (is_begin(x) == 0 || !follow(static_cast<int>(x), y, tone)) continue;
      if (const auto quad = quad_of(edge_)) quads_.push_back(*quad);
    }
  }
  return quads_;
}

}  // namespace calvin::detect
