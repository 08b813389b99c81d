// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Boards of discs as cells, and all ways to lay them over a lattice.

#include "calvin/detect/circles/circle_pattern.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "calvin/target/kinds.hpp"

namespace calvin::detect {

namespace {

CellRange range_of(const std::vector<CirclePattern::Disc>& discs) {
  CellRange range = {discs.front().cell, discs.front().cell};
  for (const auto& disc : discs) {
    range.first = {std::min(range.first.col, disc.cell.col),
                   std::min(range.first.row, disc.cell.row)};
    range.last = {std::max(range.last.col, disc.cell.col), std::max(range.last.row, disc.cell.row)};
  }
  return range;
}

// One way to lay a board over a lattice, and how many marks speak for it.
struct Placing {
  CellMap map;
  int marks = 0;
};

// Whether every disc of the lattice is one of the board's that shows what it should.
std::optional<Placing> try_placing(const CirclePattern& pattern, const DiscLattice& lattice,
                                   std::span<const SeenMark> marks, CellMap map) {
  Placing placing{map, 0};
  for (std::size_t i = 0; i < lattice.cells().size(); ++i) {
    const auto disc = pattern.disc_in(map(lattice.cells()[i]));
    if (!disc) return std::nullopt;
    const DiscMark expected = pattern.discs()[*disc].mark;
    if (marks[i] && *marks[i] != expected) return std::nullopt;
    placing.marks += marks[i] && expected != DiscMark::kNone ? 1 : 0;
  }
  return placing;
}

// Whether two ways name the same discs but for a turn of the board onto itself.
bool are_same(const CirclePattern& pattern, const DiscLattice& lattice, const CellMap& a,
              const CellMap& b) {
  if (a.quarter_turns == b.quarter_turns) return a.shift == b.shift;
  const int turns = (b.quarter_turns - a.quarter_turns + 4) % 4;
  const auto symmetries = pattern.board().symmetries();
  const bool is_own = std::ranges::any_of(
      symmetries, [turns](const Relabelling& r) { return r.quarter_turns == turns; });
  if (!is_own) return false;
  // The turn is about the middle of the board, which stays where it is.
  const CellRange range = range_of(pattern.discs());
  const Cell first = a(lattice.cells().front());
  Cell c = {2 * first.col - range.first.col - range.last.col,
            2 * first.row - range.first.row - range.last.row};
  for (int i = 0; i < turns; ++i) c = {-c.row, c.col};
  const Cell second = b(lattice.cells().front());
  return c.col == 2 * second.col - range.first.col - range.last.col &&
         c.row == 2 * second.row - range.first.row - range.last.row;
}

}  // namespace

bool has_circle_pattern(const Board& board) {
  return board.as<CircleGrid>() != nullptr || board.as<AsymmetricCircleGrid>() != nullptr;
}

CirclePattern::CirclePattern(Board of) : board_(std::move(of)) {
  if (const auto* grid = board_.as<CircleGrid>()) {
    light_ = grid->inverted;
    marks_ = grid->has_marks();
    for (int id = 0; id < board_.point_count(); ++id) {
      const GridPlace p = grid->grid().place(id);
      discs_.push_back({{p.col, p.row}, grid->mark(p)});
    }
  } else if (const auto* asymmetric = board_.as<AsymmetricCircleGrid>()) {
    light_ = asymmetric->inverted;
    for (int id = 0; id < board_.point_count(); ++id) {
      const GridPlace p = asymmetric->half_steps(id);
      discs_.push_back({{(p.col + p.row) / 2, (p.row - p.col) / 2}, DiscMark::kNone});
    }
  }
  if (const auto* dots = board_.as<UnboundedGrid>()) {
    light_ = dots->inverted;
    for (int id = 0; id < board_.point_count(); ++id) {
      const GridPlace p = dots->grid().place(id);
      const int middle = UnboundedGrid::kSide / 2;  // near what is seen
      discs_.push_back({{p.col - middle, p.row - middle}, DiscMark::kNone});
    }
  }
  if (discs_.empty()) return;
  range_ = range_of(discs_);
  reach_ = std::max(range_.cols(), range_.rows());
  index_.assign(static_cast<std::size_t>(range_.cols() * range_.rows()), -1);
  for (std::size_t i = 0; i < discs_.size(); ++i) {
    const Cell c = discs_[i].cell - range_.first;
    index_[static_cast<std::size_t>(c.row * range_.cols() + c.col)] = static_cast<int>(i);
  }
}

std::optional<std::size_t> CirclePattern::disc_in(Cell c) const {
  const Cell at = c - range_.first;
  if (at.col < 0 || at.row < 0 || at.col >= range_.cols() || at.row >= range_.rows()) {
    return std::nullopt;
  }
  const int i = index_[static_cast<std::size_t>(at.row * range_.cols() + at.col)];
  if (i < 0) return std::nullopt;
  return static_cast<std::size_t>(i);
}

std::vector<CellMap> place_on(const CirclePattern& pattern, const DiscLattice& lattice,
                              std::span<const SeenMark> marks, double least_share) {
  const auto count = static_cast<double>(pattern.discs().size());
  if (lattice.count() < least_share * count || lattice.count() > static_cast<int>(count)) {
    return {};
  }
  const CellRange range = range_of(pattern.discs());
  std::vector<Placing> all;
  int most_marks = 0;
  for (int turns = 0; turns < 4; ++turns) {
    CellRange seen;
    for (const Cell c : lattice.cells()) {
      const Cell turned = CellMap{turns, {}}(c);
      if (seen.cols() <= 0) seen = {turned, turned};
      seen.first = {std::min(seen.first.col, turned.col), std::min(seen.first.row, turned.row)};
      seen.last = {std::max(seen.last.col, turned.col), std::max(seen.last.row, turned.row)};
    }
    const Cell first = range.first - seen.first;
    const Cell last = range.last - seen.last;
    for (int row = first.row; row <= last.row; ++row) {
      for (int col = first.col; col <= last.col; ++col) {
        const auto placing = try_placing(pattern, lattice, marks, {turns, {col, row}});
        if (!placing) continue;
        all.push_back(*placing);
        most_marks = std::max(most_marks, placing->marks);
      }
    }
  }
  if (pattern.has_marks() && most_marks == 0) return {};
  for (const Placing& other : all) {
    if (!are_same(pattern, lattice, all.front().map, other.map)) return {};
  }
  std::vector<CellMap> maps;
  for (const Placing& placing : all) maps.push_back(placing.map);
  return maps;
}

namespace {

// As it is seen after a quarter turn, its marks row by row.
CircleGrid turned(const CircleGrid& grid) {
  CircleGrid after = {grid.rows, grid.cols, grid.pitch, {}, {}, grid.inverted};
  const auto place = [&](GridPlace p) { return GridPlace{p.row, grid.cols - 1 - p.col}; };
  const auto row_by_row = [](GridPlace p) { return std::pair(p.row, p.col); };
  std::ranges::transform(grid.rings, std::back_inserter(after.rings), place);
  std::ranges::transform(grid.large, std::back_inserter(after.large), place);
  std::ranges::sort(after.rings, {}, row_by_row);
  std::ranges::sort(after.large, {}, row_by_row);
  return after;
}

// Whether the marks of `a` come first, row by row.
bool has_earlier_marks(const CircleGrid& a, const CircleGrid& b) {
  const auto is_earlier = [](GridPlace p, GridPlace q) {
    return std::pair(p.row, p.col) < std::pair(q.row, q.col);
  };
  if (a.rings != b.rings) return std::ranges::lexicographical_compare(a.rings, b.rings, is_earlier);
  return std::ranges::lexicographical_compare(a.large, b.large, is_earlier);
}

// The grid that a full lattice shows. Nobody sees which way up it was meant: its longer side is in
// columns, and its marks come early.
CircleGrid grid_of(const DiscLattice& lattice, std::span<const SeenMark> marks, double pitch,
                   bool inverted) {
  const CellRange range = lattice.extent();
  CircleGrid grid = {range.cols(), range.rows(), pitch, {}, {}, inverted};
  const std::vector<Cell> cells = lattice.cells();
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const Cell c = cells[i] - range.first;
    if (marks[i] == DiscMark::kRing) grid.rings.push_back({c.col, c.row});
    if (marks[i] == DiscMark::kLarge) grid.large.push_back({c.col, c.row});
  }
  std::optional<CircleGrid> best;
  for (int turn = 0; turn < 4; ++turn) {
    grid = turned(grid);
    if (grid.cols < grid.rows) continue;
    if (!best || has_earlier_marks(grid, *best)) best = grid;
  }
  return *best;
}

}  // namespace

std::optional<Board> board_of(const DiscLattice& lattice, std::span<const SeenMark> marks,
                              const Board& like) {
  const auto* grid = like.as<CircleGrid>();
  const auto* asymmetric = like.as<AsymmetricCircleGrid>();
  const bool inverted = grid != nullptr ? grid->inverted : asymmetric->inverted;
  const CellRange range = lattice.extent();
  if (lattice.count() == range.cols() * range.rows()) {
    const CircleGrid whole = grid_of(lattice, marks, like.cell_size(0), inverted);
    return whole.check() ? std::optional(Board(whole)) : std::nullopt;
  }
  // Rows of an asymmetric grid run along one of the diagonals.
  const auto extent_along = [&](int sign) {
    const auto along = [sign](Cell c) { return c.col + sign * c.row; };
    const auto [low, high] = std::ranges::minmax(lattice.cells(), {}, along);
    return along(high) - along(low) + 1;
  };
  for (const int sign : {1, -1}) {
    const int rows = extent_along(sign);
    const int width = extent_along(-sign);
    if (width % 2 != 0 || width * rows / 2 != lattice.count()) continue;
    return Board(
        AsymmetricCircleGrid{width / 2, rows, like.cell_size(0) / std::sqrt(2.0), inverted});
  }
  return std::nullopt;
}

}  // namespace calvin::detect
