// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Looks at the squares that may hold markers.

#include "calvin/detect/checkerboard/code/charuco_code.hpp"

namespace calvin::detect {

CharucoCode::CharucoCode(const CharucoBoard& board)
    : Code(board.grid(), board.dictionary->side * board.dictionary->side, 1,
           board.has_marker(0, 0) == board.inverted),
      shape_(marker_shape(static_cast<float>(board.marker / board.square), board.dictionary->side,
                          board.inverted)) {
  const int side = shape_.side;
  // Control point 0 is the lower right corner of square (0, 0).
  for (int row = 0; row < board.rows; ++row) {
    for (int col = 0; col < board.cols; ++col) {
      if (!board.has_marker(col, row)) continue;
      const int id = board.marker_in(col, row);
      for (int i = 0; i < side * side; ++i) {
        const bool light = board.dictionary->is_light(id, i % side, i / side);
        set({{col - 1, row - 1}, i}, light != shape_.inverted);
      }
    }
  }
}

void CharucoCode::read(const ImageView& image, const Lattice& lattice,
                       std::vector<CodeBit>& bits) const {
  // From so many bits on, a board is named with certainty though one in eight is wrong.
  constexpr std::size_t kEnough = 64;
  const CellRange e = lattice.extent();
  const std::size_t before = bits.size();
  // Where the lens bends lines much, squares of which corners are only expected are misread.
  for (const bool whole : {true, false}) {
    if (bits.size() - before >= kEnough) break;
    for (int row = e.first.row - 1; row <= e.last.row; ++row) {
      for (int col = e.first.col - 1; col <= e.last.col; ++col) {
        if (!may_hold_marker(lattice, {col, row})) continue;
        if (is_whole_square(lattice, {col, row}) != whole) continue;
        read_marker(image, lattice, {col, row}, shape_, bits);
      }
    }
  }
}

CodePlace CharucoCode::turned(const CodePlace& at, int quarter) const {
  return turned_in_marker(at, shape_.side, quarter);
}

}  // namespace calvin::detect
