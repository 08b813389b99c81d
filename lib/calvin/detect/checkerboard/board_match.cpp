// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Every way to lay a board over a lattice, and the choice among the ways that fit.

#include "calvin/detect/checkerboard/board_match.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "calvin/detect/checkerboard/board_edge.hpp"

namespace calvin::detect {

namespace {

// The least part of a board that is reported, so that nothing else is taken for one.
constexpr int kLeastNodes = 9;
constexpr double kLeastPart = 0.2;  // of the control points
// Of the control points, where all rows and columns are in view but no edge of the board.
constexpr double kEdgelessShare = 0.5;

int length(const CellRange& e, int axis) { return axis == 0 ? e.cols() : e.rows(); }

bool fits(const CellRange& e, const Checkerboard& board) {
  return (e.cols() <= board.cols && e.rows() <= board.rows) ||
         (e.cols() <= board.rows && e.rows() <= board.cols);
}

// The cells of one side of an extent: the outermost line of nodes.
struct OuterLine {
  Cell first;
  Cell step;
  int count = 0;
};

// Side 0: the last column, 1: the last row, 2: the first column, 3: the first row; as kAround.
OuterLine line_of(const CellRange& e, int side) {
  const bool is_column = side % 2 == 0;
  const Cell first = side == 0   ? Cell{e.last.col, e.first.row}
                     : side == 1 ? Cell{e.first.col, e.last.row}
                                 : e.first;
  return {first, is_column ? Cell{0, 1} : Cell{1, 0}, is_column ? e.rows() : e.cols()};
}

int nodes_on(const Lattice& lattice, const OuterLine& line) {
  int count = 0;
  for (int i = 0; i < line.count; ++i) count += lattice.has(line.first + i * line.step) ? 1 : 0;
  return count;
}

// Removes the outermost lines of stray nodes until the lattice is no larger than the board. False
// where most nodes of a line that would have to go are there: then it is not stray.
bool trim(const Checkerboard& board, Lattice& lattice) {
  for (CellRange e = lattice.extent(); !fits(e, board); e = lattice.extent()) {
    int weakest = 0;
    double least = 1;
    for (int side = 0; side < 4; ++side) {
      // An axis that is not too long keeps its lines.
      if (length(e, side % 2) <= std::min(board.cols, board.rows)) continue;
      const OuterLine line = line_of(e, side);
      const double share = nodes_on(lattice, line) / static_cast<double>(line.count);
      if (share < least) {
        least = share;
        weakest = side;
      }
    }
    if (least > 0.5) return false;
    const OuterLine line = line_of(e, weakest);
    for (int i = 0; i < line.count; ++i) {
      const Cell cell = line.first + i * line.step;
      if (lattice.in_reach(cell)) lattice.remove(cell);
    }
  }
  return true;
}

struct Edges {
  std::array<bool, 4> seen{};    // by side
  Edge margin = Edge::kNotSeen;  // its colour
  [[nodiscard]] int count() const {
    return static_cast<int>(std::count(seen.begin(), seen.end(), true));
  }
};

// Those sides whose margin has the usual colour: something straight that covers the board may look
// like another.
Edges sides_of_one_colour(const std::array<Edge, 4>& margins) {
  const auto dark = std::count(margins.begin(), margins.end(), Edge::kDarkMargin);
  const auto bright = std::count(margins.begin(), margins.end(), Edge::kBrightMargin);
  Edges edges;
  if (dark == bright) return edges;
  edges.margin = dark > bright ? Edge::kDarkMargin : Edge::kBrightMargin;
  for (std::size_t side = 0; side < 4; ++side) edges.seen[side] = margins[side] == edges.margin;
  return edges;
}

Edges edges_of(const ImageView& image, const Lattice& lattice, const CellRange& e) {
  std::array<Edge, 4> margins{};
  for (int side = 0; side < 4; ++side) {
    const OuterLine line = line_of(e, side);
    margins[static_cast<std::size_t>(side)] = find_edge(
        image, lattice, line.first, line.step, line.count, kAround[static_cast<std::size_t>(side)]);
  }
  return sides_of_one_colour(margins);
}

// The sides beyond which no line of nodes can follow: those where the pattern ends in any way, and
// those whose edge was seen, in the same colour. Behind a narrow margin an edge may be seen in the
// colour of what lies beyond, so that where the pattern ends counts first.
Edges ends_of(const ImageView& image, const Lattice& lattice, const CellRange& e,
              const Edges& edges) {
  std::array<Edge, 4> margins{};
  for (std::size_t side = 0; side < 4; ++side) {
    const OuterLine line = line_of(e, static_cast<int>(side));
    margins[side] = pattern_ends(image, lattice, line.first, line.step, line.count, kAround[side]);
    if (margins[side] == Edge::kNotSeen && edges.seen[side]) margins[side] = edges.margin;
  }
  return sides_of_one_colour(margins);
}

// Whether a board of this size would be a part of something larger.
bool continues_anywhere(const ImageView& image, const Lattice& lattice, const CellRange& e) {
  for (int side = 0; side < 4; ++side) {
    const OuterLine line = line_of(e, side);
    if (continues_beyond(image, lattice, line.first, line.step, line.count,
                         kAround[static_cast<std::size_t>(side)])) {
      return true;
    }
  }
  return false;
}

bool has_size_of(const CellRange& e, const Checkerboard& board) {
  return (e.cols() == board.cols && e.rows() == board.rows) ||
         (e.cols() == board.rows && e.rows() == board.cols);
}

// Every way in which the lattice can be (a part of) the board, of these colours or of any.
std::vector<GridAlignment> alignments(const Checkerboard& board, const CellRange& e,
                                      const Edges& edges, bool any_colours = false) {
  std::vector<GridAlignment> all;
  for (int quarter = 0; quarter < 4; ++quarter) {
    const int cols = quarter % 2 == 0 ? board.cols : board.rows;
    const int rows = quarter % 2 == 0 ? board.rows : board.cols;
    // Windows from the one that ends where the nodes do to the one that begins where they do; an
    // edge that was seen fixes one of these.
    Cell first = {e.last.col - cols + 1, e.last.row - rows + 1};
    Cell last = e.first;
    if (edges.seen[0]) last.col = std::min(last.col, first.col);
    if (edges.seen[1]) last.row = std::min(last.row, first.row);
    if (edges.seen[2]) first.col = std::max(first.col, e.first.col);
    if (edges.seen[3]) first.row = std::max(first.row, e.first.row);
    for (int row = first.row; row <= last.row; ++row) {
      for (int col = first.col; col <= last.col; ++col) {
        const GridAlignment p = {quarter, {col, row}, cols, rows};
        if (any_colours || p.begins_dark()) all.push_back(p);
      }
    }
  }
  return all;
}

// The place of a cell in the image, px: of its node, or else extrapolated from the middle of the
// lattice by its mean steps.
std::pair<double, double> place_of(const Lattice& lattice, Cell cell) {
  if (lattice.has(cell)) return {lattice.at(cell).x, lattice.at(cell).y};
  double n = 0, x = 0, y = 0, col = 0, row = 0;
  double step[4] = {0, 0, 0, 0};
  double steps[2] = {0, 0};
  lattice.for_each([&](Cell c, const Node& node) {
    n += 1;
    x += static_cast<double>(node.x);
    y += static_cast<double>(node.y);
    col += c.col;
    row += c.row;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      if (!lattice.has(c + kAround[axis])) continue;
      const Node& next = lattice.at(c + kAround[axis]);
      step[2 * axis] += static_cast<double>(next.x - node.x);
      step[2 * axis + 1] += static_cast<double>(next.y - node.y);
      steps[axis] += 1;
    }
  });
  const double dc = (cell.col - col / n) / std::max(steps[0], 1.0);
  const double dr = (cell.row - row / n) / std::max(steps[1], 1.0);
  return {x / n + dc * step[0] + dr * step[2], y / n + dc * step[1] + dr * step[3]};
}

// Among equal alignments the one whose control point 0 is nearest to the top left of the image.
std::size_t choose(const Lattice& lattice, const std::vector<GridAlignment>& all) {
  std::size_t best = 0;
  double least = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto [x, y] = place_of(lattice, all[i].cell({0, 0}));
    const double distance = std::hypot(x, y);
    if (i == 0 || distance < least) {
      best = i;
      least = distance;
    }
  }
  return best;
}

int quarters_between(const GridAlignment& from, const GridAlignment& to) {
  return (from.quarter - to.quarter + 4) % 4;
}

// The turn and shift, as Observation::ambiguous has them, that take labels of `from` to those of
// `to`.
Relabelling difference(const Checkerboard& board, const GridAlignment& from,
                       const GridAlignment& to) {
  const int quarters = quarters_between(from, to);
  Cell turned = from.point(from.origin);
  int cols = board.cols;
  int rows = board.rows;
  for (int i = 0; i < quarters; ++i) {
    turned = {rows - 1 - turned.row, turned.col};
    std::swap(cols, rows);
  }
  const Cell shift = to.point(from.origin) - turned;
  return {quarters, shift.col, shift.row};
}

bool is_enough(const Lattice& lattice, const Checkerboard& board, const CellRange& e,
               const Edges& edges) {
  const int count = lattice.count();
  const int all = board.grid().count();
  if (count == all) return true;
  if (count < kLeastNodes || count < kLeastPart * all || e.cols() < 3 || e.rows() < 3) return false;
  const int seen = edges.count();
  return (has_size_of(e, board) && count > kEdgelessShare * all) || seen >= 1;
}

// Those of all alignments but the best, as Observation::ambiguous has them.
std::vector<Relabelling> other_labellings(const Checkerboard& board,
                                          const std::vector<GridAlignment>& all, std::size_t best) {
  std::vector<Relabelling> others;
  for (int quarters = 0; quarters < 4; ++quarters) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (i == best || quarters_between(all[best], all[i]) != quarters) continue;
      others.push_back(difference(board, all[best], all[i]));
    }
  }
  return others;
}

// A board of another size, its longer side named first where that is so of the board.
Match wrong_board(const Checkerboard& board, const Lattice& lattice) {
  const CellRange e = dense_extent(lattice);
  const bool turned = (e.cols() >= e.rows()) != (board.cols >= board.rows);
  Match match;
  match.reason = Reason::kWrongBoard;
  match.seen_cols = turned ? e.rows() : e.cols();
  match.seen_rows = turned ? e.cols() : e.rows();
  return match;
}

// Whether a lattice has enough rows and columns, and nodes in them, to be a board.
bool is_grid(const Lattice& lattice, const CellRange& e) {
  constexpr double kMost = 0.8;  // of the nodes of its rows and columns
  return e.cols() >= 3 && e.rows() >= 3 && lattice.count() >= kLeastNodes &&
         lattice.count() >= kMost * e.cols() * e.rows();
}

// Drops the alignments of which nodes would lie where the pattern ends on both sides.
void drop_larger(const CellRange& e, const Edges& ends, std::vector<GridAlignment>& all) {
  std::erase_if(all, [&](const GridAlignment& p) {
    return (ends.seen[0] && ends.seen[2] && p.cols != e.cols()) ||
           (ends.seen[1] && ends.seen[3] && p.rows != e.rows());
  });
}

}  // namespace

Cell GridAlignment::point(Cell c) const {
  const Cell d = c - origin;
  switch (quarter) {
    case 0:
      return d;
    case 1:
      return {d.row, cols - 1 - d.col};
    case 2:
      return {cols - 1 - d.col, rows - 1 - d.row};
    default:
      return {rows - 1 - d.row, d.col};
  }
}

Cell GridAlignment::cell(Cell p) const {
  switch (quarter) {
    case 0:
      return origin + p;
    case 1:
      return origin + Cell{cols - 1 - p.row, p.col};
    case 2:
      return origin + Cell{cols - 1 - p.col, rows - 1 - p.row};
    default:
      return origin + Cell{p.row, rows - 1 - p.col};
  }
}

bool is_far_larger(const Lattice& lattice, const Checkerboard& board) {
  constexpr double kFar = 1.5;
  const CellRange e = lattice.extent();
  const auto [shorter, longer] = std::minmax({e.cols(), e.rows()});
  return lattice.count() > kFar * board.grid().count() &&
         (shorter > std::min(board.cols, board.rows) + 1 ||
          longer > std::max(board.cols, board.rows) + 1);
}

CellRange dense_extent(const Lattice& lattice) {
  CellRange e = lattice.extent();
  for (int side = 0; side < 4;) {
    const OuterLine line = line_of(e, side);
    if (line.count <= 0 || length(e, side % 2) <= 0 || 2 * nodes_on(lattice, line) > line.count) {
      ++side;
      continue;
    }
    Cell& end = side < 2 ? e.last : e.first;
    const int step = side < 2 ? -1 : 1;
    end = end + (side % 2 == 0 ? Cell{step, 0} : Cell{0, step});
    side = 0;
  }
  return e;
}

bool is_size_certain(const ImageView& image, const Lattice& lattice) {
  const CellRange e = dense_extent(lattice);
  return is_grid(lattice, e) && ends_of(image, lattice, e, {}).count() == 4;
}

Match match_board(const ImageView& image, const Checkerboard& board, Lattice& lattice) {
  const bool small_enough = trim(board, lattice);
  const CellRange e = lattice.extent();
  Match match = wrong_board(board, lattice);
  if (!small_enough) {
    match.certain = lattice.count() > board.grid().count();
    match.size_is_certain = is_size_certain(image, lattice);
    return match;
  }
  if (has_size_of(e, board) && continues_anywhere(image, lattice, e)) return match;
  match.reason = Reason::kNotFound;
  match.whole = lattice.count() == board.grid().count();
  // A whole board may lack the margin that tells its edge.
  const Edges edges = match.whole ? Edges{} : edges_of(image, lattice, e);
  auto all = alignments(board, e, edges);
  if (!match.whole) {
    const bool enough = is_enough(lattice, board, e, edges);
    if (!enough && !is_grid(lattice, e)) return match;
    const Edges ends = ends_of(image, lattice, e, edges);
    if (!enough && (ends.count() < 4 || has_size_of(e, board))) return match;
    drop_larger(e, ends, all);
  }
  // Inverted, or printed with exchanged colours: a whole board is accepted all the same.
  match.exchanged = all.empty() && match.whole;
  if (match.exchanged) all = alignments(board, e, edges, true);
  if (all.empty()) {
    match.reason = Reason::kWrongBoard;
    match.certain = edges.count() == 4;
    match.size_is_certain = is_size_certain(image, lattice);
    return match;
  }
  match.reason = Reason::kAccepted;
  const std::size_t best = choose(lattice, all);
  match.alignment = all[best];
  match.ambiguous = other_labellings(board, all, best);
  return match;
}

}  // namespace calvin::detect
