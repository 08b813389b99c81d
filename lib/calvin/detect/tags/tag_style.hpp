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
  bool inverted = false;  // light on dark

  explicit TagStyle(const TagGrid& board)
      : dictionary(board.dictionary),
        border(board.border),
        april(board.april),
        inverted(board.inverted) {}

  [[nodiscard]] int cells() const noexcept { return dictionary->side + 2 * border; }

  friend bool operator==(const TagStyle&, const TagStyle&) = default;
};

}  // namespace calvin::detect
