// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Board: a physical target of any kind, its control points and the text that names it.
//
// Board frame: x and y in the plane of the board, z into it (away from a camera that looks at its
// face). On a grid the origin is control point 0, x runs along a row and y down the columns.
#pragma once

#include <concepts>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/relabelling.hpp"
#include "calvin/core/result.hpp"
#include "calvin/target/board_area.hpp"
#include "calvin/target/checkerboard.hpp"
#include "calvin/target/grid.hpp"
#include "calvin/target/point_board.hpp"

namespace calvin {

inline constexpr std::string_view kDefaultBoard = "checkerboard:9x6:25mm";

// A value: copies are cheap, and equal where kind and all measures are. Who needs to know the kind
// (a detector, what draws and renders) asks as(); all others ask the board.
class Board {
 public:
  // The kinds; a new one is a file in target/ and a name here.
  using Kind = std::variant<Checkerboard, PointBoard>;

  Board() = default;  // without control points
  template <typename OneKind>
  requires std::constructible_from<Kind, OneKind> Board(OneKind kind)  // NOLINT: it is one
      : kind_(std::move(kind)) {}

  // The part that only boards of this kind have; null for another one.
  template <typename OneKind>
  [[nodiscard]] const OneKind* as() const noexcept {
    return std::get_if<OneKind>(&kind_);
  }

  [[nodiscard]] const Kind& kind() const noexcept { return kind_; }

  // The canonical text, e.g. "checkerboard:9x6:25mm".
  [[nodiscard]] std::string text() const;

  // kInvalidArgument for measures that no board has.
  [[nodiscard]] Status check() const;

  [[nodiscard]] int point_count() const noexcept;
  // Of all control points, ascending; there may be gaps.
  [[nodiscard]] std::vector<int> ids() const;
  // All control points in the board frame, m, in the order of their ids.
  [[nodiscard]] std::vector<Eigen::Vector3d> points() const;
  // The place of an id in ids() and points(); absent where the board has no such control point.
  [[nodiscard]] std::optional<std::size_t> index_of(int id) const noexcept;

  // The columns and rows; absent for a board whose control points lie on none.
  [[nodiscard]] std::optional<Grid> grid() const noexcept;

  // The ids of the control points next to one, ascending.
  [[nodiscard]] std::vector<int> neighbours(int id) const;
  // m, to the next control point: what a control point has for itself.
  [[nodiscard]] double cell_size(int id) const noexcept;

  // Around the control points, and around all that is printed but the white border.
  [[nodiscard]] BoardArea extent() const noexcept;
  [[nodiscard]] BoardArea outline() const noexcept;

  // The turns about z after which the board looks the same; empty where it tells its own
  // orientation.
  [[nodiscard]] std::vector<Relabelling> symmetries() const;

  // Whether no picture tells this board from the other one: sizes do not show, nor which side
  // counts as a row.
  [[nodiscard]] bool looks_like(const Board& other) const noexcept;

  friend bool operator==(const Board&, const Board&) = default;

 private:
  Kind kind_;
};

// One board text, e.g. "checkerboard:9x6:25mm"; an error shows a right one.
[[nodiscard]] Result<Board> parse_board(std::string_view text);

// A length with its unit: "25mm", "2.5cm", "0.025m", "1in" -> m.
[[nodiscard]] Result<double> parse_length(std::string_view text);

}  // namespace calvin
