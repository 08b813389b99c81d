// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What tags of several boards may have in common, so that they are read together.
#pragma once

#include "calvin/target/tag_grid.hpp"

namespace calvin::detect {

struct TagStyle {
  const MarkerDictionary* dictionary = nullptr;
  int border = 1;         // cells
  bool april = false;     // see TagGrid
  bool inverted = false;  // borders are light, with dark around them

  explicit TagStyle(const TagGrid& board)
      : dictionary(board.dictionary),
        border(board.border),
        april(board.april),
        inverted(board.inverted != board.dictionary->has_light_rim()) {}

  // Of a board with such tags: all of its colours are exchanged.
  [[nodiscard]] bool is_board_inverted() const noexcept {
    return inverted != dictionary->has_light_rim();
  }

  // Of a tag's side: what the cells outside of two borders fill of a gap.
  [[nodiscard]] double least_gap_share() const noexcept {
    return 2.0 * dictionary->outside / cells();
  }
  [[nodiscard]] int cells() const noexcept { return dictionary->side + 2 * border; }

  friend bool operator==(const TagStyle&, const TagStyle&) = default;
};

}  // namespace calvin::detect
