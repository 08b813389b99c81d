// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// CharucoBoard: a checkerboard with a marker in each light square, as OpenCV defines it.
#pragma once

#include <string>
#include <vector>

#include "calvin/core/observation.hpp"
#include "calvin/core/result.hpp"
#include "calvin/target/grid.hpp"
#include "calvin/target/marker_dictionary.hpp"

namespace calvin {

// Control points are the inner corners, numbered in rows from the upper left, as OpenCV's are since
// 4.6. What the functions answer is said of Board, in target/board.hpp.
struct CharucoBoard {
  int cols = 0;       // squares along x
  int rows = 0;       // along y
  double square = 0;  // m, side of a square
  double marker = 0;  // m, side of a marker with its rim
  const MarkerDictionary* dictionary = nullptr;
  // The order of OpenCV before 4.6, in which the upper left square is light where there is an even
  // number of rows.
  bool legacy = false;
  bool inverted = false;  // all colours are exchanged, on a dark sheet

  // Whether a square holds a marker; the others are as dark as the rims of the markers.
  [[nodiscard]] bool has_marker(int col, int row) const noexcept {
    return (col + row) % 2 == (legacy && rows % 2 == 0 ? 0 : 1);
  }
  // Of such a square. Markers are numbered in rows from the upper left.
  [[nodiscard]] int marker_in(int col, int row) const noexcept;
  // The inverse: the square of a marker, which may lie beyond the last row.
  [[nodiscard]] GridPlace square_of(int id) const noexcept;
  [[nodiscard]] int marker_count() const noexcept;

  [[nodiscard]] std::string text() const;
  [[nodiscard]] Status check() const;
  [[nodiscard]] Grid grid() const noexcept { return {cols - 1, rows - 1, square}; }
  // Half a square of the dark sheet around an inverted board belongs to it.
  [[nodiscard]] BoardArea outline() const noexcept;
  [[nodiscard]] std::vector<Relabelling> symmetries() const { return {}; }
  [[nodiscard]] bool looks_like(const CharucoBoard& other) const noexcept;

  // The markers keep their share of a square.
  [[nodiscard]] CharucoBoard with_cells_of(double side) const noexcept;

  friend bool operator==(const CharucoBoard&, const CharucoBoard&) = default;
};

}  // namespace calvin
