// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The circles in the squares of a checkerboard that has some.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/detect/checkerboard/code/code.hpp"
#include "calvin/target/checkerboard.hpp"

namespace calvin::detect {

// The bit of a cell is that of the square whose upper left corner it has, light where a circle is.
class CircleCode final : public Code {
 public:
  explicit CircleCode(const MarkedCheckerboard& board);

  void read(const ImageView& image, const Lattice& lattice,
            std::vector<CodeBit>& bits) const override;
  [[nodiscard]] CodePlace turned(const CodePlace& at, int quarter) const override;
  // Two circles lie in no other way on a board whose others are seen to be missing there.
  [[nodiscard]] int fewest_light() const override { return 2; }
  // A whole checkerboard without circles, or with others.
  [[nodiscard]] std::optional<Board> other_board(const ImageView& image, const Lattice& lattice,
                                                 std::span<const CodeBit> bits,
                                                 bool whole) const override;

 private:
  double size_;  // m, side of a square
};

// The board that a whole lattice is, with squares of `size` m: with its usual circles where it can
// be read so, else with its longer side along x. Absent where there are no circles by which it
// could be named.
[[nodiscard]] std::optional<MarkedCheckerboard> find_marked_checkerboard(const ImageView& image,
                                                                         const Lattice& lattice,
                                                                         double size);

}  // namespace calvin::detect
