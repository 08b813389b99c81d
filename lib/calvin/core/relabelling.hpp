// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Relabelling: another way to name the control points of a board, as good as the one that was
// given.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace calvin {

// The labels of a grid are turned about z by quarter turns, in the sense of the board frame (x
// towards y), then shifted by columns and rows. All zero: the labels stay as they are.
struct Relabelling {
  int quarter_turns = 0;  // 0..3
  int cols = 0;
  int rows = 0;

  friend bool operator==(const Relabelling&, const Relabelling&) = default;
};

// "rotate180", "shift(2,0)", or both as in "rotate90 shift(0,-1)"; empty where nothing changes.
[[nodiscard]] std::string to_text(const Relabelling& relabelling);

// What to_text() printed; absent for any other text.
[[nodiscard]] std::optional<Relabelling> parse_relabelling(std::string_view text);

}  // namespace calvin
