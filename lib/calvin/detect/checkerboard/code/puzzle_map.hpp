// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The place of a PuzzleBoard that nobody asked for: any part of the map of all PuzzleBoards.
#pragma once

#include <optional>
#include <span>

#include "calvin/detect/checkerboard/code/code.hpp"
#include "calvin/detect/checkerboard/lattice.hpp"
#include "calvin/target/puzzle_board.hpp"

namespace calvin::detect {

// The board whose corners the nodes of a lattice are, with squares of `size` m. `bits` are what
// `reader`, the code of any PuzzleBoard, has read of it. Absent where they are too few or do not
// fit.
[[nodiscard]] std::optional<PuzzleBoard> locate_in_map(const Code& reader,
                                                       std::span<const CodeBit> bits,
                                                       const CellRange& extent, double size);

}  // namespace calvin::detect
