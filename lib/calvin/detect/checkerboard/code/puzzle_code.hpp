// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The dots on the edges of a PuzzleBoard.
#pragma once

#include "calvin/detect/checkerboard/code/code.hpp"
#include "calvin/target/puzzle_board.hpp"

namespace calvin::detect {

// Bit 0 of a cell is the dot between its corner and the next of the row, bit 1 that between it and
// the next of the column.
class PuzzleCode final : public Code {
 public:
  explicit PuzzleCode(const PuzzleBoard& board);

  void read(const ImageView& image, const Lattice& lattice,
            std::vector<CodeBit>& bits) const override;
  [[nodiscard]] bool has_dots() const override { return true; }
  [[nodiscard]] CodePlace turned(const CodePlace& at, int quarter) const override;
  // From elsewhere in the map.
  [[nodiscard]] std::optional<Board> other_board(const ImageView& image, const Lattice& lattice,
                                                 std::span<const CodeBit> bits,
                                                 bool whole) const override;

 private:
  double size_;  // m, side of a square
};

}  // namespace calvin::detect
