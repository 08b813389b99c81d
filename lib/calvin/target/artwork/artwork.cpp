// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The cells and discs of each kind of board.

#include "calvin/target/artwork/artwork.hpp"

#include <optional>
#include <variant>

#include "calvin/target/kinds.hpp"

namespace calvin {

namespace {

// Fills the cells between the cuts.
template <typename IsDark>
void fill_cells(Artwork& artwork, IsDark is_dark) {
  artwork.dark.reserve(static_cast<std::size_t>(artwork.cols()) *
                       static_cast<std::size_t>(artwork.rows()));
  for (int row = 0; row < artwork.rows(); ++row) {
    for (int col = 0; col < artwork.cols(); ++col) artwork.dark.push_back(is_dark(col, row));
  }
}

// The edges of the squares around so many inner corners.
std::vector<double> square_cuts(int corners, double side) {
  std::vector<double> cuts;
  for (int i = -1; i <= corners; ++i) cuts.push_back(i * side);
  return cuts;
}

// Whole squares around all control points; is_dark takes the control point below and to the right
// of a square.
template <typename IsDark>
void print_squares(Artwork& artwork, const Grid& grid, IsDark is_dark) {
  artwork.margin = grid.pitch;
  artwork.x = square_cuts(grid.cols, grid.pitch);
  artwork.y = square_cuts(grid.rows, grid.pitch);
  fill_cells(artwork, [&](int col, int row) { return is_dark(GridPlace{col, row}); });
}

void print(Artwork& artwork, const Checkerboard& board) {
  print_squares(artwork, board.grid(), [](GridPlace p) { return (p.col + p.row) % 2 == 0; });
}

void print(Artwork& artwork, const MarkedCheckerboard& board) {
  print(artwork, Checkerboard{board.cols, board.rows, board.size});
  const double diameter = MarkedCheckerboard::kCircleDiameter * board.size;
  for (const GridPlace square : board.circles) {
    const bool is_dark = !artwork.is_dark(square.col, square.row);
    artwork.discs.push_back(
        {(square.col - 0.5) * board.size, (square.row - 0.5) * board.size, diameter, is_dark});
  }
}

void print(Artwork& artwork, const PuzzleBoard& board) {
  print_squares(artwork, board.grid(), [&](GridPlace p) { return board.is_dark_before(p); });
  const double diameter = PuzzleBoard::kDotDiameter * board.size;
  for (int row = 0; row < board.rows; ++row) {
    for (int col = 0; col < board.cols; ++col) {
      const double x = col * board.size;
      const double y = row * board.size;
      const double half = board.size / 2;
      if (col + 1 < board.cols) {
        artwork.discs.push_back({x + half, y, diameter, !board.is_light_after({col, row})});
      }
      if (row + 1 < board.rows) {
        artwork.discs.push_back({x, y + half, diameter, !board.is_light_below({col, row})});
      }
    }
  }
}

// The squares of a ChArUco board, each cut as the marker in the middle of it is, with its rim, into
// cells.
class CharucoCells {
 public:
  explicit CharucoCells(const CharucoBoard& board)
      : board_(board), marker_cells_(board.dictionary->side + 2) {}

  [[nodiscard]] std::vector<double> cuts(int squares) const {
    const double gap = (board_.square - board_.marker) / 2;
    std::vector<double> cuts;
    for (int i = 0; i < squares; ++i) {
      const double start = (i - 1) * board_.square;
      cuts.push_back(start);
      for (int k = 0; k <= marker_cells_; ++k) {
        cuts.push_back(start + gap + k * board_.marker / marker_cells_);
      }
    }
    cuts.push_back((squares - 1) * board_.square);
    return cuts;
  }

  // Before colours are exchanged.
  [[nodiscard]] bool is_dark(int col, int row) const {
    const int cells = marker_cells_ + 2;  // along a square: a gap on either side
    const GridPlace square{col / cells, row / cells};
    if (!board_.has_marker(square.col, square.row)) return true;
    const int i = col % cells - 1;
    const int j = row % cells - 1;
    const auto is_within = [](int k, int first, int last) { return k >= first && k <= last; };
    const int last = marker_cells_ - 1;
    if (!is_within(i, 0, last) || !is_within(j, 0, last)) return false;
    if (!is_within(i, 1, last - 1) || !is_within(j, 1, last - 1)) return true;
    const int id = board_.marker_in(square.col, square.row);
    return !board_.dictionary->is_light(id, i - 1, j - 1);
  }

 private:
  const CharucoBoard& board_;
  int marker_cells_;  // along a side, with the rim
};

void print(Artwork& artwork, const CharucoBoard& board) {
  const CharucoCells cells(board);
  artwork.margin = board.square;
  artwork.x = cells.cuts(board.cols);
  artwork.y = cells.cuts(board.rows);
  if (!board.inverted) {
    fill_cells(artwork, [&](int col, int row) { return cells.is_dark(col, row); });
    return;
  }
  // The dark around an inverted board is printed, where the light around another one is not.
  artwork.x.insert(artwork.x.begin(), artwork.outline.left);
  artwork.x.push_back(artwork.outline.right);
  artwork.y.insert(artwork.y.begin(), artwork.outline.top);
  artwork.y.push_back(artwork.outline.bottom);
  const int cols = artwork.cols() - 2;
  const int rows = artwork.rows() - 2;
  fill_cells(artwork, [&](int col, int row) {
    const bool is_inside = col > 0 && row > 0 && col <= cols && row <= rows;
    return !is_inside || !cells.is_dark(col - 1, row - 1);
  });
}

// The ground of a board of discs is dark where they are light.
template <typename Kind>
void print_ground(Artwork& artwork, const Kind& board, double spacing) {
  artwork.margin = spacing / 2;
  if (!board.inverted) return;
  artwork.x = {artwork.outline.left, artwork.outline.right};
  artwork.y = {artwork.outline.top, artwork.outline.bottom};
  artwork.dark = {1};
}

void print(Artwork& artwork, const CircleGrid& board) {
  print_ground(artwork, board, board.pitch);
  for (int row = 0; row < board.rows; ++row) {
    for (int col = 0; col < board.cols; ++col) {
      const DiscMark mark = board.mark({col, row});
      const double diameter = mark == DiscMark::kLarge ? kLargeDiscDiameter : kDiscDiameter;
      const double x = col * board.pitch;
      const double y = row * board.pitch;
      artwork.discs.push_back({x, y, diameter * board.pitch, !board.inverted});
      if (mark != DiscMark::kRing) continue;
      artwork.discs.push_back({x, y, kRingHole * board.pitch, board.inverted});
    }
  }
}

void print(Artwork& artwork, const AsymmetricCircleGrid& board) {
  const double spacing = board.cell_size(0);
  print_ground(artwork, board, spacing);
  for (const Eigen::Vector3d& centre : board.points()) {
    artwork.discs.push_back({centre.x(), centre.y(), kDiscDiameter * spacing, !board.inverted});
  }
}

// An AprilGrid, cut as its tags are, with their borders, into cells, and between them.
class AprilGridCells {
 public:
  explicit AprilGridCells(const AprilGrid& board)
      : board_(board), tag_cells_(board.dictionary->side + 2 * board.border) {}

  [[nodiscard]] std::vector<double> cuts(int tags) const {
    const Grid grid = board_.grid();
    std::vector<double> cuts = {grid.distance_to(-1)};
    for (int i = 0; i < tags; ++i) {
      for (int k = 0; k <= tag_cells_; ++k) {
        cuts.push_back(grid.distance_to(2 * i) + k * board_.tag / tag_cells_);
      }
    }
    cuts.push_back(grid.distance_to(2 * tags));
    return cuts;
  }

  [[nodiscard]] bool is_dark(int col, int row) const {
    const Cell x = cell_of(col);
    const Cell y = cell_of(row);
    if (x.is_gap || y.is_gap) return x.is_gap && y.is_gap;
    const int side = board_.dictionary->side;
    const int i = x.at - board_.border;
    const int j = y.at - board_.border;
    if (i < 0 || j < 0 || i >= side || j >= side) return true;
    return !board_.is_light(board_.tag_in(x.tag, y.tag), i, j);
  }

 private:
  struct Cell {
    int tag = 0;
    int at = 0;  // in the tag
    bool is_gap = false;
  };
  [[nodiscard]] Cell cell_of(int line) const {
    const int period = tag_cells_ + 1;
    return {(line - 1) / period, (line + period - 1) % period, line % period == 0};
  }

  const AprilGrid& board_;
  int tag_cells_;  // along a side, with the border
};

void print(Artwork& artwork, const AprilGrid& board) {
  const AprilGridCells cells(board);
  artwork.margin = board.grid().gap;
  artwork.x = cells.cuts(board.cols);
  artwork.y = cells.cuts(board.rows);
  fill_cells(artwork, [&](int col, int row) { return cells.is_dark(col, row); });
}

// A grid of tags, cut as its tags are, with their borders and what they have outside of these, into
// cells, and around them.
class TagGridCells {
 public:
  explicit TagGridCells(const TagGrid& board)
      : board_(board),
        outside_(board.dictionary->outside),
        tag_cells_(board.cells() + 2 * outside_),
        gap_cells_(board.are_touching() ? 0 : 1) {}

  // `from` and `to` are the ends of the outline.
  [[nodiscard]] std::vector<double> cuts(int tags, double from, double to) const {
    std::vector<double> cuts = {from};
    for (int i = 0; i < tags; ++i) {
      // Where tags touch, one begins where the other one ends.
      const int first = i > 0 && gap_cells_ == 0 ? 1 : 0;
      for (int k = first; k <= tag_cells_; ++k) {
        cuts.push_back(board_.grid().distance_to(2 * i) +
                       (k - outside_) * board_.tag / board_.cells());
      }
    }
    cuts.push_back(to);
    return cuts;
  }

  // Before colours are exchanged.
  [[nodiscard]] bool is_dark(int col, int row) const {
    const auto x = cell_of(col, board_.cols);
    const auto y = cell_of(row, board_.rows);
    return x && y && board_.is_dark(board_.tag_in(x->tag, y->tag), x->at, y->at);
  }

 private:
  struct Cell {
    int tag = 0;
    int at = 0;  // from its border on
  };
  // Absent beside the tags.
  [[nodiscard]] std::optional<Cell> cell_of(int line, int tags) const {
    const int period = tag_cells_ + gap_cells_;
    const int tag = (line - 1) / period;
    const int at = (line - 1) % period;
    if (line == 0 || tag >= tags || at >= tag_cells_) return std::nullopt;
    return Cell{tag, at - outside_};
  }

  const TagGrid& board_;
  int outside_;
  int tag_cells_;  // along a side
  int gap_cells_;  // between two tags
};

void print(Artwork& artwork, const TagGrid& board) {
  const TagGridCells cells(board);
  artwork.margin = -artwork.outline.left;
  artwork.x = cells.cuts(board.cols, artwork.outline.left, artwork.outline.right);
  artwork.y = cells.cuts(board.rows, artwork.outline.top, artwork.outline.bottom);
  fill_cells(artwork, [&](int col, int row) { return cells.is_dark(col, row) != board.inverted; });
}

// The edges of lines that are a pitch apart, and the ends of the outline.
std::vector<double> line_cuts(const Grid& grid, double from, double to) {
  constexpr double kHalf = UnboundedGrid::kLineWidth / 2;
  std::vector<double> cuts = {from};
  for (int i = 0; i < UnboundedGrid::kSide; ++i) {
    cuts.push_back(grid.distance_to(i) - kHalf * grid.pitch);
    cuts.push_back(grid.distance_to(i) + kHalf * grid.pitch);
  }
  cuts.push_back(to);
  return cuts;
}

void print(Artwork& artwork, const UnboundedGrid& board) {
  const Grid grid = board.grid();
  if (board.pattern == GridPattern::kDots) {
    print(artwork, CircleGrid{grid.cols, grid.rows, board.pitch, {}, {}, board.inverted});
    return;
  }
  artwork.margin = board.pitch;
  artwork.x = line_cuts(grid, artwork.outline.left, artwork.outline.right);
  artwork.y = line_cuts(grid, artwork.outline.top, artwork.outline.bottom);
  fill_cells(artwork,
             [&](int col, int row) { return (col % 2 != 0 || row % 2 != 0) != board.inverted; });
}

void print(Artwork& artwork, const PointBoard& board) {
  if (!board.is_flat()) return;
  for (const PointBoard::Dot& dot : board.dots()) {
    if (dot.diameter > 0) artwork.discs.push_back({dot.x, dot.y, dot.diameter, true});
  }
}

void print(Artwork& /*artwork*/, const PointLight& /*light*/) {}
void print(Artwork& /*artwork*/, const TagList& /*list*/) {}

}  // namespace

Artwork artwork_of(const Board& board) {
  Artwork artwork;
  if (!board.check()) return artwork;
  artwork.outline = board.outline();
  std::visit([&](const auto& kind) { print(artwork, kind); }, board.kind());
  return artwork;
}

std::vector<PlacedArtwork> artworks_of(const Board& board) {
  const auto* list = board.as<TagList>();
  if (list == nullptr) return {{SE3{}, artwork_of(board)}};
  std::vector<PlacedArtwork> all;
  for (const TagList::Tag& tag : list->tags) {
    all.push_back({TagList::board_from_grid(tag), artwork_of(list->grid_of(tag))});
  }
  return all;
}

}  // namespace calvin
