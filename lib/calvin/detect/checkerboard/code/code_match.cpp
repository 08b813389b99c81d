// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Every way to lay a board over a lattice, and how many bits speak for it.

#include "calvin/detect/checkerboard/code/code_match.hpp"

#include <cmath>

namespace calvin::detect {

namespace {

// nats: of as many wrong codes as e to this, none looks right by chance.
constexpr double kLeastEvidence = 9;
constexpr double kLeastLead = 5;     // nats, before the next best way
constexpr double kFewRight = 0.6;    // of the first bits
constexpr double kLeastRight = 0.7;  // of the bits; something may cover the others

// How unlikely it is that so many bits are right by chance: the exponent of Chernoff's bound, nats.
double evidence_of(int seen, int right) {
  if (2 * right <= seen) return 0;
  const double p = right / static_cast<double>(seen);
  const double wrong = p < 1 ? (1 - p) * std::log(2 * (1 - p)) : 0;
  return seen * (p * std::log(2 * p) + wrong);
}

// The cells in which a board begins whose window meets the lattice in at least two rows and
// columns.
CellRange origins(const CellRange& e, int cols, int rows) {
  return {{e.first.col - cols + 2, e.first.row - rows + 2}, {e.last.col - 1, e.last.row - 1}};
}

bool begins_dark(const GridAlignment& alignment) {
  return Lattice::is_even(alignment.cell({0, 0})) == (alignment.quarter % 2 == 1);
}

// Removes the nodes beyond the board.
void trim(const GridAlignment& alignment, const Grid& grid, Lattice& lattice) {
  lattice.for_each([&](Cell c, const Node& /*node*/) {
    const Cell point = alignment.point(c);
    if (!grid.contains({point.col, point.row})) lattice.remove(c);
  });
}

// The size of a grid that is no part of the board, as the board would name it.
Match wrong_board(const CellRange& extent, int quarter) {
  Match match;
  match.reason = Reason::kWrongBoard;
  match.seen_cols = quarter % 2 == 0 ? extent.cols() : extent.rows();
  match.seen_rows = quarter % 2 == 0 ? extent.rows() : extent.cols();
  match.certain = true;
  return match;
}

}  // namespace

// Counts the bits of cells within a range, or of those that are not; no further than to see that
// too few are right.
CodeMatch::Count CodeMatch::count(const Code& code, Cell shift, const CellRange& within,
                                  bool inside) const {
  constexpr int kEnough = 48;  // bits: by chance, six of them in ten are not right
  Count sum;
  for (const CodeBit& bit : turned_) {
    const Cell cell = bit.at.cell + shift;
    const bool is_inside = cell.col >= within.first.col && cell.row >= within.first.row &&
                           cell.col <= within.last.col && cell.row <= within.last.row;
    if (is_inside != inside) continue;
    const int expected = code.at({cell, bit.at.index});
    sum.seen += expected != 0 ? 1 : 0;
    sum.right += expected == (bit.light ? 1 : -1) ? 1 : 0;
    if (sum.seen == kEnough && sum.right < kFewRight * sum.seen) break;
  }
  return sum;
}

void CodeMatch::turn(const Code& code, int quarter) {
  turned_ = bits_;
  for (CodeBit& bit : turned_) bit.at = code.turned(bit.at, quarter);
}

void CodeMatch::compare(const Grid& grid, const Code& code, const CellRange& extent) {
  best_ = {};
  next_best_ = 0;
  candidates_ = 0;
  // The squares around the outermost control points have markers too.
  const CellRange board = {{-1, -1}, {grid.cols - 1, grid.rows - 1}};
  for (int quarter = 0; quarter < 4; ++quarter) {
    turn(code, quarter);
    const int cols = quarter % 2 == 0 ? grid.cols : grid.rows;
    const int rows = quarter % 2 == 0 ? grid.rows : grid.cols;
    const CellRange all = origins(extent, cols, rows);
    for (int row = all.first.row; row <= all.last.row; ++row) {
      for (int col = all.first.col; col <= all.last.col; ++col) {
        const GridAlignment alignment = {quarter, {col, row}, cols, rows};
        if (begins_dark(alignment) != code.begins_dark()) continue;
        ++candidates_;
        const Count bits = count(code, alignment.point({0, 0}), board, true);
        const double evidence =
            bits.right < kLeastRight * bits.seen ? 0 : evidence_of(bits.seen, bits.right);
        if (evidence > best_.evidence) {
          next_best_ = best_.evidence;
          best_ = {alignment, evidence};
        } else if (evidence > next_best_) {
          next_best_ = evidence;
        }
      }
    }
  }
}

// Whether the code goes on beyond the board.
bool CodeMatch::is_larger(const Grid& grid, const Code& code) {
  if (!code.goes_on()) return false;
  const CellRange board = {{0, 0}, {grid.cols - 1, grid.rows - 1}};
  turn(code, best_.alignment.quarter);
  const Count beyond = count(code, best_.alignment.point({0, 0}), board, false);
  return evidence_of(beyond.seen, beyond.right) >= kLeastEvidence;
}

Match CodeMatch::match(const ImageView& image, const Grid& grid, const Code& code,
                       Lattice& lattice) {
  Match match;
  bits_.clear();
  code.read(image, lattice, bits_);
  const CellRange extent = lattice.extent();
  compare(grid, code, extent);
  const double chances = std::log(std::max(candidates_, 1));
  if (best_.evidence < kLeastEvidence + chances || best_.evidence < next_best_ + kLeastLead) {
    if (!is_size_certain(image, lattice)) return match;
    match =
        wrong_board(extent, (extent.cols() >= extent.rows()) == (grid.cols >= grid.rows) ? 0 : 1);
    match.size_is_certain = true;
    return match;
  }
  if (is_larger(grid, code)) {
    match = wrong_board(extent, best_.alignment.quarter);
    match.size_is_certain = is_size_certain(image, lattice);
    return match;
  }
  match.alignment = best_.alignment;
  trim(match.alignment, grid, lattice);
  match.reason = Reason::kAccepted;
  match.whole = lattice.count() == grid.count();
  return match;
}

void set_dots(const Code& code, const Grid& grid, const GridAlignment& alignment,
              Lattice& lattice) {
  const Cell shift = alignment.point({0, 0});
  const auto is_on_board = [&](Cell cell) {
    const Cell point = alignment.point(cell);
    return grid.contains({point.col, point.row});
  };
  lattice.for_each([&](Cell c, const Node& /*node*/) {
    for (std::size_t way = 0; way < kAround.size(); ++way) {
      const Cell next = c + kAround[way];
      std::int8_t& dot = lattice.at(c).dots[way];
      dot = 0;
      if (!is_on_board(c) || !is_on_board(next)) continue;
      const CodePlace seen = {way < 2 ? c : next, static_cast<int>(way % 2)};
      CodePlace place = code.turned(seen, alignment.quarter);
      place.cell = place.cell + shift;
      dot = static_cast<std::int8_t>(code.at(place));
    }
  });
}

}  // namespace calvin::detect
