// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Every way to lay a board over a lattice, and how many bits speak for it.

#include "calvin/detect/checkerboard/code/code_match.hpp"

#include <algorithm>
#include <cmath>

#include "calvin/detect/checkerboard/code/evidence.hpp"

namespace calvin::detect {

namespace {

constexpr double kLeastLead = 5;   // nats, before the next best way
constexpr double kFewRight = 0.6;  // of the first bits

// The cells in which a board begins whose window meets the lattice in at least two rows and
// columns.
CellRange origins(const CellRange& e, int cols, int rows) {
  return {{e.first.col - cols + 2, e.first.row - rows + 2}, {e.last.col - 1, e.last.row - 1}};
}

// Whether the longer steps of the lattice are where the board has them, from its first column on.
bool steps_fit(const GridAlignment& alignment, const Lattice& lattice) {
  const Cell first = alignment.cell({0, 0});
  return lattice.has_even_steps() || lattice.length(first, alignment.cell({1, 0}) - first) > 1;
}

// Every way to lay a board over a lattice: its colours and the lengths of its steps are right.
template <typename F>
void for_each_way(const Grid& grid, const Code& code, const Lattice& lattice, F f) {
  const CellRange extent = lattice.extent();
  for (int quarter = 0; quarter < 4; ++quarter) {
    const int cols = quarter % 2 == 0 ? grid.cols : grid.rows;
    const int rows = quarter % 2 == 0 ? grid.rows : grid.cols;
    const CellRange all = origins(extent, cols, rows);
    for (int row = all.first.row; row <= all.last.row; ++row) {
      for (int col = all.first.col; col <= all.last.col; ++col) {
        const GridAlignment alignment = {quarter, {col, row}, cols, rows};
        if (alignment.begins_dark() != code.begins_dark()) continue;
        if (steps_fit(alignment, lattice)) f(alignment);
      }
    }
  }
}

// Whether so many columns and rows are no more than those of a board, whichever way it lies.
bool may_be_part(const CellRange& extent, const Grid& grid) {
  return (extent.cols() <= grid.cols && extent.rows() <= grid.rows) ||
         (extent.cols() <= grid.rows && extent.rows() <= grid.cols);
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

// Whether most nodes of a line next to the board, or of one farther out, are there: a sheet that is
// larger than the board is another one, however much of its code is the same.
bool goes_on(const GridAlignment& alignment, const Lattice& lattice) {
  const CellRange e = lattice.extent();
  const Cell last = alignment.origin + Cell{alignment.cols - 1, alignment.rows - 1};
  const auto is_line = [&](Cell first, Cell step, int count) {
    int nodes = 0;
    for (int i = 0; i < count; ++i) nodes += lattice.has(first + i * step) ? 1 : 0;
    return nodes >= 3 && 2 * nodes > count;
  };
  for (int col = e.first.col; col <= e.last.col; ++col) {
    const bool is_outside = col < alignment.origin.col || col > last.col;
    if (is_outside && is_line({col, e.first.row}, {0, 1}, e.rows())) return true;
  }
  for (int row = e.first.row; row <= e.last.row; ++row) {
    const bool is_outside = row < alignment.origin.row || row > last.row;
    if (is_outside && is_line({e.first.col, row}, {1, 0}, e.cols())) return true;
  }
  return false;
}

// Whether a further line of nodes, of a board of which a code was read, would have been seen on any
// side: it would lie in the image, and so do those that were not found.
bool is_next_line_in_view(const ImageView& image, const Lattice& lattice) {
  const CellRange e = lattice.extent();
  for (int row = e.first.row - 1; row <= e.last.row + 1; ++row) {
    for (int col = e.first.col - 1; col <= e.last.col + 1; ++col) {
      const Cell c = {col, row};
      const bool is_corner =
          (col < e.first.col || col > e.last.col) && (row < e.first.row || row > e.last.row);
      if (is_corner || !lattice.in_reach(c) || lattice.has(c)) continue;
      const auto place = lattice.expect(c);
      if (place &&
          !(place->x >= 0 && place->y >= 0 && place->x <= static_cast<float>(image.width - 1) &&
            place->y <= static_cast<float>(image.height - 1))) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace

void BitArea::set(std::span<const CodeBit> bits) {
  cells_ = {};
  if (bits.empty()) return;
  cells_ = {bits.front().at.cell, bits.front().at.cell};
  for (const CodeBit& bit : bits) {
    const Cell c = bit.at.cell;
    cells_.first = {std::min(cells_.first.col, c.col), std::min(cells_.first.row, c.row)};
    cells_.last = {std::max(cells_.last.col, c.col), std::max(cells_.last.row, c.row)};
  }
  sums_.assign(static_cast<std::size_t>((cells_.cols() + 1) * (cells_.rows() + 1)), 0);
  for (const CodeBit& bit : bits) {
    const Cell c = bit.at.cell - cells_.first;
    ++before(c.col + 1, c.row + 1);
  }
  for (int row = 1; row <= cells_.rows(); ++row) {
    int of_row = 0;
    for (int col = 1; col <= cells_.cols(); ++col) {
      of_row += before(col, row);
      before(col, row) = before(col, row - 1) + of_row;
    }
  }
}

int BitArea::within(const CellRange& range) const {
  const auto cut = [](int from_first, int count) { return std::clamp(from_first, 0, count); };
  const int left = cut(range.first.col - cells_.first.col, cells_.cols());
  const int right = cut(range.last.col + 1 - cells_.first.col, cells_.cols());
  const int top = cut(range.first.row - cells_.first.row, cells_.rows());
  const int bottom = cut(range.last.row + 1 - cells_.first.row, cells_.rows());
  if (left >= right || top >= bottom) return 0;
  return before(right, bottom) - before(left, bottom) - before(right, top) + before(left, top);
}

// A wrong marker has half of its bits right by chance.
void CodeMatch::Count::end_marker() {
  constexpr int kFewestOfMarker = 8;       // bits; other codes have fewer in a cell
  constexpr double kLeastOfMarker = 0.75;  // of its bits
  if (marker.seen >= kFewestOfMarker) {
    ++markers;
    wrong_markers += marker.right < kLeastOfMarker * marker.seen ? 1 : 0;
  }
  marker = {};
}

// nats, that this is no chance. None where most bits of a family are as good as chance, for the
// codes of two places may have one family in common; and none where markers are wrong, for boards
// of the same markers in rows of other lengths have some rows in common.
double CodeMatch::Count::evidence(const Code& code) const {
  if (light < code.fewest_light()) return 0;
  if (wrong_markers > (1 - kLeastRight) * markers) return 0;
  int all = 0;
  int good = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (right[i] < kLeastRight * seen[i]) return 0;
    all += seen[i];
    good += right[i];
  }
  return evidence_of(all, good);
}

// Counts no further than to see that too few bits are right.
CodeMatch::Count CodeMatch::count(const Code& code, std::span<const CodeBit> turned, Cell shift) {
  constexpr int kEnough = 48;  // bits: by chance, six of them in ten are not right
  Count sum;
  int seen = 0;
  int right = 0;
  for (const CodeBit& bit : turned) {
    const int expected = code.at({bit.at.cell + shift, bit.at.index});
    if (expected == 0) continue;
    const bool is_right = (expected > 0) == bit.light;
    const std::size_t family = code.family(bit.at.index);
    ++sum.seen[family];
    sum.right[family] += is_right ? 1 : 0;
    sum.light += is_right && bit.light ? 1 : 0;
    if (!(bit.at.cell == sum.marker.cell)) sum.end_marker();
    sum.marker = {bit.at.cell, sum.marker.seen + 1, sum.marker.right + (is_right ? 1 : 0)};
    ++seen;
    right += is_right ? 1 : 0;
    if (seen == kEnough && right < kFewRight * seen) break;
  }
  sum.end_marker();
  return sum;
}

void CodeMatch::turn(const Code& code) {
  int quarter = 0;
  for (auto& [bits, area] : turned_) {
    bits = bits_;
    for (CodeBit& bit : bits) bit.at = code.turned(bit.at, quarter);
    area.set(bits);
    ++quarter;
  }
}

const CodeMatch::TurnedBits& CodeMatch::turned(const GridAlignment& alignment) const {
  return turned_[static_cast<std::size_t>(alignment.quarter)];
}

void CodeMatch::add_candidate(const GridAlignment& alignment, double evidence) {
  if (evidence > best_.evidence) {
    next_best_ = best_.evidence;
    best_ = {alignment, evidence};
  } else if (evidence > next_best_) {
    next_best_ = evidence;
  }
}

bool CodeMatch::is_convincing() const {
  const double chances = std::log(std::max(candidates_, 1));
  return best_.evidence >= kLeastEvidence + chances && best_.evidence >= next_best_ + kLeastLead;
}

// Ways that have all bits on the board are tried first. Where one of them has them right, hardly
// any other way has enough bits on the board to be a rival.
void CodeMatch::compare(const Grid& grid, const Code& code, const Lattice& lattice) {
  constexpr double kNatsPerBit = 0.6931472;  // ln 2: what a bit that is right says at the most
  best_ = {};
  next_best_ = 0;
  candidates_ = 0;
  turn(code);
  for (const bool with_all : {true, false}) {
    for_each_way(grid, code, lattice, [&](const GridAlignment& alignment) {
      const int bits = bits_within(code, alignment);
      if ((bits == static_cast<int>(bits_.size())) != with_all) return;
      ++candidates_;
      if (kNatsPerBit * bits < best_.evidence - kLeastLead) return;
      const Cell shift = alignment.point({0, 0});
      add_candidate(alignment, count(code, turned(alignment).bits, shift).evidence(code));
    });
  }
}

// Where the bits that were read name no way with certainty, how light all bits are may do so. A
// lattice larger than the board is none that blur hides the name of.
void CodeMatch::compare_blurred(const ImageView& image, const Grid& grid, const Code& code,
                                const Lattice& lattice) {
  best_ = {};
  next_best_ = 0;
  if (!may_be_part(dense_extent(lattice), grid)) return;
  blurred_.take(image, lattice, code);
  for_each_way(grid, code, lattice, [&](const GridAlignment& alignment) {
    add_candidate(alignment, blurred_.evidence(code, alignment));
  });
}

int CodeMatch::bits_within(const Code& code, const GridAlignment& alignment) const {
  const Cell shift = alignment.point({0, 0});
  const CellRange cells = code.cells();
  return turned(alignment).area.within({cells.first - shift, cells.last - shift});
}

// What a lattice is that is no part of the board: another one that its code tells, as a PuzzleBoard
// from elsewhere in the map, or a whole grid without this code. kNotFound where neither is certain.
Match CodeMatch::another_board(const ImageView& image, const Grid& grid, const Code& code,
                               const Lattice& lattice) const {
  const CellRange extent = lattice.extent();
  const bool lies_alike = (extent.cols() >= extent.rows()) == (grid.cols >= grid.rows);
  // The ends of a pattern are looked for where squares are alike.
  const bool is_certain = lattice.has_even_steps() && is_size_certain(image, lattice);
  Match match;
  if (const auto board = code.other_board(image, lattice, bits_, is_certain)) {
    match = wrong_board(extent, lies_alike ? 0 : 1);
    match.seen = board->text();
    match.size_is_certain = is_next_line_in_view(image, lattice);
  }
  if (is_certain && match.reason != Reason::kWrongBoard) {
    match = wrong_board(extent, lies_alike ? 0 : 1);
  }
  match.size_is_certain |= is_certain;
  return match;
}

Match CodeMatch::match(const ImageView& image, const Grid& grid, const Code& code,
                       Lattice& lattice) {
  Match match;
  bits_.clear();
  code.read(image, lattice, bits_);
  const CellRange extent = lattice.extent();
  compare(grid, code, lattice);
  if (!is_convincing()) compare_blurred(image, grid, code, lattice);
  if (!is_convincing()) return another_board(image, grid, code, lattice);
  if (goes_on(best_.alignment, lattice)) {
    match = another_board(image, grid, code, lattice);
    return match.reason == Reason::kWrongBoard ? match
                                               : wrong_board(extent, best_.alignment.quarter);
  }
  match.alignment = best_.alignment;
  trim(match.alignment, grid, lattice);
  match.reason = Reason::kAccepted;
  match.whole = lattice.count() == grid.count();
  return match;
}

void set_dots(const Code& code, const GridAlignment& alignment, Lattice& lattice) {
  const Cell shift = alignment.point({0, 0});
  lattice.for_each([&](Cell c, const Node& /*node*/) {
    for (std::size_t way = 0; way < kAround.size(); ++way) {
      const Cell next = c + kAround[way];
      std::int8_t& dot = lattice.at(c).dots[way];
      const CodePlace seen = {way < 2 ? c : next, static_cast<int>(way % 2)};
      CodePlace place = code.turned(seen, alignment.quarter);
      place.cell = place.cell + shift;
      dot = static_cast<std::int8_t>(code.at(place));
    }
  });
}

}  // namespace calvin::detect
