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
#include "calvin/detect/maps/lens_map.hpp"

namespace calvin::detect {

namespace {

struct Point {
  Cell cell;
  Ellipse ellipse;
};
using Part = std::vector<Point>;

Pixel pixel_of(const Cell& cell) {
  return {static_cast<double>(cell.col), static_cast<double>(cell.row)};
}

std::size_t share_of(std::size_t count, double share) {
  return static_cast<std::size_t>(share * static_cast<double>(count));
}

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
  constexpr double kOff = 0.25;             // RMS
  constexpr std::size_t kNeighbours = 100;  // points that the others are expected by
  constexpr std::size_t kTested = 9;
  const Point first = nearest_to(larger, smaller);
  const Part part = nearest_of(smaller, first, kTested);
  const Polynomial expected = cells_by_place(nearest_of(larger, first, kNeighbours));
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

// How rows and columns lie to each other on the grid by the shapes of the discs, which are circles
// there: the products of the steps along them, over the radius squared. By the larger half of the
// discs, whose shapes are told best.
Eigen::Matrix2d steps_by_shape(const Part& part) {
  const DiscLattice lattice = lattice_of(part);
  Part larger = part;
  const auto half = larger.begin() + static_cast<std::ptrdiff_t>(larger.size() / 2);
  std::ranges::nth_element(larger, half, std::ranges::greater{},
                           [](const Point& p) { return p.ellipse.determinant(); });
  larger.erase(half, larger.end());
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  for (const Point& p : larger) {
    const Ellipse& e = p.ellipse;
    const Ellipse* right = lattice.at(p.cell + Cell{1, 0});
    const Ellipse* below = lattice.at(p.cell + Cell{0, 1});
    if (right == nullptr || below == nullptr) continue;
    Eigen::Matrix2d steps;
    steps << right->x - e.x, below->x - e.x, right->y - e.y, below->y - e.y;
    Eigen::Matrix2d shape;
    shape << e.yy, -e.xy, -e.xy, e.xx;
    sum += steps.transpose() * shape * steps / e.determinant();
  }
  return sum;
}

// Where a board is seen at a flat angle the next disc may be that of the next row and column. Cells
// of rows and columns that are at right angles, by the reduction of Lagrange and Gauss.
Part with_square_cells(Part part) {
  constexpr int kMost = 4;  // steps of the reduction
  for (int i = 0; i < kMost; ++i) {
    const Eigen::Matrix2d g = steps_by_shape(part);
    if (!(g(0, 0) > 0) || !(g(1, 1) > 0)) return part;
    const bool is_row_shorter = g(0, 0) <= g(1, 1);
    const double off = g(0, 1) / (is_row_shorter ? g(0, 0) : g(1, 1));
    const int steps = static_cast<int>(std::lround(off));
    if (steps == 0) return part;
    // The longer step is shorter by so many of the other one.
    for (Point& p : part) {
      (is_row_shorter ? p.cell.col : p.cell.row) +=
          steps * (is_row_shorter ? p.cell.row : p.cell.col);
    }
  }
  return part;
}

// Whether a point is nearer to the image of its cell than to that of any other.
bool is_in_its_cell(const LensMap& map, const Point& point) {
  constexpr double kOff = 0.3;  // of the way to the next cell
  const auto image_of = [&](const Cell& cell) { return map.image_of(pixel_of(cell)); };
  const Pixel own = image_of(point.cell);
  const auto distance = [&own](double u, double v) { return std::hypot(u - own.u, v - own.v); };
  const Pixel right = image_of(point.cell + Cell{1, 0});
  const Pixel below = image_of(point.cell + Cell{0, 1});
  const double step = std::min(distance(right.u, right.v), distance(below.u, below.v));
  return distance(point.ellipse.x, point.ellipse.y) < kOff * step;
}

// Where discs are small and many one may be missed, and a row goes on as the next one: the grid is
// followed from the largest discs on, which are the nearest ones, and points that a lens which has
// seen those does not let be expected in their cells are left out.
Part without_misnumbered(Part part, const Pixel& middle) {
  constexpr double kShares[] = {0.5, 0.7, 0.85, 1};
  constexpr std::size_t kMany = 200;
  if (part.size() < kMany) return part;
  std::ranges::stable_sort(part, std::ranges::greater{},
                           [](const Point& p) { return p.ellipse.determinant(); });
  std::vector<bool> is_kept(part.size(), true);
  for (std::size_t i = 0; i + 1 < std::size(kShares); ++i) {
    std::vector<Pixel> cells;
    std::vector<Pixel> seen;
    for (std::size_t k = 0; k < share_of(part.size(), kShares[i]); ++k) {
      if (!is_kept[k]) continue;
      cells.push_back(pixel_of(part[k].cell));
      seen.push_back({part[k].ellipse.x, part[k].ellipse.y});
    }
    const auto map = LensMap::fit(cells, seen, middle);
    if (!map) return part;
    for (std::size_t k = 0; k < share_of(part.size(), kShares[i + 1]); ++k) {
      is_kept[k] = is_in_its_cell(*map, part[k]);
    }
  }
  Part kept;
  for (std::size_t k = 0; k < part.size(); ++k) {
    if (is_kept[k]) kept.push_back(part[k]);
  }
  return kept;
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

std::optional<DiscLattice> grid_lattice(std::span<const Ellipse> points, const Pixel& middle,
                                        const std::stop_token& stop) {
  std::vector<Part> parts = parts_of(points, stop);
  if (stop.stop_requested() || parts.empty() || parts.front().size() < kFewestGridPoints) {
    return std::nullopt;
  }
  const Part all = without_misnumbered(with_square_cells(join(std::move(parts))), middle);
  if (all.size() < kFewestGridPoints) return std::nullopt;
  const CellMap upright{turns_to_upright(all), {}};
  DiscLattice turned(UnboundedGrid::kSide);
  for (const Point& p : all) turned.put(upright(p.cell), p.ellipse);
  const CellRange range = turned.extent();
  const Cell centre = {(range.first.col + range.last.col) / 2,
                       (range.first.row + range.last.row) / 2};
  DiscLattice lattice(kGridReach);
  for (const Cell c : turned.cells()) {
    if (lattice.in_reach(c - centre)) lattice.put(c - centre, *turned.at(c));
  }
  return lattice;
}

}  // namespace calvin::detect
