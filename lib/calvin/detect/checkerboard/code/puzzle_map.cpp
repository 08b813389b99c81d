// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Each of the two codes tells one coordinate by itself and the other one in threes: they are looked
// up one after the other, and what they have in common is put together.

#include "calvin/detect/checkerboard/code/puzzle_map.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "calvin/detect/checkerboard/code/evidence.hpp"

namespace calvin::detect {

namespace {

constexpr int kLines = 3;
constexpr int kPeriod = PuzzleBoard::kMapSide / kLines;

// Where one code lies: the line that the first cell is on, and the place along it.
struct CodeOffset {
  int line = 0;
  int at = 0;
  int seen = 0;
  int right = 0;
};

bool is_light(const PuzzleBoard& board, const CodePlace& place) {
  const GridPlace p = {place.cell.col, place.cell.row};
  return place.index == 0 ? board.is_light_after(p) : board.is_light_below(p);
}

// How many bits of a code are right with cell {0, 0} at a place of the map, or fewer where too few
// are.
CodeOffset count(std::span<const CodeBit> bits, int index, CodeOffset offset) {
  constexpr int kEnough = 24;
  PuzzleBoard board;
  board.x0 = index == 0 ? offset.line : offset.at;
  board.y0 = index == 0 ? offset.at : offset.line;
  for (const CodeBit& bit : bits) {
    if (bit.at.index != index) continue;
    ++offset.seen;
    offset.right += is_light(board, bit.at) == bit.light ? 1 : 0;
    if (offset.seen == kEnough && offset.right < kLeastRight * offset.seen) break;
  }
  return offset;
}

CodeOffset best_offset(std::span<const CodeBit> bits, int index) {
  CodeOffset best;
  for (int line = 0; line < kLines; ++line) {
    for (int at = 0; at < kPeriod; ++at) {
      const CodeOffset offset = count(bits, index, {line, at});
      if (offset.right > best.right) best = offset;
    }
  }
  return best;
}

// The one of 501 that has these remainders by 167 and by 3.
int with_remainders(int by_period, int by_lines) {
  int x = by_period;
  while (x % kLines != by_lines) x += kPeriod;
  return x;
}

int wrapped(int x) {
  constexpr int kSide = PuzzleBoard::kMapSide;
  return (x % kSide + kSide) % kSide;
}

// A place of the map, and how sure it is.
struct MapPlace {
  PuzzleBoard board;
  double evidence = 0;  // nats
};

// Whether a code has told where it is: of a strip of the map one of the two is hardly seen, and
// some place has most of its few bits right by chance.
bool is_located(const CodeOffset& offset) {
  constexpr double kLeast = 3;  // nats, beyond what the best of all places has by chance
  const double chance = std::log(static_cast<double>(kLines * kPeriod));
  return offset.right >= kLeastRight * offset.seen &&
         evidence_of(offset.seen, offset.right) >= chance + kLeast;
}

// The corners of a lattice as the part of the map that fits its bits best.
MapPlace best_place(std::span<const CodeBit> turned, const CellRange& cells, double size) {
  const CodeOffset across = best_offset(turned, 0);
  const CodeOffset down = best_offset(turned, 1);
  MapPlace place{{cells.cols(), cells.rows(), size}, 0};
  if (!is_located(across) || !is_located(down)) return place;
  place.board.x0 = wrapped(with_remainders(down.at, across.line) + cells.first.col);
  place.board.y0 = wrapped(with_remainders(across.at, down.line) + cells.first.row);
  place.evidence = evidence_of(across.seen + down.seen, across.right + down.right);
  return place;
}

Cell turned_cell(Cell c, int quarter) {
  for (int i = 0; i < quarter; ++i) c = {c.row, -c.col};
  return c;
}

}  // namespace

std::optional<PuzzleBoard> locate_in_map(const Code& reader, std::span<const CodeBit> bits,
                                         const CellRange& extent, double size) {
  constexpr double kPlaces = 4.0 * PuzzleBoard::kMapSide * PuzzleBoard::kMapSide;
  MapPlace best;
  std::vector<CodeBit> turned(bits.begin(), bits.end());
  for (int quarter = 0; quarter < 4; ++quarter) {
    for (std::size_t i = 0; i < bits.size(); ++i) {
      turned[i].at = reader.turned(bits[i].at, quarter);
    }
    const Cell a = turned_cell(extent.first, quarter);
    const Cell b = turned_cell(extent.last, quarter);
    const CellRange cells = {{std::min(a.col, b.col), std::min(a.row, b.row)},
                             {std::max(a.col, b.col), std::max(a.row, b.row)}};
    const MapPlace place = best_place(turned, cells, size);
    if (place.evidence > best.evidence) best = place;
  }
  if (best.evidence < kLeastEvidence + std::log(kPlaces)) return std::nullopt;
  return best.board;
}

}  // namespace calvin::detect
