// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What is looked for where nobody knows which board is shown: the code of any board.
#pragma once

#include <optional>
#include <span>

#include "calvin/detect/checkerboard/code/code.hpp"
#include "calvin/detect/checkerboard/code/pattern.hpp"
#include "calvin/target/grid.hpp"

namespace calvin::detect {

// Has no bits of its own, so that every lattice is another board.
class AnyCode final : public Code {
 public:
  // For lattices up to the size of a grid.
  explicit AnyCode(const Grid& grid);

  void read(const ImageView& /*image*/, const Lattice& /*lattice*/,
            std::vector<CodeBit>& /*bits*/) const override {}
  [[nodiscard]] CodePlace turned(const CodePlace& at, int /*quarter*/) const override { return at; }
  // A PuzzleBoard, a ChArUco board, a checkerboard with circles or, where the steps of the lattice
  // differ, an AprilGrid.
  [[nodiscard]] std::optional<Board> other_board(const ImageView& image, const Lattice& lattice,
                                                 std::span<const CodeBit> bits,
                                                 bool whole) const override;

 private:
  Grid grid_;
};

// Corners of squares that are alike, with or without a code.
[[nodiscard]] Pattern any_board_of_squares(double square);

// Tags with gaps of about `spacing` of their side. Absent where this build knows no family of tags.
[[nodiscard]] std::optional<Pattern> any_april_grid(double tag, double spacing);

}  // namespace calvin::detect
