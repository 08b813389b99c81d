// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Lattices grow from one point to the next; where rows are missing a polynomial about the gap
// tells how both sides belong together.

#include "calvin/detect/grids/grid_lattice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "calvin/detect/circles/circle_pattern.hpp"
#include "calvin/detect/circles/lens_map.hpp"

namespace calvin::detect {

namespace {

struct Point {
  Cell cell;
  Ellipse ellipse;
};
using Part = std::vector<Point>;

// All lattices of the image, the largest first.
std::vector<Part> parts_of(std::span<const Ellipse> points, const std::stop_token& stop) {
  constexpr int kFewestOfPart = 9;
  std::vector<Part> parts;
  if (points.size() < kFewestGridPoints) return parts;
  DiscGraph graph;
  graph.begin(points);
  DiscLattice lattice(UnboundedGrid::kSide);
  while (!stop.stop_requested() && graph.next(kFewestOfPart, lattice)) {
    Part& part = parts.emplace_back();
    for (const Cell c : lattice.cells()) part.push_back({c, *lattice.at(c)});
  }
  std::ranges::stable_sort(parts, std::ranges::greater{}, &Part::size);
  return parts;
}

DiscLattice lattice_of(const Part& part) {
  DiscLattice lattice(UnboundedGrid::kSide);
  for (const Point& p : part) lattice.put(p.cell, p.ellipse);
  return lattice;
}

double square_distance(const Point& a, const Point& b) {
  return std::pow(a.ellipse.x - b.ellipse.x, 2) + std::pow(a.ellipse.y - b.ellipse.y, 2);
}

// The points of a part that are nearest to a point.
Part nearest_of(const Part& part, const Point& to, std::size_t count) {
  Part nearest = part;
  count = std::min(count, part.size());
  const auto end = nearest.begin() + static_cast<std::ptrdiff_t>(count);
  std::ranges::partial_sort(nearest, end, {},
                            [&](const Point& p) { return square_distance(p, to); });
  nearest.resize(count);
  return nearest;
}

// The point of a part that is nearest to another part.
Point nearest_to(const Part& other, const Part& part) {
  return std::ranges::min(part, {}, [&](const Point& p) {
    double least = std::numeric_limits<double>::infinity();
    for (const Point& q : other) least = std::min(least, square_distance(p, q));
    return least;
  });
}

// The place in the cells of a lattice of every place in the image around it.
Polynomial cells_by_place(const Part& part) {
  constexpr int kDegree = 3;
  std::vector<Pixel> at;
  Eigen::MatrixX2d cells(static_cast<Eigen::Index>(part.size()), 2);
  for (std::size_t i = 0; i < part.size(); ++i) {
    at.push_back({part[i].ellipse.x, part[i].ellipse.y});
    cells.row(static_cast<Eigen::Index>(i)) << part[i].cell.col, part[i].cell.row;
  }
  return Polynomial(at, cells, kDegree);
}

// How the cells of one part are those of a larger one, by what the points of that nearest to it let
// expect. Absent where they are not.
std::optional<CellMap> joined(const Part& larger, const Part& smaller) {
  constexpr double kOff = 0.25;         // RMS
  constexpr std::size_t kAround = 100;  // points that the others are expected by
  constexpr std::size_t kTested = 9;
  const Point first = nearest_to(larger, smaller);
  const Part part = nearest_of(smaller, first, kTested);
  const Polynomial expected = cells_by_place(nearest_of(larger, first, kAround));
  const auto count = static_cast<double>(part.size());
  for (int turns = 0; turns < 4; ++turns) {
    CellMap map{turns, {}};
    Eigen::Vector2d shift = Eigen::Vector2d::Zero();
    const auto off = [&](const Point& p) {
      const Cell own = map(p.cell);
      return Eigen::Vector2d(expected.at({p.ellipse.x, p.ellipse.y}) -
                             Eigen::Vector2d(own.col, own.row));
    };
    for (const Point& p : part) shift += off(p) / count;
    map.shift = {static_cast<int>(std::lround(shift.x())),
                 static_cast<int>(std::lround(shift.y()))};
    double square = 0;
    for (const Point& p : part) square += off(p).squaredNorm() / count;
    if (square < kOff * kOff) return map;
  }
  return std::nullopt;
}

// Adds what belongs to the first part to it.
Part join(std::vector<Part> parts) {
  Part all = std::move(parts.front());
  DiscLattice lattice = lattice_of(all);
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const auto map = joined(all, parts[i]);
    if (!map) continue;
    for (const Point& p : parts[i]) {
      const Cell cell = (*map)(p.cell);
      if (!lattice.in_reach(cell) || lattice.at(cell) != nullptr) continue;
      lattice.put(cell, p.ellipse);
      all.push_back({cell, p.ellipse});
    }
  }
  return all;
}

// The quarter turns after which rows run along the x axis of the image.
int turns_to_upright(const Part& part) {
  const DiscLattice lattice = lattice_of(part);
  Eigen::Vector2d along = Eigen::Vector2d::Zero();
  for (const Point& p : part) {
    if (const Ellipse* next = lattice.at(p.cell + Cell{1, 0})) {
      along += Eigen::Vector2d(next->x - p.ellipse.x, next->y - p.ellipse.y);
    }
  }
  const double quarters = std::atan2(along.y(), along.x()) / (std::numbers::pi / 2);
  return (static_cast<int>(std::lround(quarters)) + 4) % 4;
}

}  // namespace

std::optional<DiscLattice> grid_lattice(std::span<const Ellipse> points,
                                        const std::stop_token& stop) {
  std::vector<Part> parts = parts_of(points, stop);
  if (stop.stop_requested() || parts.empty() || parts.front().size() < kFewestGridPoints) {
    return std::nullopt;
  }
  const Part all = join(std::move(parts));
  const CellMap upright{turns_to_upright(all), {}};
  DiscLattice turned(UnboundedGrid::kSide);
  for (const Point& p : all) turned.put(upright(p.cell), p.ellipse);
  const CellRange range = turned.extent();
  const Cell middle = {(range.first.col + range.last.col) / 2,
                       (range.first.row + range.last.row) / 2};
  DiscLattice lattice(kGridReach);
  for (const Cell c : turned.cells()) {
    if (lattice.in_reach(c - middle)) lattice.put(c - middle, *turned.at(c));
  }
  return lattice;
}

}  // namespace calvin::detect
