// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Artwork: what is printed of a board, the same for whoever draws or renders it. Internal.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "calvin/geometry/se3.hpp"
#include "calvin/target/board.hpp"

namespace calvin {

// Dark and light cells, and discs that are painted over them. Lengths in m, in the board frame.
struct Artwork {
  struct Disc {
    double x = 0;
    double y = 0;
    double diameter = 0;
    bool is_dark = true;
  };

  BoardArea outline;  // around the cells and discs
  double margin = 0;  // of light that belongs to the board, around the outline

  // Where the cells part, ascending; empty where there are only discs. Elsewhere the sheet is
  // light.
  std::vector<double> x;
  std::vector<double> y;
  std::vector<std::uint8_t> dark;  // of each cell, 1 or 0, row after row

  std::vector<Disc> discs;  // a later one covers those before it

  [[nodiscard]] int cols() const noexcept { return x.empty() ? 0 : static_cast<int>(x.size()) - 1; }
  [[nodiscard]] int rows() const noexcept { return y.empty() ? 0 : static_cast<int>(y.size()) - 1; }
  [[nodiscard]] bool is_dark(int col, int row) const {
    return dark[static_cast<std::size_t>(row) * static_cast<std::size_t>(cols()) +
                static_cast<std::size_t>(col)] != 0;
  }
};

// Of a board that check() refuses, and of a light, nothing is printed.
[[nodiscard]] Artwork artwork_of(const Board& board);

// An artwork on a sheet of its own, in the plane z = 0 of its frame.
struct PlacedArtwork {
  SE3 board_from_sheet;
  Artwork artwork;
};

// All that is printed of a board: one sheet, or one for each tag of a list, of which artwork_of()
// has nothing.
[[nodiscard]] std::vector<PlacedArtwork> artworks_of(const Board& board);

}  // namespace calvin
