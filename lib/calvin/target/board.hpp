// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Board: a physical target of any kind, its control points and the text that names it.
//
// Board frame: x and y in the plane of the board, z into it (away from a camera that looks at its
// face). On a grid the origin is control point 0, x runs along a row and y down the columns.
#pragma once

#include <concepts>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/export.hpp"
#include "calvin/core/observation.hpp"
#include "calvin/core/result.hpp"
#include "calvin/target/grid.hpp"

namespace calvin {

inline constexpr std::string_view kDefaultBoard = "checkerboard:9x6:25mm";

class Board;

// One of the kinds of boards, which are internal (target/kinds.hpp of the sources).
template <typename Kind>
concept BoardKind = !std::same_as<Kind, Board> && requires(const Kind& kind) {
  { kind.text() } -> std::same_as<std::string>;
  { kind.check() } -> std::same_as<Status>;
  { kind.symmetries() } -> std::same_as<std::vector<Relabelling>>;
};

// A value: copies are cheap, and equal where kind and all measures are. parse_board() makes one of
// its text. Inside the library who needs to know the kind (a detector, what draws and renders)
// includes target/kinds.hpp, which is not installed, and asks as(); all others ask the board.
class Board {
 public:
  struct Kind;  // one of the kinds, internal

  CALVIN_API Board();             // without control points
  Board(const Board&) = default;  // without a move, which would leave a board without a kind
  Board& operator=(const Board&) = default;
  ~Board() = default;
  // Internal: of one of the kinds.
  template <BoardKind OneKind>
  Board(OneKind kind);  // NOLINT: it is one

  // Internal: the part that only boards of this kind have; null for another one.
  template <typename OneKind>
  [[nodiscard]] const OneKind* as() const noexcept;

  // Internal.
  [[nodiscard]] const Kind& kind() const noexcept { return *kind_; }

  // The canonical text, e.g. "checkerboard:9x6:25mm".
  [[nodiscard]] CALVIN_API std::string text() const;

  // kInvalidArgument for measures that no board has.
  [[nodiscard]] CALVIN_API Status check() const;

  [[nodiscard]] CALVIN_API int point_count() const noexcept;
  // Of all control points, ascending; there may be gaps.
  [[nodiscard]] CALVIN_API std::vector<int> ids() const;
  // All control points in the board frame, m, in the order of their ids.
  [[nodiscard]] CALVIN_API std::vector<Eigen::Vector3d> points() const;
  // The place of an id in ids() and points(); absent where the board has no such control point.
  [[nodiscard]] CALVIN_API std::optional<std::size_t> index_of(int id) const noexcept;

  // The columns and rows; absent for a board whose control points lie on none.
  [[nodiscard]] CALVIN_API std::optional<Grid> grid() const noexcept;

  // The ids of the control points next to one, ascending.
  [[nodiscard]] CALVIN_API std::vector<int> neighbours(int id) const;
  // m, to the next control point: what a control point has for itself; across its tag, where it has
  // one.
  [[nodiscard]] CALVIN_API double cell_size(int id) const noexcept;

  // Around the control points, and around all that is printed but the white border.
  [[nodiscard]] CALVIN_API BoardArea extent() const noexcept;
  [[nodiscard]] CALVIN_API BoardArea outline() const noexcept;

  // The turns about z after which the board looks the same; empty where it tells its own
  // orientation.
  [[nodiscard]] CALVIN_API std::vector<Relabelling> symmetries() const;

  // Whether no picture tells this board from the other one: sizes do not show, nor which side
  // counts as a row.
  [[nodiscard]] CALVIN_API bool looks_like(const Board& other) const noexcept;

  CALVIN_API friend bool operator==(const Board& a, const Board& b);

 private:
  std::shared_ptr<const Kind> kind_;
};

// One board text, e.g. "checkerboard:9x6:25mm"; an error shows a right one.
[[nodiscard]] CALVIN_API Result<Board> parse_board(std::string_view text);

// A length with its unit: "25mm", "2.5cm", "0.025m", "1in" -> m.
[[nodiscard]] CALVIN_API Result<double> parse_length(std::string_view text);

}  // namespace calvin
