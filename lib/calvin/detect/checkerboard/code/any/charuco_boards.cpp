// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Tries markers of every size in the squares, looks them up in all dictionaries, and lays rows of
// ids.

#include "calvin/detect/checkerboard/code/any/charuco_boards.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

#include "calvin/detect/checkerboard/code/marker_reader.hpp"

namespace calvin::detect {

namespace {

constexpr std::size_t kFewestMarkers = 3;
constexpr double kLeastAgreeing = 0.75;  // of the markers that are in the dictionary
constexpr std::size_t kMostSquares = 30;
constexpr int kMostColumns = 60;

struct KnownMarker {
  std::uint64_t code = 0;
  const MarkerDictionary* dictionary = nullptr;
  int id = 0;
};

// All markers with so many bits along a side, in the order of their codes.
std::vector<KnownMarker> markers_with(int side) {
  std::vector<KnownMarker> all;
  for (const MarkerDictionary& dictionary : marker_dictionaries()) {
    if (dictionary.side != side || dictionary.outside > 0) continue;
    for (std::size_t id = 0; id < dictionary.codes.size(); ++id) {
      all.push_back({dictionary.codes[id], &dictionary, static_cast<int>(id)});
    }
  }
  std::ranges::sort(all, {}, &KnownMarker::code);
  return all;
}

struct SeenMarker {
  Cell cell;  // of the upper left corner of its square
  int id = 0;
};

using MarkersOfDictionaries = std::map<const MarkerDictionary*, std::vector<SeenMarker>>;

// The markers whose bits were all read, by the dictionaries that have them.
MarkersOfDictionaries look_up(std::span<const CodeBit> bits, int side,
                              const std::vector<KnownMarker>& known) {
  const auto count = static_cast<std::size_t>(side * side);
  MarkersOfDictionaries seen;
  for (std::size_t from = 0; from < bits.size();) {
    const Cell cell = bits[from].at.cell;
    std::size_t to = from;
    std::uint64_t code = 0;
    for (; to < bits.size() && bits[to].at.cell == cell; ++to) {
      code |= std::uint64_t{bits[to].light}
              << (count - 1 - static_cast<std::size_t>(bits[to].at.index));
    }
    if (to - from == count) {
      auto marker = std::ranges::lower_bound(known, code, {}, &KnownMarker::code);
      for (; marker != known.end() && marker->code == code; ++marker) {
        seen[marker->dictionary].push_back({cell, marker->id});
      }
    }
    from = to;
  }
  return seen;
}

// A board with so many columns and many rows; `marker_first` where its upper left square has a
// marker.
CharucoBoard endless_board(int cols, bool marker_first) {
  constexpr int kManyRows = 1000;  // an even number, for which orders differ
  CharucoBoard board;
  board.cols = cols;
  board.rows = kManyRows;
  board.legacy = marker_first;
  return board;
}

// Where a board lies: its upper left square, and how many markers say so.
struct Placing {
  int cols = 0;
  bool marker_first = false;
  Cell origin;
  std::size_t agree = 0;
  int last_row = 0;  // of those markers
};

// Whether the control points of a board with its upper left square there hold all of a lattice's
// columns, and its first rows.
bool holds(Cell origin, int cols, const CellRange& extent) {
  return extent.first.col > origin.col && extent.first.row > origin.row &&
         extent.last.col < origin.col + cols;
}

Placing place(std::span<const SeenMarker> markers, int cols, bool marker_first,
              const CellRange& extent) {
  const CharucoBoard board = endless_board(cols, marker_first);
  const auto square_of = [&](const SeenMarker& m) {
    const GridPlace square = board.square_of(m.id);
    return Cell{square.col, square.row};
  };
  Placing best{cols, marker_first, {}, 0, 0};
  for (const SeenMarker& one : markers) {
    Placing placing{cols, marker_first, one.cell - square_of(one), 0, 0};
    if (!holds(placing.origin, cols, extent)) continue;
    for (const SeenMarker& other : markers) {
      const Cell square = square_of(other);
      if (!(other.cell - square == placing.origin)) continue;
      ++placing.agree;
      placing.last_row = std::max(placing.last_row, square.row);
    }
    if (placing.agree > best.agree) best = placing;
  }
  return best;
}

// The only number of columns, and order, that all markers agree on: of a board of an odd number of
// columns, one order is the other one a column further.
std::optional<Placing> place(std::span<const SeenMarker> markers, int least_cols, int most_cols,
                             const CellRange& extent) {
  std::optional<Placing> best;
  bool is_only = false;
  for (int cols = least_cols; cols <= most_cols; ++cols) {
    for (const bool marker_first : {false, true}) {
      const Placing placing = place(markers, cols, marker_first, extent);
      if (best && placing.agree < best->agree) continue;
      is_only = !best || placing.agree > best->agree;
      best = placing;
    }
  }
  const bool enough =
      best && best->agree >= kFewestMarkers &&
      static_cast<double>(best->agree) >= kLeastAgreeing * static_cast<double>(markers.size());
  return enough && is_only ? best : std::nullopt;
}

// As Code::turned() turns a corner.
Cell turned_corner(Cell cell, int quarter) {
  for (int i = 0; i < quarter; ++i) cell = {cell.row, -cell.col};
  return cell;
}

CellRange turned_extent(const CellRange& extent, int quarter) {
  const Cell a = turned_corner(extent.first, quarter);
  const Cell b = turned_corner(extent.last, quarter);
  return {{std::min(a.col, b.col), std::min(a.row, b.row)},
          {std::max(a.col, b.col), std::max(a.row, b.row)}};
}

// A board that a lattice may be, and how many markers say so.
struct Candidate {
  CharucoBoard board;
  std::size_t agree = 0;
  MarkerShape shape;
};

// What is seen of a lattice with markers of one shape.
class ShapeTrial {
 public:
  ShapeTrial(const ImageView& image, const Lattice& lattice, bool whole)
      : image_(image), lattice_(lattice), whole_(whole), extent_(lattice.extent()) {
    for (int row = extent_.first.row - 1; row <= extent_.last.row; ++row) {
      for (int col = extent_.first.col - 1; col <= extent_.last.col; ++col) {
        squares_[Lattice::is_even({col, row}) ? 1 : 0].push_back({col, row});
      }
    }
  }

  // Improves `best`.
  void run(const MarkerShape& shape, const std::vector<KnownMarker>& known,
           std::optional<Candidate>& best) {
    const std::vector<Cell>& squares = squares_[shape.inverted ? 0 : 1];
    const std::size_t step = 1 + squares.size() / kMostSquares;
    bits_.clear();
    for (std::size_t i = 0; i < squares.size(); i += step) {
      read_marker(image_, lattice_, squares[i], shape, bits_);
    }
    for (int quarter = 0; quarter < 4; ++quarter) {
      turned_ = bits_;
      for (CodeBit& bit : turned_) {
        bit.at = turned_in_marker(bit.at, shape.side, quarter);
        bit.light = bit.light != shape.inverted;
      }
      for (const auto& [dictionary, markers] : look_up(turned_, shape.side, known)) {
        consider(*dictionary, markers, quarter, shape, best);
      }
    }
  }

 private:
  void consider(const MarkerDictionary& dictionary, std::span<const SeenMarker> markers,
                int quarter, const MarkerShape& shape, std::optional<Candidate>& best) const {
    if (markers.size() < kFewestMarkers) return;
    const CellRange extent = turned_extent(extent_, quarter);
    const int least = extent.cols() + 1;
    const auto placing = place(markers, least, whole_ ? least : kMostColumns, extent);
    if (!placing) return;
    const Cell corner = placing->origin + Cell{1, 1};  // control point 0
    CharucoBoard board{placing->cols, extent.last.row - corner.row + 2, 0, 0, &dictionary};
    board.rows = std::max(board.rows, placing->last_row + 1);
    board.legacy = placing->marker_first;
    board.inverted = shape.inverted;
    // Where the first square has a marker the number of rows is even.
    if (board.legacy && board.rows % 2 != 0) ++board.rows;
    const auto smaller = [&] {
      return dictionary.codes.size() < best->board.dictionary->codes.size();
    };
    const bool better = !best || placing->agree > best->agree ||
                        (placing->agree == best->agree && best->board.dictionary != &dictionary &&
                         best->board.dictionary->side == dictionary.side && smaller());
    if (better) best = Candidate{board, placing->agree, shape};
  }

  const ImageView& image_;
  const Lattice& lattice_;
  bool whole_;
  CellRange extent_;
  std::array<std::vector<Cell>, 2> squares_;  // those that hold no markers, or all do
  std::vector<CodeBit> bits_;
  std::vector<CodeBit> turned_;
};

// The median share of a square's side that its marker has.
double measured_share(const ImageView& image, const Lattice& lattice, const MarkerShape& shape) {
  std::vector<float> shares;
  const CellRange e = lattice.extent();
  for (int row = e.first.row; row < e.last.row; ++row) {
    for (int col = e.first.col; col < e.last.col; ++col) {
      if (Lattice::is_even({col, row}) == shape.inverted) continue;
      if (const auto share = measure_marker(image, lattice, {col, row}, shape)) {
        shares.push_back(*share);
      }
    }
  }
  if (shares.empty()) return shape.cell * static_cast<float>(shape.side + 2);
  std::ranges::nth_element(shares, shares.begin() + static_cast<std::ptrdiff_t>(shares.size() / 2));
  return shares[shares.size() / 2];
}

}  // namespace

std::optional<CharucoBoard> find_charuco_board(const ImageView& image, const Lattice& lattice,
                                               bool whole, double square) {
  constexpr std::array<int, 4> kSides = {4, 5, 6, 7};
  constexpr int kLeastShare = 40;  // percent of a square's side
  constexpr int kMostShare = 92;
  constexpr int kStep = 4;  // less than the cell of a marker may be off
  std::optional<Candidate> best;
  ShapeTrial trial(image, lattice, whole);
  for (const int side : kSides) {
    const std::vector<KnownMarker> known = markers_with(side);
    if (known.empty()) continue;
    for (const bool inverted : {false, true}) {
      for (int share = kLeastShare; share <= kMostShare; share += kStep) {
        trial.run(marker_shape(static_cast<float>(share) / 100, side, inverted), known, best);
      }
    }
  }
  if (!best) return std::nullopt;
  CharucoBoard board = best->board;
  board.square = square;
  board.marker = std::round(100 * measured_share(image, lattice, best->shape)) / 100 * square;
  return board.check() ? std::optional(board) : std::nullopt;
}

}  // namespace calvin::detect
