// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Follows the edges of regions between pixels, and lays four lines through each.

#include "calvin/detect/tags/quads.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
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

Point point_of(const EdgePoint& p) { return Point(p.x, p.y) / 2; }

// The sums of points and of their products, from a first one on, in half px. They are whole
// numbers, so that they may be added up in any order.
struct PointSums {
  EdgePoint from;
  std::int64_t x = 0, y = 0, xx = 0, xy = 0, yy = 0;

  void add(std::span<const EdgePoint> points) {
    for (const EdgePoint& p : points) {
      const std::int64_t dx = p.x - from.x;
      const std::int64_t dy = p.y - from.y;
      x += dx;
      y += dy;
      xx += dx * dx;
      xy += dx * dy;
      yy += dy * dy;
    }
  }
};

// The line from which the points are least far away, in the mean of their squares. Of the points
// from one to another one before it starts anew those at the ends are left out.
std::optional<Line> line_through(std::span<const EdgePoint> edge, std::size_t from,
                                 std::size_t to) {
  constexpr double kEnds = 0.1;  // of the points
  const std::size_t count = (to > from ? to : to + edge.size()) - from;
  const auto skipped = static_cast<std::size_t>(std::max(1.0, kEnds * static_cast<double>(count)));
  if (count < 2 * skipped + 3) return std::nullopt;
  const std::size_t first = from + skipped;
  const std::size_t end = from + count - skipped;
  PointSums sums;
  sums.from = edge[first % edge.size()];
  if (first < edge.size()) {
    sums.add(edge.subspan(first, std::min(end, edge.size()) - first));
  }
  if (end > edge.size()) {
    const std::size_t begin = std::max(first, edge.size()) - edge.size();
    sums.add(edge.subspan(begin, end - edge.size() - begin));
  }
  const auto used = static_cast<double>(end - first);
  const Point mean = Point(static_cast<double>(sums.x), static_cast<double>(sums.y)) / used;
  // In px^2, about their mean.
  const double xx = (static_cast<double>(sums.xx) - used * mean.x() * mean.x()) / 4;
  const double xy = (static_cast<double>(sums.xy) - used * mean.x() * mean.y()) / 4;
  const double yy = (static_cast<double>(sums.yy) - used * mean.y() * mean.y()) / 4;
  const double angle = 0.5 * std::atan2(2 * xy, xx - yy);
  Line line;
  line.normal = {-std::sin(angle), std::cos(angle)};
  line.offset = line.normal.dot(mean / 2 + point_of(sums.from));
  const double squares = line.normal.x() * line.normal.x() * xx +
                         2 * line.normal.x() * line.normal.y() * xy +
                         line.normal.y() * line.normal.y() * yy;
  line.rms = std::sqrt(std::max(squares, 0.0) / used);
  return line;
}

std::optional<Point> crossing(const Line& a, const Line& b) {
  const double turn = cross(a.normal, b.normal);
  constexpr double kParallel = 0.05;
  if (std::abs(turn) < kParallel) return std::nullopt;
  return Point((a.offset * b.normal.y() - b.offset * a.normal.y()) / turn,
               (b.offset * a.normal.x() - a.offset * b.normal.x()) / turn);
}

// The place of the first point of the edge for which `value` is largest.
template <typename Value>
std::size_t farthest(std::span<const EdgePoint> edge, Value value) {
  std::size_t best = 0;
  auto most = value(edge[0]);
  for (std::size_t i = 1; i < edge.size(); ++i) {
    const auto v = value(edge[i]);
    if (!(v > most)) continue;
    most = v;
    best = i;
  }
  return best;
}

// From the place (x, y) / count, in half px.
std::size_t farthest_from(std::span<const EdgePoint> edge, std::int64_t x, std::int64_t y,
                          std::int64_t count) {
  return farthest(edge, [=](const EdgePoint& p) {
    // Whole numbers still, and too large for 64 bits in pictures of tens of thousands of pixels.
    const auto dx = static_cast<double>(count * p.x - x);
    const auto dy = static_cast<double>(count * p.y - y);
    return dx * dx + dy * dy;
  });
}

// The place of the point outside of the triangle of three corners that is farthest from it; `side`
// is where the third one lies, as seen along the way from the first one to the second one.
std::size_t farthest_outside(std::span<const EdgePoint> edge, std::size_t first, std::size_t second,
                             std::size_t third, double side) {
  const Point at = point_of(edge[third]);
  const Point to_first = (point_of(edge[first]) - at).normalized();
  const Point to_second = (point_of(edge[second]) - at).normalized();
  return farthest(edge, [&](const EdgePoint& q) {
    const Point d = point_of(q) - at;
    return std::max(-side * cross(to_first, d), side * cross(to_second, d));
  });
}

// The places on an edge that is about a quad's where its corners are, in the order of the edge.
std::optional<std::array<std::size_t, 4>> corners_on(std::span<const EdgePoint> edge) {
  constexpr double kLeast = 0.05;  // of the distance of the first two corners
  std::int64_t sum_x = 0;
  std::int64_t sum_y = 0;
  for (const EdgePoint& p : edge) {
    sum_x += p.x;
    sum_y += p.y;
  }
  const std::size_t a = farthest_from(edge, sum_x, sum_y, std::ssize(edge));
  const std::size_t b = farthest_from(edge, edge[a].x, edge[a].y, 1);
  // Beside the line between these two are the others: one at either side, or both at one.
  const EdgePoint from = edge[a];
  const std::int64_t x = edge[b].x - from.x;
  const std::int64_t y = edge[b].y - from.y;
  const double length = std::hypot(static_cast<double>(x), static_cast<double>(y)) / 2;
  if (!(length > kLeastSide)) return std::nullopt;
  const auto beside = [=](const EdgePoint& p) { return x * (p.y - from.y) - y * (p.x - from.x); };
  const std::size_t right = farthest(edge, beside);
  const std::size_t left = farthest(edge, [&](const EdgePoint& p) { return -beside(p); });
  const std::int64_t to_right = beside(edge[right]);
  const std::int64_t to_left = -beside(edge[left]);
  std::array<std::size_t, 4> corners = {a, right, b, left};
  // Four times as many quarters of a square px as px.
  if (static_cast<double>(std::min(to_right, to_left)) < 4 * kLeast * length * length) {
    const bool is_right = to_right > to_left;
    const std::size_t third = is_right ? right : left;
    corners = {a, third, b, farthest_outside(edge, a, b, third, is_right ? 1 : -1)};
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

std::optional<Quad> quad_of(std::span<const EdgePoint> edge) {
  const auto corners = corners_on(edge);
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
    const auto corner = [&](std::size_t k) { return point_of(edge[(*corners)[k % 4]]); };
    const double size = (corner(i + 1) - corner(i + 3)).norm();
    if ((quad[i] - corner(i)).norm() > 2 + kCut * size) return std::nullopt;
  }
  for (std::size_t i = 0; i < 4; ++i) {
    if (!is_straight(lines[i], (quad[(i + 1) % 4] - quad[i]).norm())) return std::nullopt;
  }
  if (!is_convex(quad)) return std::nullopt;
  return quad;
}

}  // namespace

namespace {

// A way along the sides of pixels: to the next corner, and to the pixels ahead of it.
struct Way {
  std::ptrdiff_t step;
  std::ptrdiff_t right;
  std::ptrdiff_t left;
  int x;
  int y;
  std::uint8_t mark;
};

std::array<Way, 4> ways_of(std::ptrdiff_t stride) {
  std::array<Way, 4> ways{};
  for (std::size_t k = 0; k < 4; ++k) {
    ways[k] = {kWayY[k] * stride + kWayX[k],
               kRightY[k] * stride + kRightX[k],
               kLeftY[k] * stride + kLeftX[k],
               kWayX[k],
               kWayY[k],
               k == 0 ? kSeen : std::uint8_t{0}};
  }
  return ways;
}

// Around a convex region an edge is as long as that of the rectangle around it; noise adds a
// little.
bool is_compact(std::span<const EdgePoint> edge) {
  constexpr double kRough = 1.35;
  EdgePoint least = edge.front();
  EdgePoint largest = least;
  for (const EdgePoint& p : edge) {
    least = {std::min(least.x, p.x), std::min(least.y, p.y)};
    largest = {std::max(largest.x, p.x), std::max(largest.y, p.y)};
  }
  const Point size = point_of({largest.x - least.x, largest.y - least.y});
  const double around = 2 * (size.x() + size.y());
  return std::min(size.x(), size.y()) >= kLeastSide &&
         static_cast<double>(edge.size()) < kRough * around + 8;
}

}  // namespace

bool QuadSearch::follow(int x, int y, Tone tone) {
  const auto most = static_cast<std::size_t>(2 * (tones_.width() + tones_.height()));
  points_.resize(std::max(points_.size(), most + 1));  // the last one is for all further ones
  const std::array<Way, 4> ways = ways_of(tones_.stride());
  // Corners of pixels, in half px: the pixel (x, y) is below and to the right of its corner (x, y).
  std::uint8_t* const begin = &tones_.at(x, y + 1);
  std::uint8_t* pixel = begin;
  int u = 2 * x - 1;
  int v = 2 * y + 1;
  unsigned way = 0;
  Way on = ways[way];
  std::int64_t area = 0;  // twice
  std::size_t count = 0;
  do {
    points_[std::min(count++, most)] = {u + on.x, v + on.y};
    area += static_cast<std::int64_t>(u) * on.y;
    u += 2 * on.x;
    v += 2 * on.y;
    pixel += on.step;
    *pixel |= on.mark;
    // Most edges go on straight ahead: the next pixels are asked for before these are known.
    if ((pixel[on.right] & 3) != tone) {
      way = (way + 1) & 3;
      on = ways[way];
    } else if ((pixel[on.left] & 3) == tone) {
      way = (way + 3) & 3;
      on = ways[way];
    }
  } while (pixel != begin || way != 0);
  if (count > most) return false;
  edge_ = std::span(points_).first(count);
  // What goes around the other way is a hole. The middles of the sides of pixels enclose half a
  // pixel less than their corners do.
  return static_cast<double>(area - 1) > kLeastSide * kLeastSide && is_compact(edge_);
}

namespace {

// The first place from `from` on that is not 0; the number of them where there is none.
std::size_t next_begin(std::span<const std::uint8_t> begins, std::size_t from) {
  std::uint64_t eight = 0;
  for (; from + sizeof eight <= begins.size(); from += sizeof eight) {
    std::memcpy(&eight, begins.data() + from, sizeof eight);
    if (eight != 0) break;
  }
  while (from < begins.size() && begins[from] == 0) ++from;
  return from;
}

}  // namespace

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
    // For the compiler to make vectors of it.
    std::uint8_t* begins = begins_.data();
    for (std::size_t x = 0; x < width; ++x) begins[x] = static_cast<std::uint8_t>(is_begin(x));
    for (std::size_t x = next_begin(begins_, 0); x < width; x = next_begin(begins_, x + 1)) {
      // Another edge may have come by meanwhile.
      if (is_begin(x) == 0 || !follow(static_cast<int>(x), y, tone)) continue;
      if (const auto quad = quad_of(edge_)) quads_.push_back(*quad);
    }
  }
  return quads_;
}

}  // namespace calvin::detect
