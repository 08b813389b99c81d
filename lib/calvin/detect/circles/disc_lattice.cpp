// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Lattices grow from discs with neighbours on four sides. A disc's own ellipse says how the board
// is foreshortened there: measured by it, neighbours are at right angles and equally far.

#include "calvin/detect/circles/disc_lattice.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "calvin/detect/maps/outliers.hpp"

namespace calvin::detect {

namespace {

// Whether two discs may be next to each other on a board: of about one size and contrast.
bool are_alike(const Ellipse& a, const Ellipse& b) {
  constexpr double kMostLarger = 1.7;
  constexpr float kMostContrast = 2.5F;
  const double ratio = a.radius() / b.radius();
  const float contrast = std::abs(a.outside - a.inside) / std::abs(b.outside - b.inside);
  return ratio < kMostLarger && ratio > 1 / kMostLarger && contrast < kMostContrast &&
         contrast > 1 / kMostContrast;
}

}  // namespace

DiscLattice::DiscLattice(int reach) : reach_(reach) {
  const auto side = static_cast<std::size_t>(2 * reach + 1);
  used_.resize(side * side);
  discs_.resize(side * side);
}

void DiscLattice::clear() {
  for (const Cell c : cells_) used_[index(c)] = false;
  cells_.clear();
}

void DiscLattice::put(Cell c, const Ellipse& disc) {
  if (!used_[index(c)]) cells_.push_back(c);
  used_[index(c)] = true;
  discs_[index(c)] = disc;
}

void DiscLattice::remove(Cell c) {
  used_[index(c)] = false;
  std::erase(cells_, c);
}

CellRange DiscLattice::extent() const {
  CellRange range;
  for (const Cell c : cells_) {
    if (range.cols() <= 0) range = {c, c};
    range.first = {std::min(range.first.col, c.col), std::min(range.first.row, c.row)};
    range.last = {std::max(range.last.col, c.col), std::max(range.last.row, c.row)};
  }
  return range;
}

std::optional<DiscLattice::Expectation> DiscLattice::expect(Cell c) const {
  Expectation all;
  all.disc = {0, 0, 0, 0, 0, 0, 0};
  double weights = 0;
  const auto add = [&](double x, double y, const Ellipse& like, double weight, double spacing) {
    all.disc.x += weight * x;
    all.disc.y += weight * y;
    all.disc.xx += weight * like.xx;
    all.disc.xy += weight * like.xy;
    all.disc.yy += weight * like.yy;
    all.disc.inside += static_cast<float>(weight) * like.inside;
    all.disc.outside += static_cast<float>(weight) * like.outside;
    all.spacing += weight * spacing;
    weights += weight;
  };
  for (const Cell step : kAround) {
    const Ellipse* near = at(c + step);
    const Ellipse* opposite = at(c - step);
    if (near == nullptr) continue;
    if (opposite != nullptr) {  // seen from both sides, so each counts half
      add((near->x + opposite->x) / 2, (near->y + opposite->y) / 2, *near, 2,
          std::hypot(near->x - opposite->x, near->y - opposite->y) / 2);
      continue;
    }
    const Ellipse* second = at(c + 2 * step);
    const Ellipse* third = at(c + 3 * step);
    if (second == nullptr) continue;
    const double spacing = std::hypot(near->x - second->x, near->y - second->y);
    if (third == nullptr) {
      add(2 * near->x - second->x, 2 * near->y - second->y, *near, 0.3, spacing);
    } else {
      add(3 * near->x - 3 * second->x + third->x, 3 * near->y - 3 * second->y + third->y, *near,
          0.5, spacing);
    }
  }
  if (weights == 0) return std::nullopt;
  Ellipse& e = all.disc;
  for (double* sum : {&e.x, &e.y, &e.xx, &e.xy, &e.yy, &all.spacing}) *sum /= weights;
  e.inside /= static_cast<float>(weights);
  e.outside /= static_cast<float>(weights);
  return all;
}

namespace {

// Whether a disc is far from where those around it let it be expected.
bool has_suspects(const DiscLattice& lattice) {
  constexpr double kOff = 0.12;  // of the spacing
  return std::ranges::any_of(lattice.cells(), [&](Cell c) {
    const auto expected = lattice.expect(c);
    const Ellipse& disc = *lattice.at(c);
    return expected && std::hypot(disc.x - expected->disc.x, disc.y - expected->disc.y) >
                           kOff * expected->spacing;
  });
}

}  // namespace

std::vector<Cell> outliers_of(const DiscLattice& lattice, const Pixel& middle) {
  constexpr double kOff = 0.3;  // of the spacing
  if (!has_suspects(lattice)) return {};
  std::vector<Pixel> plane;
  std::vector<Pixel> image;
  for (const Cell c : lattice.cells()) {
    plane.push_back({static_cast<double>(c.col), static_cast<double>(c.row)});
    image.push_back({lattice.at(c)->x, lattice.at(c)->y});
  }
  std::vector<Cell> out;
  for (const std::size_t i : grid_outliers(plane, image, middle, kOff)) {
    out.push_back(lattice.cells()[i]);
  }
  return out;
}

// ---- DiscGraph ----------------------------------------------------------------------------------

template <typename F>
void DiscGraph::for_each_near(double x, double y, double within, F f) const {
  const auto range = [&](double at, int count) {
    const auto clamped = [&](double v) {
      return static_cast<int>(std::clamp(std::floor(v / bucket_), 0.0, count - 1.0));
    };
    return std::pair(clamped(at - within), clamped(at + within));
  };
  const auto [left, right] = range(x, bucket_cols_);
  const auto [top, bottom] = range(y, bucket_rows_);
  for (int row = top; row <= bottom; ++row) {
    const auto start = static_cast<std::size_t>(row * bucket_cols_ + left);
    const auto end = static_cast<std::size_t>(row * bucket_cols_ + right + 1);
    for (std::size_t i = first_[start]; i < first_[end]; ++i) f(order_[i]);
  }
}

void DiscGraph::begin(std::span<const Ellipse> discs) {
  constexpr double kBucket = 6;  // radii, in the mean
  discs_ = discs;
  bucket_ = 0;
  for (const Ellipse& e : discs)
    bucket_ += kBucket * e.radius() / static_cast<double>(discs.size());
  double right = 0;
  double bottom = 0;
  for (const Ellipse& e : discs) {
    right = std::max(right, e.x);
    bottom = std::max(bottom, e.y);
  }
  constexpr double kMostBuckets = 200;  // along a side
  bucket_ = std::max(bucket_, std::max(right, bottom) / kMostBuckets);
  bucket_cols_ = static_cast<int>(right / bucket_) + 1;
  bucket_rows_ = static_cast<int>(bottom / bucket_) + 1;
  const auto bucket_of = [&](const Ellipse& e) {
    return static_cast<std::size_t>(std::max(e.y, 0.0) / bucket_) *
               static_cast<std::size_t>(bucket_cols_) +
           static_cast<std::size_t>(std::max(e.x, 0.0) / bucket_);
  };
  first_.assign(static_cast<std::size_t>(bucket_cols_ * bucket_rows_) + 1, 0);
  for (const Ellipse& e : discs) ++first_[bucket_of(e) + 1];
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  order_.resize(discs.size());
  std::vector<std::size_t> to(first_.begin(), first_.end() - 1);
  for (std::size_t i = 0; i < discs.size(); ++i) order_[to[bucket_of(discs[i])]++] = i;
  taken_.assign(discs.size(), false);
  seeds_.clear();
  for (std::size_t i = 0; i < discs.size(); ++i) {
    if (const auto seed = seed_at(i)) seeds_.push_back(*seed);
  }
  std::ranges::sort(seeds_, {}, &Seed::misfit);
  next_seed_ = 0;
}

std::optional<std::size_t> DiscGraph::nearest(double x, double y, double within,
                                              const Ellipse& like) const {
  std::optional<std::size_t> best;
  double least = within * within;
  for_each_near(x, y, within, [&](std::size_t i) {
    const double square = std::pow(discs_[i].x - x, 2) + std::pow(discs_[i].y - y, 2);
    if (square >= least || !are_alike(discs_[i], like)) return;
    least = square;
    best = i;
  });
  return best;
}

std::optional<DiscGraph::Seed> DiscGraph::seed_at(std::size_t disc) const {
  constexpr double kFarthest = 9;  // radii, of the nearest neighbour
  constexpr double kNearest = 2.05;
  constexpr double kOff = 0.35;  // of the spacing, of a neighbour
  const Ellipse& e = discs_[disc];
  // The nearest disc, measured in radii.
  std::optional<std::size_t> next;
  double least = kFarthest * kFarthest;
  for_each_near(e.x, e.y, kFarthest * std::sqrt(e.longest_square()), [&](std::size_t i) {
    const double square = e.square_distance_of(discs_[i]);
    if (!(square < least && square > kNearest * kNearest) || !are_alike(discs_[i], e)) return;
    least = square;
    next = i;
  });
  if (!next) return std::nullopt;
  // A quarter turn in the plane of the board: J R J^-1 with J J^T = [xx xy; xy yy] is, for any J,
  // [xy -xx; yy -xy] / sqrt(det), up to its sense.
  Seed seed;
  seed.disc = disc;
  seed.along_x = discs_[*next].x - e.x;
  seed.along_y = discs_[*next].y - e.y;
  const double root = std::sqrt(e.determinant());
  const double turned_x = (e.xy * seed.along_x - e.xx * seed.along_y) / root;
  const double turned_y = (e.yy * seed.along_x - e.xy * seed.along_y) / root;
  const std::array<std::array<double, 2>, 3> places = {
      {{turned_x, turned_y}, {-turned_x, -turned_y}, {-seed.along_x, -seed.along_y}}};
  std::array<std::size_t, 3> found{};
  for (std::size_t k = 0; k < places.size(); ++k) {
    const auto [dx, dy] = places[k];
    const auto at = nearest(e.x + dx, e.y + dy, kOff * std::hypot(dx, dy), e);
    if (!at || *at == disc) return std::nullopt;
    found[k] = *at;
  }
  // Opposite neighbours tell how straight and even the rows are.
  const auto unevenness = [&](std::size_t a, std::size_t b) {
    const double dx = discs_[a].x + discs_[b].x - 2 * e.x;
    const double dy = discs_[a].y + discs_[b].y - 2 * e.y;
    return std::hypot(dx, dy) / std::hypot(discs_[a].x - discs_[b].x, discs_[a].y - discs_[b].y);
  };
  seed.misfit = unevenness(*next, found[2]) + unevenness(found[0], found[1]);
  constexpr double kUneven = 0.2;
  if (found[0] == found[1] || seed.misfit > kUneven) return std::nullopt;
  seed.along_x = (discs_[*next].x - discs_[found[2]].x) / 2;
  seed.along_y = (discs_[*next].y - discs_[found[2]].y) / 2;
  seed.down_x = (discs_[found[0]].x - discs_[found[1]].x) / 2;
  seed.down_y = (discs_[found[0]].y - discs_[found[1]].y) / 2;
  return seed;
}

bool DiscGraph::next(int least, DiscLattice& lattice) {
  while (next_seed_ < seeds_.size()) {
    const Seed& seed = seeds_[next_seed_++];
    if (taken_[seed.disc]) continue;
    grow(seed, lattice);
    if (lattice.count() >= least) return true;
  }
  return false;
}

void DiscGraph::grow(const Seed& seed, DiscLattice& lattice) {
  constexpr double kOff = 0.3;  // of the spacing, of a disc from where it is expected
  struct Step {
    double x, y;
  };
  struct Front {
    Cell cell;
    Step along, down;
  };
  lattice.clear();
  lattice.put({0, 0}, discs_[seed.disc]);
  taken_[seed.disc] = true;
  std::vector<Front> queue = {{{0, 0}, {seed.along_x, seed.along_y}, {seed.down_x, seed.down_y}}};
  for (std::size_t at = 0; at < queue.size(); ++at) {
    const Front from = queue[at];
    const Ellipse here = *lattice.at(from.cell);
    for (const Cell way : kAround) {
      const Cell cell = from.cell + way;
      if (!lattice.in_reach(cell) || lattice.at(cell) != nullptr) continue;
      const Step step = {way.col * from.along.x + way.row * from.down.x,
                         way.col * from.along.y + way.row * from.down.y};
      const double within = kOff * std::hypot(step.x, step.y);
      const auto found = nearest(here.x + step.x, here.y + step.y, within, here);
      if (!found || taken_[*found]) continue;
      const Ellipse& there = discs_[*found];
      taken_[*found] = true;
      lattice.put(cell, there);
      Front next = {cell, from.along, from.down};
      const int sign = way.col + way.row;
      (way.col != 0 ? next.along : next.down) = {sign * (there.x - here.x),
                                                 sign * (there.y - here.y)};
      queue.push_back(next);
    }
  }
}

}  // namespace calvin::detect
