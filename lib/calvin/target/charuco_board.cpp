// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a ChArUco board answers.

#include "calvin/target/charuco_board.hpp"

#include <cmath>

#include <fmt/format.h>

#include "calvin/target/board_name.hpp"

namespace calvin {

int CharucoBoard::marker_in(int col, int row) const noexcept {
  // In a row there is a marker in every other square; the first square of the board tells which.
  const int shift = has_marker(0, 0) ? 1 : 0;
  const int of_two_rows = cols;
  const int before = row / 2 * of_two_rows + (row % 2 == 0 ? 0 : (cols + shift) / 2);
  return before + col / 2;
}

GridPlace CharucoBoard::square_of(int id) const noexcept {
  const int of_two_rows = cols;
  const int of_first = marker_in(has_marker(0, 1) ? 0 : 1, 1);
  const int rest = id % of_two_rows;
  const int row = 2 * (id / of_two_rows) + (rest < of_first ? 0 : 1);
  const int before = rest < of_first ? rest : rest - of_first;  // in its row
  return {2 * before + (has_marker(0, row) ? 0 : 1), row};
}

int CharucoBoard::marker_count() const noexcept {
  return (cols * rows + (has_marker(0, 0) ? 1 : 0)) / 2;
}

std::string CharucoBoard::text() const {
  return fmt::format("charuco:{}x{}:{}:{}:{}{}{}", cols, rows, length_text(square),
                     length_text(marker), dictionary == nullptr ? "" : dictionary->name,
                     legacy ? ":legacy" : "", inverted ? ":inverted" : "");
}

Status CharucoBoard::check() const {
  if (const Status status = grid().check(); !status) return status;
  const auto refuse = [&](std::string why) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("The board {} does not exist: {}.", text(), why));
  };
  if (dictionary == nullptr) return refuse("it has no dictionary of markers");
  if (dictionary->outside > 0) {
    return refuse(
        fmt::format("markers have dark rims, {} has light ones; they make grids, "
                    "apriltag:{}:...",
                    dictionary->name, dictionary->name));
  }
  if (!std::isfinite(marker) || !(marker > 0) || !(marker < square)) {
    return refuse("a marker is smaller than its square");
  }
  if (marker_count() > static_cast<int>(dictionary->codes.size())) {
    return refuse(fmt::format("it needs {} markers, {} has {}", marker_count(), dictionary->name,
                              dictionary->codes.size()));
  }
  return {};
}

BoardArea CharucoBoard::outline() const noexcept {
  const BoardArea squares = grid().outline();
  const double frame = inverted ? square / 2 : 0;
  return {squares.left - frame, squares.top - frame, squares.right + frame, squares.bottom + frame};
}

bool CharucoBoard::looks_like(const CharucoBoard& other) const noexcept {
  CharucoBoard same_size = other;
  same_size.square = square;
  same_size.marker = marker;
  return *this == same_size;
}

CharucoBoard CharucoBoard::with_cells_of(double side) const noexcept {
  CharucoBoard other = *this;
  other.square = side;
  other.marker = marker / square * side;
  return other;
}

}  // namespace calvin
