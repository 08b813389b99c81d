// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What boards of discs answer.

#include "calvin/target/circle_grid.hpp"

#include <algorithm>
#include <numbers>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "calvin/target/board_name.hpp"

namespace calvin {

namespace {

bool holds(const std::vector<GridPlace>& places, GridPlace p) {
  return std::ranges::find(places, p) != places.end();
}

std::string places_text(const std::vector<GridPlace>& places) {
  std::string text;
  for (const GridPlace p : places) {
    text += fmt::format("{}{}.{}", text.empty() ? "" : "+", p.col, p.row);
  }
  return text;
}

// The place of a disc when the grid is turned by quarter turns, x towards y; of a square grid only,
// or by an even number of them.
GridPlace turned(const CircleGrid& board, GridPlace p, int quarter_turns) {
  for (int i = 0; i < quarter_turns % 4; ++i) {
    const int last = (i % 2 == 0 ? board.rows : board.cols) - 1;
    p = {last - p.row, p.col};
  }
  return p;
}

// Around discs whose outermost centres span an area.
BoardArea around(const BoardArea& centres, double spacing, bool inverted) {
  const double room = inverted ? spacing : spacing / 2;  // dark ground is printed, light is paper
  return {centres.left - room, centres.top - room, centres.right + room, centres.bottom + room};
}

}  // namespace

// ---- CircleGrid ---------------------------------------------------------------------------------

DiscMark CircleGrid::mark(GridPlace p) const noexcept {
  if (holds(rings, p)) return DiscMark::kRing;
  return holds(large, p) ? DiscMark::kLarge : DiscMark::kNone;
}

std::string CircleGrid::text() const {
  std::string text =
      fmt::format("{}:{}x{}:{}", has_marks() ? "dots" : "circles", cols, rows, length_text(pitch));
  if (!rings.empty()) text += ":rings=" + places_text(rings);
  if (!large.empty()) text += ":big=" + places_text(large);
  if (inverted) text += ":inverted";
  return text;
}

Status CircleGrid::check() const {
  if (const Status status = grid().check(); !status) return status;
  const auto refuse = [](std::string why) {
    return make_error(ErrorCode::kInvalidArgument, std::move(why));
  };
  for (const auto* marks : {&rings, &large}) {
    for (const GridPlace p : *marks) {
      if (grid().contains(p)) continue;
      return refuse(fmt::format("A board of {}x{} dots has no dot at column {}, row {}.", cols,
                                rows, p.col, p.row));
    }
  }
  for (const GridPlace p : rings) {
    if (!holds(large, p)) continue;
    return refuse(fmt::format(
        "The dot at column {}, row {} is either a ring or larger than the others, not both.", p.col,
        p.row));
  }
  return {};
}

BoardArea CircleGrid::outline() const noexcept { return around(grid().extent(), pitch, inverted); }

std::vector<Relabelling> CircleGrid::symmetries() const {
  std::vector<Relabelling> all;
  for (const int turns : {1, 2, 3}) {
    if (turns % 2 != 0 && cols != rows) continue;
    const auto stays = [&](const std::vector<GridPlace>& marks) {
      return std::ranges::all_of(
          marks, [&](GridPlace p) { return holds(marks, turned(*this, p, turns)); });
    };
    if (stays(rings) && stays(large)) all.push_back({turns});
  }
  return all;
}

bool CircleGrid::looks_like(const CircleGrid& other) const noexcept {
  if (inverted != other.inverted || rings != other.rings || large != other.large) return false;
  if (has_marks()) return cols == other.cols && rows == other.rows;
  return std::minmax(cols, rows) == std::minmax(other.cols, other.rows);
}

// ---- AsymmetricCircleGrid -----------------------------------------------------------------------

std::string AsymmetricCircleGrid::text() const {
  return fmt::format("acircles:{}x{}:{}{}", cols, rows, length_text(pitch),
                     inverted ? ":inverted" : "");
}

Status AsymmetricCircleGrid::check() const { return unshifted().check(); }

std::vector<int> AsymmetricCircleGrid::ids() const { return unshifted().ids(); }

std::vector<Eigen::Vector3d> AsymmetricCircleGrid::points() const {
  std::vector<Eigen::Vector3d> all;
  all.reserve(static_cast<std::size_t>(count()));
  for (int id = 0; id < count(); ++id) {
    const GridPlace at = half_steps(id);
    all.emplace_back(at.col * pitch, at.row * pitch, 0);
  }
  return all;
}

std::optional<std::size_t> AsymmetricCircleGrid::index_of(int id) const noexcept {
  return unshifted().index_of(id);
}

std::vector<int> AsymmetricCircleGrid::neighbours(int id) const {
  std::vector<int> all;
  if (!index_of(id)) return all;
  const GridPlace at = half_steps(id);
  for (const GridPlace step :
       {GridPlace{-1, -1}, GridPlace{1, -1}, GridPlace{-1, 1}, GridPlace{1, 1}}) {
    const int row = at.row + step.row;
    const int x = at.col + step.col;
    if (row < 0 || row >= rows || x < 0 || x - row % 2 > 2 * (cols - 1)) continue;
    all.push_back(unshifted().id({x / 2, row}));
  }
  return all;
}

double AsymmetricCircleGrid::cell_size(int /*id*/) const noexcept {
  return std::numbers::sqrt2 * pitch;
}

BoardArea AsymmetricCircleGrid::extent() const noexcept {
  const int shifted = rows > 1 ? 1 : 0;
  return {0, 0, (2 * (cols - 1) + shifted) * pitch, (rows - 1) * pitch};
}

BoardArea AsymmetricCircleGrid::outline() const noexcept {
  return around(extent(), cell_size(0), inverted);
}

// With an odd number of rows the first row and the last one are alike, but the shifted rows tell a
// half turn.
std::vector<Relabelling> AsymmetricCircleGrid::symmetries() const {
  if (rows % 2 != 0) return {};
  return {{2}};
}

AsymmetricCircleGrid AsymmetricCircleGrid::with_cells_of(double side) const noexcept {
  return {cols, rows, side / std::numbers::sqrt2, inverted};
}

}  // namespace calvin
